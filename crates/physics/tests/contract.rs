//! What every physics keeps, tested by the same functions in each engine.

use physics::{Character, Engine, Model, PhysicsCharacter};
use physics_bridge::Terrain;
use policy_core::contract::{
    MAX_DEPTH_M, MAX_DISTANCE_M, MAX_PUSHED_MPS, MAX_SPEED_MPS, MAX_SPIN_RADPS, Pose, Settings,
};
use policy_core::glam::{Vec2, Vec3};
use policy_core::{BodyId, CharacterState, Heading, ground_lookahead_secs};

const HUMANOID: &str = include_str!("../../../assets/humanoid.xml");
const HILLS: Terrain = Terrain::Wavy { height_m: 0.35, wavelength_m: 6.0, seed: 7 };
const GRAVITY: f32 = 9.81;

fn models() -> [Model; 2] {
    let described = physics_bridge::Model::from_mjcf(HUMANOID).unwrap();
    Engine::ALL.map(|engine| Model::new(&described, engine).unwrap())
}

fn with(model: &Model, change: impl FnOnce(&mut Settings)) -> Model {
    let mut settings = Settings::default();
    change(&mut settings);
    model.with_settings(settings).unwrap()
}

fn body(character: &Character, name: &str) -> BodyId {
    character.skeleton().body_named(name).unwrap()
}

fn state(character: &Character) -> CharacterState {
    let mut state = CharacterState::new(character.skeleton());
    character.sense_into(&mut state);
    state
}

fn steps(character: &mut Character, ticks: usize) {
    (0..ticks).for_each(|_| character.step().unwrap());
}

fn posed(character: &mut Character, change: impl FnOnce(&mut Pose)) {
    let mut pose = character.pose();
    change(&mut pose);
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
}

fn afloat(model: &Model) -> Character {
    let mut character = Character::new(model);
    posed(&mut character, |pose| pose.qpos[2] += 100.0);
    character
}

