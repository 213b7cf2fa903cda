//! Closed forms: weight, free fall, impulse, and what the settings do to them.

mod common;

use common::{body, humanoid, run, wriggle};
use glam::Vec3;
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use physics_bridge::{BodyPoses, Character, Model, Settings};
use policy_core::{CharacterState, Heading};

const G: f32 = 9.81;
const TICK_SECS: f32 = 1.0 / 30.0;

fn with(change: impl FnOnce(&mut Settings)) -> Model {
    let mut settings = Settings::default();
    change(&mut settings);
    humanoid().with_settings(settings).unwrap()
}

/// A character high above the ground, at rest.
fn afloat(model: &Model) -> Character {
    let mut character = Character::new(model);
    let mut pose = character.pose();
    pose.qpos[2] += 10.0;
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
    character
}

#[test]
fn stepping_is_mujocos_own_step_bit_for_bit() {
    let model = std::sync::Arc::new(MjModel::from_xml_string(common::HUMANOID).unwrap());
    let mut bare = MjData::new(model);
    let mut character = Character::new(&humanoid());
    bare.qpos_mut().copy_from_slice(&character.pose().qpos);
    for tick in 0..90 {
        let targets = wriggle(character.model().skeleton(), tick);
        for (to, &from) in bare.ctrl_mut().iter_mut().zip(&*targets) {
            *to = from.into();
        }
        (0..4).for_each(|_| bare.step());
        character.actuate(&targets);
        character.step().unwrap();
        let pose = character.pose();
        assert_eq!(bare.qpos(), pose.qpos, "qpos after tick {tick}");
        assert_eq!(bare.qvel(), pose.qvel, "qvel after tick {tick}");
    }
}

#[test]
fn the_ground_carries_the_weight() {
    let model = humanoid();
    assert!((model.mass_kg() - 48.9).abs() < 0.1, "{}", model.mass_kg());
    let mut character = Character::new(&model);
    assert!(character.contacts().is_empty());
    for _ in 0..15 {
        character.step().unwrap();
    }
    let total: Vec3 = character.contacts().iter().map(|c| c.force).sum();
    let weight = model.mass_kg() as f32 * G;
    assert!((total.z - weight).abs() < 0.1 * weight, "{total} newtons for {weight}");
    for contact in character.contacts() {
        assert!(model.skeleton().feet().contains(&contact.body), "{contact:?}");
        assert_eq!(contact.other, None);
        assert!((contact.normal - Vec3::Z).length() < 1e-6 && contact.position.z.abs() < 0.01, "{contact:?}");
    }
}

#[test]
fn free_fall_gains_g() {
    for (factor, model) in
        [(1.0, humanoid()), (0.165, with(|s| s.gravity = 0.165)), (0.0, with(|s| s.gravity = 0.0))]
    {
        let mut character = afloat(&model);
        let height = character.centre_of_mass().z;
        (0..15).for_each(|_| character.step().unwrap());
        let velocity = character.centre_of_mass_velocity();
        assert!((velocity - Vec3::Z * (-G * factor * 0.5)).length() < 2e-3, "{velocity} at {factor} g");
        let fallen = height - character.centre_of_mass().z;
        assert!((fallen - 0.5 * G * factor * 0.25).abs() < 0.03, "{fallen} m at {factor} g");
    }
}

#[test]
fn an_impulse_changes_momentum_by_itself() {
    let model = with(|s| s.gravity = 0.0);
    let mut character = afloat(&model);
    character.impulse(body(&model, "torso"), Vec3::new(10.0, 0.0, 0.0)).unwrap();
    character.impulse(body(&model, "torso"), Vec3::new(10.0, 5.0, 0.0)).unwrap();
    for tick in 0..3 {
        character.step().unwrap();
        let momentum = character.centre_of_mass_velocity() * model.mass_kg() as f32;
        assert!((momentum - Vec3::new(20.0, 5.0, 0.0)).length() < 0.02, "tick {tick}: {momentum}");
    }
}

#[test]
fn a_push_lasts_as_long_as_it_says() {
    let model = with(|s| s.gravity = 0.0);
    let mut character = afloat(&model);
    character.push(body(&model, "pelvis"), Vec3::new(0.0, 100.0, 0.0), 0.2).unwrap();
    for tick in 1..=9 {
        character.step().unwrap();
        let momentum = character.centre_of_mass_velocity() * model.mass_kg() as f32;
        let expected = 100.0 * (tick as f32 * TICK_SECS).min(0.2);
        assert!((momentum.y - expected).abs() < 0.05, "tick {tick}: {momentum}, expected {expected}");
    }
}

