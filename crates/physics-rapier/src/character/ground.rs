//! The world of one character: the ground of its MJCF, and Rapier's parameters.

use rapier3d::geometry::{Collider, InteractionGroups};
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;

use crate::articulation::{Articulation, Drive, Sets};
use crate::model::Model;

/// Physics steps per second with [`Drive::Motors`], and Rapier's substeps in each.
const MOTORS_HZ: f32 = 60.0;
const MOTORS_SUBSTEPS: usize = 2;

/// Physics steps in a control tick with [`Drive::Motors`].
pub(super) fn motor_steps(model: &Model) -> u32 {
    (MOTORS_HZ / model.control_hz()).round().max(1.0) as u32
}

/// A world with the ground of the MJCF and one character.
pub(super) fn world(model: &Model, drive: Drive) -> (PhysicsWorld, Articulation) {
    let mut world = PhysicsWorld { gravity: model.gravity(), ..PhysicsWorld::new() };
    let parameters = &mut world.integration_parameters;
    (parameters.dt, parameters.num_solver_iterations) = match drive {
        Drive::Torques => (model.timestep_secs() as f32, 1),
        Drive::Motors => (1.0 / (model.control_hz() * motor_steps(model) as f32), MOTORS_SUBSTEPS),
    };
    for collider in model.ground() {
        let mut collider = collider.clone();
        collider.set_collision_groups(InteractionGroups::all());
        world.colliders.insert(collider);
    }
    let articulation =
        Articulation::insert(model, &mut Sets::from(&mut world), drive, InteractionGroups::all());
    (world, articulation)
}

/// Height of the planes at a point, metres; 0 without one.
pub(super) fn height_at(world: &PhysicsWorld, x: f32, y: f32) -> f32 {
    let loose = world.colliders.iter().map(|(_, c)| c).filter(|c| c.parent().is_none());
    loose.filter_map(|collider| plane_height(collider, x, y)).reduce(f32::max).unwrap_or(0.0)
}

/// Height of a plane that faces up.
fn plane_height(collider: &Collider, x: f32, y: f32) -> Option<f32> {
    let plane = collider.shape().as_halfspace()?;
    let normal = collider.rotation() * plane.normal;
    let to = collider.translation() - Vector::new(x, y, 0.0);
    (normal.z > 0.1).then(|| normal.dot(to) / normal.z)
}