fn largest_difference(a: &Pose, b: &Pose) -> f64 {
    let (a, b) = (a.qpos.iter().chain(&a.qvel), b.qpos.iter().chain(&b.qvel));
    a.zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn it_stands_where_it_is_told_and_stays_there() {
    for model in models() {
        let mut character = Character::new(&model);
        let heading = Heading::from_angle(2.0);
        character.stand_at(3.0, -2.0, heading, 1.5).unwrap();
        let root = *state(&character).root();
        assert!((root.position.truncate() - Vec2::new(3.0, -2.0)).length() < 1e-5);
        assert!((Heading::from_rotation(root.rotation).angle() - 2.0).abs() < 1e-5);
        assert!((root.linear_velocity.truncate() - 1.5 * heading.direction()).length() < 1e-5);
        for name in ["left_foot", "right_foot"] {
            let clearance = character.clearance_of(body(&character, name));
            assert!(clearance.abs() < 1e-3, "{name}: {clearance} m");
        }
        character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
        steps(&mut character, 15);
        let load: f32 = ["left_foot", "right_foot"]
            .iter()
            .map(|foot| character.ground_load(body(&character, foot)))
            .sum();
        let weight = GRAVITY * model.described().mass_kg() as f32;
        assert!((load - weight).abs() < 0.15 * weight, "{load} N for {weight} N");
    }
}

#[test]
fn a_pose_comes_back_as_it_was_set() {
    for model in models() {
        let mut character = Character::new(&model);
        let mut wanted = character.pose();
        wanted.qpos[..7].copy_from_slice(&[1.0, -2.0, 3.0, 0.5, 0.5, -0.5, 0.5]);
        wanted.qpos[7..].iter_mut().enumerate().for_each(|(i, q)| *q = 0.05 * i as f64 % 0.3);
        wanted.qvel.iter_mut().enumerate().for_each(|(i, v)| *v = 0.1 * i as f64);
        character.set_pose(&wanted.qpos, &wanted.qvel).unwrap();
        assert!(largest_difference(&character.pose(), &wanted) < 1e-5);
    }
}

#[test]
fn it_falls_as_gravity_says_and_a_push_adds_its_momentum() {
    for model in models() {
        for (factor, force) in [(1.0, 0.0), (0.165, 0.0), (0.0, 100.0)] {
            let model = with(&model, |settings| settings.gravity = factor);
            let mut character = afloat(&model);
            let start = character.centre_of_mass();
            let torso = body(&character, "torso");
            character.push(torso, Vec3::Y * force, 0.2).unwrap();
            steps(&mut character, 15);
            let moved = character.centre_of_mass() - start;
            assert!((moved.z + 0.5 * GRAVITY * factor * 0.25).abs() < 0.03, "{moved} at {factor} g");
            // 0.2 s of the force, then 0.3 s of its velocity.
            let speed = 0.2 * force / model.described().mass_kg() as f32;
            assert!((moved.y - speed * 0.4).abs() < 0.01, "{moved} by {force} N");
            assert!(!character.is_pushed(torso));
        }
    }
}

#[test]
fn its_legs_touch_each_other_and_other_limbs_do_not() {
    // Ranges let the knees cross, and an upper arm lie in the torso.
    let driven = [("right_hip_x", 0.26), ("left_hip_x", -0.26), ("right_shoulder_x", 0.78)];
    let gaps = models().map(|model| {
        let mut character = afloat(&with(&model, |settings| settings.gravity = 0.0));
        let mut targets = vec![0.0; model.skeleton().joint_count()];
        for (name, target) in driven {
            targets[model.skeleton().joint_named(name).unwrap().index()] = target;
        }
        let (mut gap, engine) = (f32::INFINITY, model.engine().title());
        for _ in 0..30 {
            character.actuate(&targets);
            steps(&mut character, 1);
            let state = state(&character);
            let of = |name| state.body(body(&character, name));
            let knees = of("left_shin").position - of("right_shin").position;
            gap = gap.min((of("pelvis").rotation.inverse() * knees).y);
        }
        let state = state(&character);
        let of = |name| state.body(body(&character, name));
        let torso = of("torso").position + of("torso").rotation * Vec3::Z * 0.12;
        let depth = 0.11 - of("right_lower_arm").position.distance(torso);
        assert!(depth > 0.0, "{engine}: the elbow is {depth} m in the torso");
        // Knees of 0.05 m each.
        assert!(gap > 0.08, "{engine}: knees {gap} m apart");
        gap
    });
    assert!((gaps[0] - gaps[1]).abs() < 0.02, "{gaps:?}");
}

#[test]
fn pushes_that_are_repeated_drive_a_body_no_faster_than_the_limit() {
    for model in models() {
        let mut character = afloat(&model);
        let (torso, mut fastest) = (body(&character, "torso"), 0.0_f32);
        for _ in 0..60 {
            character.push(torso, Vec3::X * 5000.0, 1.0).unwrap();
            character.impulse(torso, Vec3::X * 20.0).unwrap();
            steps(&mut character, 1);
            fastest = fastest.max(state(&character).body(torso).linear_velocity.x);
        }
        let engine = model.engine().title();
        assert!(fastest > 0.8 * MAX_PUSHED_MPS, "{engine}: {fastest} m/s");
        // One step's worth above: the whole impulse on a torso of 10 kg and more.
        assert!(fastest < MAX_PUSHED_MPS + 8.0, "{engine}: {fastest} m/s");
        // Against its motion a push acts at once.
        let before = character.centre_of_mass();
        steps(&mut character, 1);
        let speed = (character.centre_of_mass() - before).x;
        character.push(torso, Vec3::NEG_X * 5000.0, 0.5).unwrap();
        steps(&mut character, 6);
        let (before, last) = (character.centre_of_mass(), speed);
        steps(&mut character, 1);
        assert!((character.centre_of_mass() - before).x < 0.5 * last, "{engine}");
    }
}

#[test]
fn what_is_no_number_is_refused_and_changes_nothing() {
    for model in models() {
        let mut character = Character::new(&model);
        let (before, root) = (character.pose(), character.skeleton().root());
        let mut bad = before.clone();
        bad.qpos[9] = f64::NAN;
        assert!(character.set_pose(&bad.qpos, &bad.qvel).is_err());
        assert!(character.set_pose(&before.qpos[1..], &before.qvel).is_err());
        assert!(character.stand_at(f32::INFINITY, 0.0, Heading::FORWARD, 0.0).is_err());
        assert!(character.push(root, Vec3::NAN, 0.1).is_err());
        assert!(character.push(root, Vec3::X, -0.1).is_err());
        assert!(character.push(BodyId::new(99), Vec3::X, 0.1).is_err());
        assert!(character.impulse(root, Vec3::X * 1e9).is_err());
        assert!(!character.is_pushed(root));
        assert_eq!(character.pose(), before);
        assert!(model.with_settings(Settings { mass: 0.0, ..Settings::default() }).is_err());
    }
}

/// Name, and what makes a pose that no motion leads to.
type Wrong = (&'static str, fn(&mut Pose));

#[test]
fn implausible_motion_is_undone_and_told_again_until_it_is_posed() {
    let wrongs: [Wrong; 4] = [
        ("speed", |pose| pose.qvel[0] = f64::from(2.0 * MAX_SPEED_MPS)),
        ("spin", |pose| {
            pose.qpos[2] += 50.0;
            pose.qvel[4] = f64::from(2.0 * MAX_SPIN_RADPS);
        }),
        ("depth", |pose| pose.qpos[2] = f64::from(-8.0 * MAX_DEPTH_M)),
        ("distance", |pose| pose.qpos[0] = f64::from(1.1 * MAX_DISTANCE_M)),
    ];
    for model in models() {
        for (what, wrong) in wrongs {
            let mut character = Character::new(&model);
            posed(&mut character, wrong);
            let before = character.pose();
            for _ in 0..2 {
                let engine = model.engine().title();
                assert!(character.step().is_err(), "{engine}: {what}");
                let apart = largest_difference(&character.pose(), &before);
                assert!(apart < 1e-3, "{engine}: {what}: {apart}");
                assert_eq!(character.tick(), 0);
            }
            character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
            steps(&mut character, 3);
        }
    }
}

#[test]
fn a_snapshot_continues_bit_for_bit_and_fits_its_own_model_only() {
    let [mujoco, rapier] = models();
    for (model, other) in [(&mujoco, &rapier), (&rapier, &mujoco)] {
        let mut character = Character::new(model);
        posed(&mut character, |pose| pose.qpos[2] += 0.1);
        character.push(character.skeleton().root(), Vec3::X * 80.0, 0.5).unwrap();
        steps(&mut character, 8);
        let saved = character.save();
        steps(&mut character, 10);
        let mut again = Character::new(model);
        again.restore(&saved).unwrap();
        assert_eq!(again.tick(), 8);
        steps(&mut again, 10);
        assert_eq!(again.pose(), character.pose(), "in {}", model.engine().title());
        assert!(Character::new(other).restore(&saved).is_err());
        assert!(character.set_model(other).is_err());
    }
}

#[test]
fn settings_change_under_way() {
    for model in models() {
        let heavy = with(&model, |settings| settings.mass = 2.0);
        let weight = 2.0 * GRAVITY * model.described().mass_kg() as f32;
        let mut character = Character::new(&model);
        steps(&mut character, 3);
        character.set_model(&heavy).unwrap();
        steps(&mut character, 12);
        let load: f32 = (0..15).map(|i| character.ground_load(BodyId::new(i))).sum();
        assert!((load - weight).abs() < 0.25 * weight, "{load} N for {weight} N");
        character.set_model(&with(&model, |settings| settings.strength = 0.0)).unwrap();
        steps(&mut character, 60);
        assert!(state(&character).root_height() < 0.5, "it collapses in {}", model.engine().title());
    }
}

#[test]
fn ice_carries_it_further() {
    for model in models() {
        let slid = |friction: f32| {
            let mut character = Character::new(&with(&model, |settings| settings.friction = friction));
            posed(&mut character, |pose| {
                // On its back, sliding.
                (pose.qpos[2], pose.qpos[3], pose.qpos[5]) = (0.15, 0.5_f64.sqrt(), -(0.5_f64.sqrt()));
                pose.qvel[0] = 2.0;
            });
            steps(&mut character, 30);
            character.centre_of_mass().x
        };
        let (rough, ice) = (slid(1.0), slid(0.05));
        assert!(ice > rough + 0.5, "{}: {rough} m and {ice} m", model.engine().title());
    }
}

#[test]
fn hills_are_where_they_are_said_to_be() {
    for model in models() {
        let model = model.with_terrain(HILLS).unwrap();
        for (x, y) in [(0.3, 0.7), (5.2, -8.1), (-11.0, 4.4)] {
            let mut character = Character::new(&model);
            character.stand_at(x, y, Heading::FORWARD, 0.0).unwrap();
            steps(&mut character, 6);
            let state = state(&character);
            let at = state.root().position;
            assert_eq!(state.ground_height, model.described().height_at(at.x, at.y));
            for name in ["left_foot", "right_shin"] {
                let leg = body(&character, name);
                let moving = state.body(leg);
                let ahead = ground_lookahead_secs(model.skeleton(), leg).unwrap();
                let comes_to = moving.position + ahead * moving.linear_velocity;
                let rise = model.described().height_at(comes_to.x, comes_to.y) - state.ground_height;
                assert_eq!(state.ground_rises[leg.index()], rise, "{name} in {}", model.engine().title());
            }
            let feet = ["left_foot", "right_foot"].map(|foot| state.body(body(&character, foot)).position);
            for foot in feet {
                let above = foot.z - model.described().height_at(foot.x, foot.y);
                assert!(
                    (0.0..0.12).contains(&above),
                    "{} m above {x}, {y} in {}",
                    above,
                    model.engine().title()
                );
            }
        }
    }
}

/// On stiffer contacts a crawl falls.
#[test]
fn feet_that_are_pressed_give_alike() {
    let [mujoco, rapier] = models().map(|model| {
        let mut character = Character::new(&model);
        character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
        steps(&mut character, 15);
        let torso = body(&character, "torso");
        character.push(torso, -1000.0 * Vec3::Z, 0.2).unwrap();
        let mut deepest = 0.0_f32;
        for _ in 0..8 {
            steps(&mut character, 1);
            for foot in ["left_foot", "right_foot"] {
                deepest = deepest.min(character.clearance_of(body(&character, foot)));
            }
        }
        deepest
    });
    assert!(mujoco < -0.003, "{mujoco} m: the push does not press them down");
    assert!((rapier - mujoco).abs() < 0.0015, "{rapier} m in Rapier, {mujoco} m in MuJoCo");
}