#[test]
fn pushes_that_are_no_numbers_are_refused() {
    let mut character = Character::new(&humanoid());
    let (before, head) = (common::hash(&character), body(character.model(), "head"));
    assert!(character.push(head, Vec3::NAN, 0.1).is_err());
    assert!(character.push(head, Vec3::X, -0.1).is_err());
    assert!(character.push(head, Vec3::X, f32::INFINITY).is_err());
    let error = character.impulse(head, Vec3::X * 1e9).unwrap_err().to_string();
    assert!(error.contains("an impulse") && error.contains("1000000"), "{error}");
    assert_eq!(before, common::hash(&character));
}

/// How far a character that is set moving slides in a second.
fn slides(model: &Model) -> f32 {
    let mut character = Character::new(model);
    character.stand_at(0.0, 0.0, Heading::FORWARD, 1.0).unwrap();
    let mut poses = BodyPoses::new(model.skeleton());
    (0..9).for_each(|_| character.step().unwrap());
    character.poses_into(&mut poses);
    poses.positions[body(model, "left_foot").index()].x
}

#[test]
fn ice_is_slippery() {
    let (ground, ice) = (slides(&humanoid()), slides(&with(|s| s.friction = 0.02)));
    assert!(ice > ground + 0.1, "slides {ice} m on ice, {ground} m on the ground");
}

#[test]
fn without_strength_it_collapses() {
    let height_after = |model: &Model| {
        let mut character = Character::new(model);
        (0..30).for_each(|_| character.step().unwrap());
        character.centre_of_mass().z
    };
    let (strong, limp) = (height_after(&humanoid()), height_after(&with(|s| s.strength = 0.0)));
    assert!(strong > 0.88 && limp < 0.8, "centre of mass at {strong} and {limp} m");
}

#[test]
fn a_heavier_body_presses_harder_and_falls_as_fast() {
    let model = with(|s| s.mass = 1.5);
    let mass = humanoid().mass_kg() * 1.5;
    assert!((model.mass_kg() - mass).abs() < 1e-6 * mass, "{} kg, expected {mass}", model.mass_kg());
    let mut standing = Character::new(&model);
    (0..15).for_each(|_| standing.step().unwrap());
    let total: Vec3 = standing.contacts().iter().map(|c| c.force).sum();
    let weight = mass as f32 * G;
    assert!((total.z - weight).abs() < 0.1 * weight, "{total} newtons for {weight}");
    let mut falling = afloat(&model);
    (0..15).for_each(|_| falling.step().unwrap());
    assert!((falling.centre_of_mass_velocity().z + G * 0.5).abs() < 2e-3);
    let same = model.with_settings(Settings::default()).unwrap();
    assert_eq!(same.mass_kg(), humanoid().mass_kg());
    assert!(humanoid().with_settings(Settings { mass: 0.1, ..Settings::default() }).is_err());
}

#[test]
fn settings_change_under_way_and_back() {
    let model = humanoid();
    let moon = with(|s| s.gravity = 0.165);
    let mut character = Character::new(&model);
    let mut other = Character::new(&model);
    assert!(character.set_model(&moon).is_err(), "another compilation of the same text");
    let settings = Settings { gravity: 0.165, ..Settings::default() };
    let moon = model.with_settings(settings).unwrap();
    character.set_model(&moon).unwrap();
    run(&mut character, 5);
    run(&mut other, 5);
    assert_ne!(common::hash(&character), common::hash(&other));
    character.set_model(&moon.with_settings(Settings::default()).unwrap()).unwrap();
    character.restore(&other.save()).unwrap();
    run(&mut character, 20);
    run(&mut other, 20);
    assert_eq!(common::hash(&character), common::hash(&other));
}

#[test]
fn settings_out_of_range_are_refused() {
    for bad in [-1.0, f32::NAN, 5.1] {
        let settings = Settings { friction: bad, ..Settings::default() };
        let error = humanoid().with_settings(settings).unwrap_err().to_string();
        assert!(error.contains("friction"), "{error}");
    }
}

#[test]
fn standing_touches_the_ground_and_faces_the_heading() {
    let mut character = Character::new(&humanoid());
    let mut state = CharacterState::new(character.model().skeleton());
    for (x, y, angle) in [(0.0, 0.0, 0.0), (3.0, -7.5, 2.0), (-100.0, 40.0, -3.0)] {
        character.stand_at(x, y, Heading::from_angle(angle), 0.5).unwrap();
        assert!(character.clearance().abs() < 1e-5, "{}", character.clearance());
        character.sense_into(&mut state);
        let pelvis = state.root();
        let heading = Heading::from_rotation(pelvis.rotation);
        assert!((heading.direction() - Heading::from_angle(angle).direction()).length() < 1e-5);
        assert!((pelvis.linear_velocity.truncate() - heading.direction() * 0.5).length() < 1e-5);
        assert!((pelvis.position.truncate() - glam::Vec2::new(x, y)).length() < 1e-5);
        (0..20).for_each(|_| character.step().unwrap());
        character.sense_into(&mut state);
        assert!(
            state.body(character.model().skeleton().head().unwrap()).position.z > 1.0,
            "fell from {x}, {y}"
        );
    }
}

