//! A shared world to test in.

use physics_bridge::{CharacterHandle, Model, Motion, Pose, Prop, PropHandle, World};
use policy_core::{Heading, JointTargets};

use super::{humanoid, wriggle_into};

pub fn world() -> (World, Model) {
    let model = humanoid();
    (World::new(&model).unwrap(), model)
}

pub fn add(world: &mut World, model: &Model, x: f32, y: f32, degrees: f32, speed: f32) -> CharacterHandle {
    let heading = Heading::from_angle(degrees.to_radians());
    world.edit(|edit| edit.add_character(model, x, y, heading, speed)).unwrap()
}

pub fn put(world: &mut World, prop: Prop, motion: Motion) -> PropHandle {
    world.edit(|edit| edit.add_prop(prop, motion)).unwrap()
}

pub fn run(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        assert_eq!(world.step(), 0, "{:?}", world.divergences());
    }
}

/// Moves all characters, each in its own way.
pub fn wriggle(world: &mut World, ticks: u32) {
    let characters: Vec<_> = world.characters().collect();
    for _ in 0..ticks {
        for &character in &characters {
            let mut targets = JointTargets::new(world.model(character).unwrap().skeleton());
            wriggle_into(world.tick() + 17 * character.index() as u64, &mut targets);
            world.actuate(character, &targets).unwrap();
        }
        assert_eq!(world.step(), 0, "{:?}", world.divergences());
    }
}

pub fn pose(world: &World, character: CharacterHandle) -> Pose {
    let mut pose = Pose::new(world.model(character).unwrap().skeleton());
    world.pose_into(character, &mut pose).unwrap();
    pose
}

/// The bits of everything that a character and a prop are in.
pub fn bits(world: &World, character: CharacterHandle) -> Vec<u64> {
    let pose = pose(world, character);
    pose.qpos.iter().chain(&pose.qvel).map(|number| number.to_bits()).collect()
}
