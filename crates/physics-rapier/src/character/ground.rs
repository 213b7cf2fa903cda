//! The world of one character: the ground of its MJCF, and Rapier's parameters.

use rapier3d::geometry::InteractionGroups;
use rapier3d::pipeline::PhysicsWorld;

use crate::articulation::{Articulation, Drive, Sets};
use crate::model::Model;

/// Physics steps per second with [`Drive::Motors`].
const MOTORS_HZ: f32 = 60.0;

/// Physics steps in a control tick with [`Drive::Motors`].
pub(super) fn motor_steps(model: &Model) -> u32 {
    (MOTORS_HZ / model.control_hz()).round().max(1.0) as u32
}

/// A world with the ground of the MJCF and one character.
pub(super) fn world(model: &Model, drive: Drive) -> (PhysicsWorld, Articulation) {
    let mut world = empty_world(model, drive);
    let articulation =
        Articulation::insert(model, &mut Sets::from(&mut world), drive, InteractionGroups::all());
    (world, articulation)
}

/// A world with the ground of the MJCF and nothing on it.
pub(crate) fn empty_world(model: &Model, drive: Drive) -> PhysicsWorld {
    let mut world = PhysicsWorld { gravity: model.gravity(), ..PhysicsWorld::new() };
    let parameters = &mut world.integration_parameters;
    drive.tune(parameters);
    parameters.dt = match drive {
        Drive::Torques => model.timestep_secs() as f32,
        Drive::Motors => 1.0 / (model.control_hz() * motor_steps(model) as f32),
    };
    for mut collider in model.ground() {
        collider.set_collision_groups(InteractionGroups::all());
        world.colliders.insert(collider);
    }
    world
}
