//! What Rapier and its MJCF loader do otherwise than a policy needs, one test each.

mod common;

use common::{at_height, body, crane, humanoid, joint, wriggle};
use physics_rapier::rapier3d::prelude::*;
use physics_rapier::{Articulation, Character, Drive, Model, Sets};
use policy_core::glam::Vec3;
use policy_core::{CharacterState, Heading};

const GRAVITY: f64 = 9.81;

/// A game's world, z up, without ground.
fn game() -> PhysicsWorld {
    let mut world = PhysicsWorld { gravity: Vector::new(0.0, 0.0, -9.81), ..PhysicsWorld::new() };
    world.integration_parameters.dt = 1.0 / 120.0;
    Drive::Torques.tune(&mut world.integration_parameters);
    world
}

fn insert(model: &Model, world: &mut PhysicsWorld) -> Articulation {
    Articulation::insert(model, &mut Sets::from(world), Drive::Torques, InteractionGroups::all())
}

fn step(character: &mut Articulation, world: &mut PhysicsWorld) {
    character.before_step(&mut world.bodies, &mut world.multibody_joints).unwrap();
    world.step();
}

/// Rapier integrates a free root as if its centre of mass were its origin. The humanoid's is 11 cm above it.
#[test]
fn the_centre_of_mass_of_a_tumbling_character_falls_straight() {
    for model in [humanoid(), crane()] {
        let mut character = Character::new(&model);
        at_height(&mut character, 100.0);
        let mut pose = character.pose();
        pose.qvel[4] = 3.0;
        character.set_pose(&pose.qpos, &pose.qvel).unwrap();
        let start = character.centre_of_mass();
        // The root's frame is away from the centre of mass, which therefore moves at once.
        let mut after_one = character.pose();
        character.step().unwrap();
        let first = character.centre_of_mass();
        for _ in 1..15 {
            character.step().unwrap();
        }
        character.pose_into(&mut after_one);
        let secs = 15.0 / f64::from(model.control_hz());
        let velocity = (first - start) * model.control_hz();
        let drift = (character.centre_of_mass() - start) - velocity * secs as f32;
        let step = model.timestep_secs();
        // Semi-implicit Euler: n steps fall by g h^2 n (n + 1) / 2, and the first tick is part of `velocity`.
        let (n, m) = (15.0 * f64::from(model.substeps()), f64::from(model.substeps()));
        let fallen = 0.5 * GRAVITY * step * step * (n * (n + 1.0) - 15.0 * m * (m + 1.0));
        assert!(drift.truncate().length() < 5e-3, "{drift}");
        assert!((f64::from(drift.z) + fallen).abs() < 5e-3, "{drift} against {fallen}");
    }
}

/// A body's `linvel` is the one at the start of Rapier's last substep.
#[test]
fn sensed_velocities_are_those_of_now() {
    for model in [humanoid(), crane()] {
        let mut character = Character::new(&model);
        at_height(&mut character, 50.0);
        wriggle(&mut character, 5);
        // Velocities against positions a moment later, all else the same.
        let (pose, dt) = (character.pose(), 1e-3);
        let [mut before, mut after] = [(); 2].map(|()| CharacterState::new(model.skeleton()));
        let q = policy_core::glam::Quat::from_xyzw(
            pose.qpos[4] as f32,
            pose.qpos[5] as f32,
            pose.qpos[6] as f32,
            pose.qpos[3] as f32,
        );
        let at = |secs: f64, out: &mut CharacterState| {
            let mut moved = pose.clone();
            (0..3).for_each(|i| moved.qpos[i] += secs * pose.qvel[i]);
            let w = Vec3::new(pose.qvel[3] as f32, pose.qvel[4] as f32, pose.qvel[5] as f32);
            let turned = q * policy_core::glam::Quat::from_scaled_axis(w * secs as f32);
            let turned = [turned.w, turned.x, turned.y, turned.z].map(f64::from);
            moved.qpos[3..7].copy_from_slice(&turned);
            (7..moved.qpos.len()).for_each(|i| moved.qpos[i] += secs * pose.qvel[i - 1]);
            moved.qpos[2] -= 49.0; // close to the origin, where single precision is fine
            let mut other = Character::new(&model);
            other.set_pose(&moved.qpos, &moved.qvel).unwrap();
            other.sense_into(out);
        };
        at(-dt, &mut before);
        at(dt, &mut after);
        let mut now = CharacterState::new(model.skeleton());
        character.sense_into(&mut now);
        let mut fastest: f32 = 0.0;
        for ((body, before), after) in now.bodies.iter().zip(&before.bodies).zip(&after.bodies) {
            let velocity = (after.position - before.position) / (2.0 * dt as f32);
            assert!((velocity - body.linear_velocity).length() < 0.01, "{velocity} {}", body.linear_velocity);
            let spin = (after.rotation * before.rotation.inverse()).to_scaled_axis() / (2.0 * dt as f32);
            assert!((spin - body.angular_velocity).length() < 0.02, "{spin} {}", body.angular_velocity);
            fastest = fastest.max(spin.length());
        }
        assert!(fastest > 0.5, "the character moves, {fastest}");
    }
}

