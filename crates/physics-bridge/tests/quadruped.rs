//! A character that is no humanoid goes through everything: MJCF, sense, actuate, step, crowd, save, restore.

mod common;

use std::num::NonZeroUsize;

use common::{QUADRUPED, body, hash, quadruped, run};
use glam::Vec3;
use physics_bridge::{BodyPoses, Character, Crowd, Model, ModelError, ReplayFile, World};
use policy_core::training::{JointId, Roles};
use policy_core::{BodyId, CharacterState, Heading, JointTargets, Skeleton};

fn joint(skeleton: &Skeleton, name: &str) -> usize {
    skeleton.joint_named(name).unwrap().index()
}

#[test]
fn its_skeleton_comes_from_the_mjcf() {
    let model = quadruped();
    let skeleton = model.skeleton();
    assert_eq!((skeleton.body_count(), skeleton.joint_count(), model.substeps()), (14, 13, 6));
    let names: Vec<_> = skeleton.bodies().iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names[..5], ["trunk", "head", "front_left_thigh", "front_left_shin", "front_left_foot"]);
    assert_eq!(skeleton.head(), Some(body(&model, "head")));
    assert!(skeleton.hands().is_empty());
    assert_eq!(skeleton.feet().len(), 4);
    assert_eq!(skeleton.parent(body(&model, "hind_right_shin")), Some(body(&model, "hind_right_thigh")));
    assert_eq!(joint(skeleton, "neck"), 12, "the last motor, though the first joint");
    let knee = &skeleton.joints()[joint(skeleton, "hind_left_knee")];
    assert_eq!((knee.body, knee.axis), (body(&model, "hind_left_shin"), Vec3::Y));
    assert!((knee.range[0] + 120.0_f32.to_radians()).abs() < 1e-6 && knee.range[1] == 0.0);
}

#[test]
fn its_actuation_is_read_from_the_model() {
    let model = quadruped();
    let actuation = model.actuation();
    assert_eq!(actuation.joints.len(), 13);
    assert!(
        (actuation.physics_hz - 180.0).abs() < 1e-2
            && (f64::from(actuation.mass_kg) - model.mass_kg()).abs() < 1e-4
    );
    let knee = actuation.joints[joint(model.skeleton(), "front_left_knee")];
    assert_eq!([knee.gain, knee.damping, knee.force_limit, knee.armature], [120.0, 4.0, 60.0, 0.01]);
    let neck = actuation.joints[joint(model.skeleton(), "neck")];
    assert_eq!([neck.gain, neck.damping, neck.force_limit, neck.armature], [20.0, 1.0, 10.0, 0.005]);
}

#[test]
fn it_stands_on_four_feet() {
    let model = quadruped();
    let mut character = Character::new(&model);
    (0..60).for_each(|_| character.step().unwrap());
    let mut state = CharacterState::new(model.skeleton());
    character.sense_into(&mut state);
    assert!(state.root_height() > 0.3 && state.root().linear_velocity.length() < 0.05, "{:?}", state.root());
    let touching: Vec<_> = character.contacts().iter().map(|contact| contact.body).collect();
    assert!(model.skeleton().feet().iter().all(|foot| touching.contains(foot)), "{touching:?}");
    let mut poses = BodyPoses::new(model.skeleton());
    character.poses_into(&mut poses);
    let positions: Vec<_> = state.bodies.iter().map(|b| b.position).collect();
    assert_eq!(poses.positions, positions);
}

#[test]
fn targets_reach_their_joints() {
    let model = quadruped();
    let mut character = Character::new(&model);
    let knee = joint(model.skeleton(), "hind_right_knee");
    let mut pose = character.pose();
    let mut targets =
        JointTargets::from(pose.qpos[7..].iter().map(|&angle| angle as f32).collect::<Vec<_>>());
    targets[knee] = -1.5;
    character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
    pose.qpos[2] += 5.0;
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
    character.actuate(&targets);
    (0..15).for_each(|_| character.step().unwrap());
    let found = character.pose().qpos;
    for (index, target) in targets.iter().enumerate() {
        assert!(
            (found[7 + index] as f32 - target).abs() < 0.1,
            "joint {index}: {} for {target}",
            found[7 + index]
        );
    }
    let mut state = CharacterState::new(model.skeleton());
    character.sense_into(&mut state);
    assert_eq!(state.joint_velocities[knee], character.pose().qvel[6 + knee] as f32);
}

#[test]
fn it_is_saved_restored_and_replayed_bit_for_bit() {
    let model = quadruped();
    let mut character = Character::new(&model);
    run(&mut character, 20);
    character.push(body(&model, "head"), Vec3::new(0.0, 30.0, 0.0), 0.3).unwrap();
    run(&mut character, 2);
    let saved = character.save();
    let mut replayed =
        ReplayFile::from_bytes(&character.replay_file().to_bytes()).unwrap().to_character().unwrap();
    run(&mut character, 30);
    run(&mut replayed, 30);
    assert_eq!(hash(&character), hash(&replayed));
    let end = hash(&character);
    character.restore(&saved).unwrap();
    run(&mut character, 30);
    assert_eq!(hash(&character), end);
    let humanoid = Character::new(&common::humanoid()).save();
    assert!(character.restore(&humanoid).is_err());
    assert!(character.push(BodyId::new(14), Vec3::X, 0.1).is_err());
}