#[test]
fn poses_that_are_none_are_refused_and_change_nothing() {
    let mut character = Character::new(&humanoid());
    run(&mut character, 3);
    let (before, pose) = (common::hash(&character), character.pose());
    let mut qpos = pose.qpos.clone();
    qpos[20] = f64::NAN;
    let error = character.set_pose(&qpos, &pose.qvel).unwrap_err().to_string();
    assert!(error.contains("qpos[20]"), "{error}");
    let error = character.set_pose(&qpos[..34], &pose.qvel).unwrap_err().to_string();
    assert!(error.contains("35") && error.contains("qpos") && error.contains("34"), "{error}");
    let mut qvel = vec![0.0; pose.qvel.len()];
    qvel[0] = f64::INFINITY;
    assert!(character.set_pose(&pose.qpos, &qvel).unwrap_err().to_string().contains("qvel[0]"));
    qpos.clone_from(&pose.qpos);
    qpos[3..7].fill(0.0);
    assert!(character.set_pose(&qpos, &pose.qvel).unwrap_err().to_string().contains("quaternion"));
    assert!(character.stand_at(f32::NAN, 0.0, Heading::FORWARD, 0.0).is_err());
    assert_eq!(before, common::hash(&character));
}

/// The velocities that are sensed are the rates of change of the positions that are sensed.
#[test]
fn sensed_velocities_are_derivatives() {
    let mut character = afloat(&humanoid());
    run(&mut character, 4);
    let mut state = CharacterState::new(character.model().skeleton());
    let mut later = state.clone();
    character.sense_into(&mut state);
    let pose = character.pose();
    // Move along the velocity for a moment, by hand.
    let moment = 1e-3;
    let mut qpos = pose.qpos.clone();
    (0..3).for_each(|i| qpos[i] += moment * pose.qvel[i]);
    let [w, x, y, z] = [qpos[3], qpos[4], qpos[5], qpos[6]];
    let turn = glam::DVec3::new(pose.qvel[3], pose.qvel[4], pose.qvel[5]) * moment;
    let rotation = glam::DQuat::from_xyzw(x, y, z, w) * glam::DQuat::from_scaled_axis(turn);
    let [x, y, z, w] = rotation.normalize().to_array();
    qpos[3..7].copy_from_slice(&[w, x, y, z]);
    (7..qpos.len()).for_each(|i| qpos[i] += moment * pose.qvel[i - 1]);
    character.set_pose(&qpos, &pose.qvel).unwrap();
    character.sense_into(&mut later);
    for (body, after) in state.bodies.iter().zip(&later.bodies) {
        let linear = (after.position - body.position) / moment as f32;
        assert!((linear - body.linear_velocity).length() < 0.02, "{linear} against {body:?}");
        let angular = (after.rotation * body.rotation.inverse()).to_scaled_axis() / moment as f32;
        assert!((angular - body.angular_velocity).length() < 0.05, "{angular} against {body:?}");
    }
}

/// A step that the solver gives up on early can push a foot out of the ground at several metres per second.
#[test]
fn the_solver_brings_every_step_to_its_end() {
    let option = |name: &str| {
        let at = common::HUMANOID.find(&format!(" {name}=\"")).expect("an option of the model");
        let value = &common::HUMANOID[at + name.len() + 3..];
        format!(" {name}=\"{}\"", &value[..value.find('"').expect("the end of an attribute")])
    };
    let patient = common::HUMANOID
        .replace(&option("iterations"), " iterations=\"500\"")
        .replace(&option("ls_iterations"), " ls_iterations=\"500\"");
    let mut patient = Character::new(&Model::from_mjcf(&patient).unwrap());
    let mut character = Character::new(&humanoid());
    let mut worst = 0.0_f64;
    for tick in 0..3000 {
        if tick % 60 == 0 {
            character.stand_at(0.0, 0.0, Heading::FORWARD, 1.5).unwrap();
        }
        let (before, targets) = (character.pose(), wriggle(character.model().skeleton(), tick));
        patient.set_pose(&before.qpos, &before.qvel).unwrap();
        for each in [&mut character, &mut patient] {
            each.actuate(&targets);
            each.step().unwrap();
        }
        let (found, right) = (character.pose().qvel, patient.pose().qvel);
        let apart = found.iter().zip(&right).take(3).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        worst = worst.max(apart);
    }
    assert!(worst < 0.05, "the pelvis is {worst} m/s too fast");
}