/// The loader skips planes.
#[test]
fn the_plane_of_the_mjcf_carries_it() {
    for (model, floor) in [(humanoid(), 0.0), (crane(), 0.2)] {
        let mut character = Character::new(&model);
        let mut state = CharacterState::new(model.skeleton());
        (0..30).for_each(|_| character.step().unwrap());
        character.sense_into(&mut state);
        assert_eq!(state.ground_height, floor);
        assert!(state.root_height() > -0.01, "{}", state.root_height());
        assert!(state.root().linear_velocity.length() < 2.0);
    }
}

/// The loader's contact groups let all limbs touch each other. In training only the legs did.
#[test]
fn legs_touch_and_other_limbs_pass_through_each_other() {
    let model = humanoid();
    let mut world = game();
    world.gravity = Vector::ZERO;
    let mut character = insert(&model, &mut world);
    character.stand_at(&mut Sets::from(&mut world), [0.0, 0.0, 5.0], Heading::FORWARD, 0.0).unwrap();
    // Both thighs swing inwards, shin into shin, and an upper arm into the torso.
    let mut targets = character.targets().to_vec();
    for (name, target) in [("right_hip_x", 0.26), ("left_hip_x", -0.26), ("right_shoulder_x", 0.78)] {
        targets[joint(&model, name).index()] = target;
    }
    character.actuate(&targets);
    let mut touched = std::collections::BTreeSet::new();
    let body_of =
        |world: &PhysicsWorld, collider: ColliderHandle| world.colliders[collider].parent().unwrap();
    for _ in 0..60 {
        step(&mut character, &mut world);
        for pair in world.narrow_phase.contact_pairs().filter(|pair| pair.has_any_active_contact()) {
            let mut names = [pair.collider1, pair.collider2].map(|collider| {
                let handle = body_of(&world, collider);
                let at = character.bodies().iter().position(|&body| body == handle).unwrap();
                model.skeleton().bodies()[at].name.as_str()
            });
            names.sort_unstable();
            touched.insert(names);
        }
    }
    assert!(touched.contains(&["left_shin", "right_shin"]), "{touched:?}");
    let is_leg = |name: &str| ["thigh", "shin", "foot"].iter().any(|part| name.ends_with(part));
    for [left, right] in &touched {
        assert!(left.starts_with("left") && is_leg(left), "{touched:?}");
        assert!(right.starts_with("right") && is_leg(right), "{touched:?}");
    }
    let mut state = CharacterState::new(model.skeleton());
    character.sense_into(&world.bodies, &world.multibody_joints, 0.0, &mut state).unwrap();
    let place = |name| state.body(body(&model, name)).position;
    assert!(
        place("right_lower_arm").distance(place("torso") + Vec3::Z * 0.12) < 0.11,
        "the arm is in the torso"
    );

    character.remove(&mut Sets::from(&mut world));
    assert!(world.impulse_joints.is_empty(), "what holds pairs apart leaves with the character");
}

/// Parts of two characters touch as their groups say, whatever the bits of the MJCF.
#[test]
fn characters_touch_each_other() {
    let model = humanoid();
    let mut world = game();
    let [mut one, mut other] = [(); 2].map(|()| insert(&model, &mut world));
    for (character, place) in [(&mut one, 0.0), (&mut other, 0.15)] {
        character.stand_at(&mut Sets::from(&mut world), [place, 0.0, 5.0], Heading::FORWARD, 0.0).unwrap();
    }
    let mut torsos = 0;
    let torso = body(&model, "torso").index();
    for _ in 0..20 {
        one.before_step(&mut world.bodies, &mut world.multibody_joints).unwrap();
        step(&mut other, &mut world);
        for pair in world.narrow_phase.contact_pairs().filter(|pair| pair.has_any_active_contact()) {
            let parents = [pair.collider1, pair.collider2].map(|c| world.colliders[c].parent().unwrap());
            let both = [one.bodies()[torso], other.bodies()[torso]];
            torsos += u32::from(parents == both || parents == [both[1], both[0]]);
        }
    }
    assert!(torsos > 0, "two torsos in one place touch");
}

/// Rapier damps the rotation of a free root by 0.1 N m s.
#[test]
fn nothing_slows_its_rotation_in_flight() {
    let model = crane();
    let mut character = Character::new(&model);
    at_height(&mut character, 100.0);
    let handle = character.articulation().bodies()[0];
    let joint = character.world().multibody_joints.attached_joints(handle).next().unwrap().2;
    let (multibody, _) = character.world().multibody_joints.get(joint).unwrap();
    assert!(multibody.damping().rows(0, 6).iter().all(|&damping| damping == 0.0));
    assert!(multibody.damping().rows(6, 3).iter().all(|&damping| damping > 0.0), "hinges keep theirs");
}

