//! The sets of a Rapier world as a value.
//!
//! Gravity and parameters stay with the world. Rapier's pipelines hold scratch memory only, and begin anew.

use rapier3d::dynamics::{
    CCDSolver, ImpulseJointSet, IslandManager, MultibodyJointSet, RigidBodySet, SoftBodySet,
};
use rapier3d::geometry::{BroadPhaseBvh, ColliderSet, NarrowPhase};
use rapier3d::pipeline::PhysicsWorld;

/// All that Rapier's next step depends on, contacts and their impulses included.
#[derive(Clone)]
pub(crate) struct SavedSets {
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    soft_bodies: SoftBodySet,
    ccd_solver: CCDSolver,
}

impl SavedSets {
    /// The sets of a world now. Allocates.
    pub(crate) fn of(world: &PhysicsWorld) -> Self {
        Self {
            bodies: world.bodies.clone(),
            colliders: world.colliders.clone(),
            impulse_joints: world.impulse_joints.clone(),
            multibody_joints: world.multibody_joints.clone(),
            islands: world.islands.clone(),
            broad_phase: world.broad_phase.clone(),
            narrow_phase: world.narrow_phase.clone(),
            soft_bodies: world.soft_bodies.clone(),
            ccd_solver: world.ccd_solver.clone(),
        }
    }

    /// Puts them into a world of the same gravity and parameters.
    pub(crate) fn restore(self, world: &mut PhysicsWorld) {
        *world = PhysicsWorld {
            gravity: world.gravity,
            integration_parameters: world.integration_parameters,
            bodies: self.bodies,
            colliders: self.colliders,
            impulse_joints: self.impulse_joints,
            multibody_joints: self.multibody_joints,
            islands: self.islands,
            broad_phase: self.broad_phase,
            narrow_phase: self.narrow_phase,
            soft_bodies: self.soft_bodies,
            ccd_solver: self.ccd_solver,
            ..PhysicsWorld::new()
        };
    }
}
