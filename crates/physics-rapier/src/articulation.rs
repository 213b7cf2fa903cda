//! One character inside any Rapier world: put in, sensed, driven, posed, taken out.
//!
//! An articulation owns its bodies, colliders and multibody joints in sets that belong to the game. It keeps handles
//! and targets, no physics.

mod drive;
mod insert;
pub(crate) mod pose;
mod sense;

use rapier3d::dynamics::{
    ImpulseJointSet, IslandManager, Multibody, MultibodyJointHandle, MultibodyJointSet, RigidBodyHandle,
    RigidBodySet, SoftBodySet,
};
use rapier3d::geometry::ColliderSet;
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;

use crate::model::Model;

pub use self::pose::PlaceError;

/// How the motors are driven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drive {
    /// MuJoCo's rule, as in training: before each physics step the torque `clamp(gain * (target - angle))` acts on
    /// the two bodies of a hinge. Wants the model's physics rate, 120 Hz for the humanoid.
    #[default]
    Torques,
    /// Rapier's joint motors, implicit and clamped. They stand the 60 Hz of a game's own step. Joints lag behind
    /// MuJoCo's by about 5 % in the first tick.
    Motors,
}

/// The sets of a Rapier world that hold a character.
///
/// ```
/// use rapier3d::prelude::*;
/// let mut world = PhysicsWorld::new();
/// let sets = physics_rapier::Sets::from(&mut world);
/// assert!(sets.bodies.is_empty());
/// ```
pub struct Sets<'a> {
    /// Rigid bodies.
    pub bodies: &'a mut RigidBodySet,
    /// Colliders.
    pub colliders: &'a mut ColliderSet,
    /// Impulse joints.
    pub impulse_joints: &'a mut ImpulseJointSet,
    /// Multibody joints.
    pub multibody_joints: &'a mut MultibodyJointSet,
    /// Islands.
    pub islands: &'a mut IslandManager,
    /// Soft bodies.
    pub soft_bodies: &'a mut SoftBodySet,
}

impl<'a> From<&'a mut PhysicsWorld> for Sets<'a> {
    fn from(world: &'a mut PhysicsWorld) -> Self {
        Self {
            bodies: &mut world.bodies,
            colliders: &mut world.colliders,
            impulse_joints: &mut world.impulse_joints,
            multibody_joints: &mut world.multibody_joints,
            islands: &mut world.islands,
            soft_bodies: &mut world.soft_bodies,
        }
    }
}

/// A body or joint of a character is no longer in the world.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected the {kind} \"{name}\" of the character in the world, found it removed")]
#[non_exhaustive]
pub struct Removed {
    /// `body` or `hinge`.
    pub kind: &'static str,
    /// Its name.
    pub name: String,
}