#[test]
fn a_crowd_of_both_kinds_ticks() {
    let models = [quadruped(), common::humanoid()];
    let characters = || (0..6).map(|i| Character::new(&models[i % 2])).collect();
    let run = |threads| {
        let mut crowd = Crowd::new(characters(), NonZeroUsize::new(threads)).unwrap();
        for tick in 0..30 {
            let diverged = crowd.tick(|index, state, targets| {
                common::wriggle_into(tick + index as u64, targets);
                targets[1] += 0.1 * state.bodies[2].position.x;
            });
            assert_eq!(diverged, 0);
        }
        crowd.characters().map(hash).collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(3));
}

/// The same body under a skeleton in another order and with other roles moves the same.
#[test]
fn a_skeleton_of_another_order_is_honoured() {
    let model = quadruped();
    let skeleton = model.skeleton();
    let mut joints = skeleton.joints().to_vec();
    joints.reverse();
    let roles =
        Roles { hands: skeleton.feet()[..2].to_vec(), feet: skeleton.feet()[2..].to_vec(), head: None };
    let other = Skeleton::from_parts(skeleton.bodies().to_vec(), joints, roles).unwrap();
    let other = Model::from_mjcf_with_skeleton(QUADRUPED, other).unwrap();
    assert_eq!((other.skeleton().hands().len(), other.skeleton().head()), (2, None));
    assert_eq!(other.skeleton().joint_named("neck"), Some(JointId::new(0)));
    let (mut first, mut second) = (Character::new(&model), Character::new(&other));
    for tick in 0..20 {
        let mut targets = common::wriggle(skeleton, tick);
        first.actuate(&targets);
        targets.reverse();
        second.actuate(&targets);
        first.step().unwrap();
        second.step().unwrap();
    }
    assert_eq!(hash(&first), hash(&second));
}

/// A character of one hinge, made of these two geoms.
fn rocker(body: &str, foot: &str) -> String {
    format!(
        r#"<mujoco>
  <option timestep="0.00555555555"/>
  <asset><mesh name="wedge" vertex="0 0 0  .3 0 0  0 .3 0  0 0 .3"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="trunk" pos="0 0 1">
      <freejoint/>
      <inertial pos="0 0 0" mass="3" diaginertia=".1 .1 .1"/>
      {body}
      <body name="foot" pos="0 0 -.5">
        <joint name="ankle" axis="0 1 0" range="-30 30"/>
        <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/>
        {foot}
      </body>
    </body>
  </worldbody>
  <actuator><position joint="ankle" kp="20" forcerange="-10 10"/></actuator>
</mujoco>"#
    )
}

#[test]
fn a_character_of_cylinders_ellipsoids_or_meshes_stands() {
    let cylinder = r#"<geom type="cylinder" size=".1 .2"/>"#;
    let ellipsoid = r#"<geom type="ellipsoid" size=".1 .2 .3"/>"#;
    let mesh = r#"<geom type="mesh" mesh="wedge"/>"#;
    let cases = [("", cylinder, 0.7), (cylinder, ellipsoid, 0.8), ("", mesh, 0.5)];
    for (body, foot, reach) in cases {
        let model = Model::from_mjcf(&rocker(body, foot)).unwrap();
        let mut character = Character::new(&model);
        character.stand_at(1.0, 2.0, Heading::FORWARD, 0.0).unwrap();
        assert!(character.clearance().abs() < 1e-4, "{body}{foot}: {}", character.clearance());
        let height = character.pose().qpos[2];
        assert!((height - reach).abs() < 1e-4, "{body}{foot}: {height}");
        let mut world = World::new(&model).unwrap();
        let stood = world.edit(|edit| edit.add_character(&model, 1.0, 2.0, Heading::FORWARD, 0.0)).unwrap();
        let mut pose = character.pose();
        world.pose_into(stood, &mut pose).unwrap();
        assert!((pose.qpos[2] - height).abs() < 1e-4, "{body}{foot}: {}", pose.qpos[2]);
    }
    let error = Model::from_mjcf(&rocker("", "")).unwrap_err();
    assert!(matches!(error, ModelError::NoGeoms), "{error}");
}

#[test]
fn longer_steps_are_longer_or_refused() {
    let text = rocker(r#"<geom type="sphere" size=".1"/>"#, "");
    let longer = Model::from_mjcf(&text).unwrap().with_time_step(2.0).unwrap();
    assert!((longer.timestep_secs() - 0.0111111111).abs() < 1e-9 && longer.substeps() == 3);
    for other in [r#"timestep='0.00555555555'"#, "\ttimestep=\"0.00555555555\""] {
        let model = Model::from_mjcf(
            &text.replace(r#" timestep="0.00555555555""#, &format!(" {other}")).replace(" \t", "\t"),
        )
        .unwrap();
        let error = model.with_time_step(2.0).unwrap_err();
        assert!(matches!(error, ModelError::TimestepText { .. }), "{error}");
    }
}
