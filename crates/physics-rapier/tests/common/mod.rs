//! What the tests of this crate share.
#![allow(dead_code, missing_docs, reason = "each test uses its part")]

use physics_rapier::{Character, Model};
use policy_core::training::JointId;
use policy_core::{BodyId, JointTargets};

pub const HUMANOID: &str = include_str!("../../../../assets/humanoid.xml");

/// A crane: other bodies, order, rate and anchors than the humanoid's. One hinge is away from its body's origin, and one
/// body has two hinges of oblique axes.
pub const CRANE: &str = r#"<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.00555555555"/>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" pos="0 0 0.2"/>
    <body name="base" pos="0 0 0.5">
      <freejoint/>
      <geom type="box" size=".2 .3 .1" pos="0.05 0 0.1" density="500"/>
      <body name="arm" pos="0 0 .3" quat="0.9238795 0 0.3826834 0">
        <joint name="swing" axis="1 1 0" range="-1 1" armature=".05" damping="2"/>
        <joint name="twist" axis="0 0.6 0.8" range="-2 2" armature=".05" damping="1"/>
        <geom type="capsule" fromto="0 0 0 .4 0 0" size=".05" density="800"/>
        <body name="plate" pos=".4 0 0">
          <geom type="sphere" size=".06" density="400"/>
        </body>
        <body name="hook" pos=".4 0 -.1">
          <joint name="hang" axis="0 1 0" pos="0 0 .1" range="-1.5 1.5" armature=".02" damping=".5"/>
          <geom type="sphere" size=".08" density="900"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position joint="hang" kp="20" forcerange="-10 10"/>
    <position joint="swing" kp="80" forcerange="-60 60"/>
    <position joint="twist" kp="60" forcerange="-40 40"/>
  </actuator>
</mujoco>"#;

pub fn humanoid() -> Model {
    Model::from_mjcf(HUMANOID).unwrap()
}

pub fn crane() -> Model {
    Model::from_mjcf(CRANE).unwrap()
}

pub fn body(model: &Model, name: &str) -> BodyId {
    model.skeleton().body_named(name).unwrap()
}

pub fn joint(model: &Model, name: &str) -> JointId {
    model.skeleton().joint_named(name).unwrap()
}

/// The standing pose, its root at this height, at rest.
pub fn at_height(character: &mut Character, metres: f64) {
    let mut pose = character.pose();
    pose.qpos[2] = metres;
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
}

/// Steps `ticks` ticks of targets that keep the character moving, different in every tick.
pub fn wriggle(character: &mut Character, ticks: u64) {
    let mut targets = JointTargets::new(character.model().skeleton());
    for _ in 0..ticks {
        for (joint, target) in targets.iter_mut().enumerate() {
            // A triangle wave: the standard library's sine differs from machine to machine.
            *target = ((0.1 * character.tick() as f32 + 0.3 * joint as f32) % 2.0 - 1.0).abs() - 0.5;
        }
        character.actuate(&targets);
        character.step().unwrap();
    }
}

/// FNV-1a over the bits of the pose.
pub fn hash(character: &Character) -> u64 {
    let pose = character.pose();
    pose.qpos
        .iter()
        .chain(&pose.qvel)
        .fold(0xcbf2_9ce4_8422_2325, |hash, number| (hash ^ number.to_bits()).wrapping_mul(0x0100_0000_01b3))
}