/// One character in a world of the game. Each control tick calls [`Articulation::sense_into`] and
/// [`Articulation::actuate`]; each physics step calls [`Articulation::before_step`] first.
///
/// The articulation owns the forces and torques that act on its bodies: [`Articulation::before_step`] replaces them. A
/// game that pushes a body calls `add_force` on it after that, for each step. Impulses have no effect on the links of
/// a multibody in Rapier.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_rapier::{Articulation, Drive, Model, Sets};
/// use policy_core::{CharacterState, Heading, JointTargets};
/// use rapier3d::prelude::*;
///
/// // The game's world. Z is up.
/// let mut world = PhysicsWorld { gravity: Vector::new(0.0, 0.0, -9.81), ..PhysicsWorld::new() };
/// world.integration_parameters.dt = 1.0 / 120.0;
/// Drive::Torques.tune(&mut world.integration_parameters);
/// world.colliders.insert(ColliderBuilder::cuboid(50.0, 50.0, 0.5).translation(Vector::new(0.0, 0.0, -0.5)));
///
/// let model = Model::from_mjcf(HUMANOID)?;
/// let mut character =
///     Articulation::insert(&model, &mut Sets::from(&mut world), Drive::Torques, InteractionGroups::all());
/// character.stand_at(&mut Sets::from(&mut world), [2.0, 0.0, 0.0], Heading::FORWARD, 0.0)?;
///
/// let mut state = CharacterState::new(model.skeleton());
/// let targets = JointTargets::new(model.skeleton());
/// for _ in 0..3 {
///     character.sense_into(&world.bodies, &world.multibody_joints, 0.0, &mut state)?;
///     // a controller makes targets of the state here
///     character.actuate(&targets);
///     for _ in 0..model.substeps() {
///         character.before_step(&mut world.bodies, &mut world.multibody_joints)?;
///         world.step();
///     }
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Articulation {
    model: Model,
    drive: Drive,
    /// Rigid body of each body of the skeleton.
    bodies: Vec<RigidBodyHandle>,
    /// Every rigid body, the massless ones between hinges of one body included.
    links: Vec<RigidBodyHandle>,
    /// Any joint, to find the multibody.
    joint: MultibodyJointHandle,
    hinges: Vec<Hinge>,
    /// Hinges from a body's parent to the body, for each body, in the order of the chain.
    chains: Vec<Vec<usize>>,
    /// Radians.
    targets: Vec<f32>,
    /// Torque on each of `links`, newton metres, world axes.
    torques: Vec<Vector>,
}

/// Where a hinge is in the multibody.
#[derive(Clone, Debug)]
struct Hinge {
    /// Index in the multibody's links.
    link: usize,
    /// Index in its generalised velocities.
    dof: usize,
    /// Index in `Articulation::links` of the two bodies.
    child: usize,
    parent: usize,
    /// Axis and anchor in the child's frame.
    axis: Vector,
    anchor: Vector,
}

impl Articulation {
    /// The model it was made of.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// How its motors are driven.
    #[must_use]
    pub fn drive(&self) -> Drive {
        self.drive
    }

    /// Rigid body of each body of the skeleton, in its order.
    #[must_use]
    pub fn bodies(&self) -> &[RigidBodyHandle] {
        &self.bodies
    }

    /// Joint angles that the motors pull towards, radians, in the order of the skeleton.
    #[must_use]
    pub fn targets(&self) -> &[f32] {
        &self.targets
    }

    /// Takes the character out of the world.
    pub fn remove(self, world: &mut Sets<'_>) {
        for &body in &self.links {
            world.bodies.remove(
                body,
                world.islands,
                world.colliders,
                world.impulse_joints,
                world.multibody_joints,
                world.soft_bodies,
                true,
            );
        }
    }

    fn multibody<'a>(&self, joints: &'a MultibodyJointSet) -> Result<&'a Multibody, Removed> {
        let multibody = joints.get(self.joint).map(|(multibody, _)| multibody);
        multibody.filter(|m| self.is_whole(m)).ok_or_else(|| self.removed_hinge(joints))
    }

    /// True when every hinge is where it was: Rapier splits and renumbers a multibody that loses a link.
    fn is_whole(&self, multibody: &Multibody) -> bool {
        multibody.ndofs() >= 6 + self.hinges.len()
            && self.hinges.iter().all(|hinge| {
                let link = multibody.link(hinge.link);
                link.is_some_and(|l| {
                    l.rigid_body_handle() == self.links[hinge.child] && l.assembly_id() == hinge.dof
                })
            })
    }

    fn removed_hinge(&self, joints: &MultibodyJointSet) -> Removed {
        let there = |hinge: &Hinge| joints.rigid_body_link(self.links[hinge.child]).is_some();
        let lost = self.hinges.iter().position(|hinge| !there(hinge)).unwrap_or(0);
        Removed { kind: "hinge", name: self.model.skeleton().joints()[lost].name.clone() }
    }

    fn removed_body(&self, handle: RigidBodyHandle) -> Removed {
        let body = self.bodies.iter().position(|&body| body == handle).unwrap_or(0);
        Removed { kind: "body", name: self.model.skeleton().bodies()[body].name.clone() }
    }
}