/// Rapier puts bodies at rest to sleep, and a sleeping body ignores its motors.
#[test]
fn it_never_sleeps() {
    let model = humanoid();
    let mut world = game();
    world.colliders.insert(ColliderBuilder::cuboid(5.0, 5.0, 0.5).translation(Vector::new(0.0, 0.0, -0.5)));
    let mut character = insert(&model, &mut world);
    let lying = {
        let mut pose = physics_rapier::Pose::new(model.skeleton());
        pose.qpos[2] = 0.3;
        (pose.qpos[3], pose.qpos[5]) = (0.5_f64.sqrt(), -(0.5_f64.sqrt()));
        pose
    };
    character.set_pose(&mut Sets::from(&mut world), &lying.qpos, &lying.qvel).unwrap();
    for _ in 0..600 {
        step(&mut character, &mut world);
    }
    let mut pose = lying.clone();
    character.pose_into(&world.bodies, &world.multibody_joints, &mut pose).unwrap();
    let elbow = joint(&model, "right_elbow").index();
    let before = pose.qpos[7 + elbow];
    let mut targets = character.targets().to_vec();
    targets[elbow] = -1.0;
    character.actuate(&targets);
    for _ in 0..60 {
        step(&mut character, &mut world);
    }
    character.pose_into(&world.bodies, &world.multibody_joints, &mut pose).unwrap();
    assert!(pose.qpos[7 + elbow] < before - 0.5, "from {before} to {}", pose.qpos[7 + elbow]);
}

/// Rapier loses an impulse on a link of a multibody.
#[test]
fn pushes_and_impulses_change_its_momentum() {
    let model = humanoid();
    let torso = body(&model, "torso");
    let hand = body(&model, "right_hand");
    let mass = model.mass_kg() as f32;
    let velocity_after = |act: &dyn Fn(&mut Character)| {
        let mut character = Character::new(&model);
        at_height(&mut character, 100.0);
        act(&mut character);
        (0..3).for_each(|_| character.step().unwrap());
        let before = character.centre_of_mass();
        character.step().unwrap();
        (character.centre_of_mass() - before) * model.control_hz()
    };
    let pushed = velocity_after(&|character| character.push(torso, Vec3::X * 100.0, 0.1).unwrap());
    assert!((pushed.x - 100.0 * 0.1 / mass).abs() < 5e-3, "{pushed}");
    let hit = velocity_after(&|character| character.impulse(hand, Vec3::Y * 4.0).unwrap());
    assert!((hit.y - 4.0 / mass).abs() < 5e-3, "{hit}");
}

/// A game may take out what it put in, and parts of it behind the character's back.
#[test]
fn it_can_be_taken_out_and_missed() {
    let model = humanoid();
    let mut world = game();
    let character = insert(&model, &mut world);
    character.remove(&mut Sets::from(&mut world));
    assert!(world.bodies.is_empty() && world.colliders.is_empty());
    assert_eq!(world.multibody_joints.multibodies().count(), 0);

    let mut character = insert(&model, &mut world);
    let foot = character.bodies()[body(&model, "left_foot").index()];
    world.bodies.remove(
        foot,
        &mut world.islands,
        &mut world.colliders,
        &mut world.impulse_joints,
        &mut world.multibody_joints,
        &mut world.soft_bodies,
        true,
    );
    let mut state = CharacterState::new(model.skeleton());
    let sensed = character.sense_into(&world.bodies, &world.multibody_joints, 0.0, &mut state);
    let stepped = character.before_step(&mut world.bodies, &mut world.multibody_joints);
    for error in [sensed.unwrap_err(), stepped.unwrap_err()] {
        assert_eq!((error.kind, error.name.starts_with("left_ankle")), ("hinge", true), "{error}");
    }
    character.remove(&mut Sets::from(&mut world));
    assert!(world.bodies.is_empty());
}

/// Rapier multiplies the root's rotation by a small one in every step and never makes it a unit quaternion again.
#[test]
fn rotations_stay_rotations() {
    let model = crane();
    let mut character = Character::new(&model);
    let mut state = CharacterState::new(model.skeleton());
    wriggle(&mut character, 1800);
    character.sense_into(&mut state);
    for body in &state.bodies {
        let length = body.rotation.length();
        assert!((length - 1.0).abs() < 1e-4, "{length} after {} ticks", character.tick());
    }
}

/// A slow turn lengthens the quaternion by the same bits in every step, for hours.
#[test]
fn a_slow_sway_for_minutes_leaves_its_rotation_a_unit_quaternion() {
    let weightless = policy_core::contract::Settings { gravity: 0.0, ..Default::default() };
    let model = crane().with_settings(weightless).unwrap();
    let mut character = Character::new(&model);
    at_height(&mut character, 2.0);
    let mut pose = character.pose();
    pose.qvel[3..6].copy_from_slice(&[0.02, 0.02, 0.028]);
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
    for tick in 0..1500 {
        character.step().unwrap();
        let root = character.articulation().bodies()[0];
        let length = character.world().bodies[root].rotation().length();
        assert!((length - 1.0).abs() < 1e-5, "{length} after {tick} ticks");
    }
    assert!(character.pose().qvel[3..6].iter().map(|w| w * w).sum::<f64>().sqrt() > 0.03, "it still turns");
    character.set_model(&model).unwrap();
    character.step().unwrap();
}
