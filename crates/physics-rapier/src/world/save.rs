//! A world's state as a value, and as bits to compare.

use policy_core::contract::{DescriptionError, PoseError, PushError};
use policy_core::glam::Vec3;
use rapier3d::dynamics::JointAxis;

use rapier3d::dynamics::RigidBodyHandle;

use super::{PropBody, Resident, Standing, World};
use crate::model::Model;
use crate::saved::SavedSets;

/// Why a world can't be changed. It is unchanged then.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// There is no such character.
    #[error("expected the index of one of {found} {what}s, found {index}")]
    Missing {
        /// `character` or `prop`.
        what: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        found: usize,
    },
    /// The world is full.
    #[error("expected at most {most} {what}, found one more")]
    Full {
        /// `characters`, `props`, `fixtures` or `joints`.
        what: &'static str,
        /// Most of them.
        most: usize,
    },
    /// A prop, fixture or joint that can't be as described.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// Corners or triangles that make no body.
    #[error("expected corners that enclose a body, found some that do not")]
    Hull,
    /// A joint of a prop with itself.
    #[error("expected two props to join, found one twice")]
    Loop,
    /// A force on a prop that is no number.
    #[error("expected a finite force, found {found}")]
    Force {
        /// The force.
        found: Vec3,
    },
    /// A place that no character can take.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A push out of its bounds.
    #[error(transparent)]
    Push(PushError),
    /// The snapshot is of another world.
    #[error("expected a snapshot of a world of the same model, found another")]
    Snapshot,
}

/// The whole state of a [`World`] at the end of a tick: contacts, targets and pushes included.
#[derive(Clone)]
pub struct WorldSnapshot {
    model: Model,
    sets: SavedSets,
    residents: Vec<Resident>,
    props: Vec<PropBody>,
    fixtures: Vec<Standing>,
    pillar: Option<RigidBodyHandle>,
    joints: usize,
    tick: u64,
}

impl World {
    /// The state now. Allocates.
    #[must_use]
    pub fn save(&self) -> WorldSnapshot {
        WorldSnapshot {
            model: self.model.clone(),
            sets: SavedSets::of(&self.world),
            residents: self.residents.clone(),
            props: self.props.clone(),
            fixtures: self.fixtures.clone(),
            pillar: self.pillar,
            joints: self.joints,
            tick: self.tick,
        }
    }

    /// Returns to a state. The run continues bit for bit as it did from there. Allocates.
    ///
    /// # Errors
    /// When the snapshot is of a world of another model; this one is then unchanged.
    pub fn restore(&mut self, snapshot: &WorldSnapshot) -> Result<(), WorldError> {
        if !snapshot.model.is(&self.model) {
            return Err(WorldError::Snapshot);
        }
        let WorldSnapshot { model: _, sets, residents, props, fixtures, pillar, joints, tick } =
            snapshot.clone();
        sets.restore(&mut self.world);
        (self.residents, self.props, self.tick) = (residents, props, tick);
        (self.fixtures, self.pillar, self.joints) = (fixtures, pillar, joints);
        Ok(())
    }

    /// Gives the bits of positions, rotations, velocities, joint angles, targets and pushes to `out`, in a fixed order:
    /// what a hash of the state is made of. Equal worlds give equal bits. Allocates nothing.
    pub fn state_bits(&self, mut out: impl FnMut(u32)) {
        out(self.tick as u32);
        for (_, body) in self.world.bodies.iter() {
            let pose = body.position();
            let place = pose.translation.to_array().into_iter().chain(pose.rotation.to_array());
            let motion = body.linvel().to_array().into_iter().chain(body.angvel().to_array());
            place.chain(motion).for_each(|value| out(value.to_bits()));
        }
        for multibody in self.world.multibody_joints.multibodies() {
            multibody.generalized_velocity().iter().for_each(|value| out(value.to_bits()));
            for link in multibody.links() {
                out(link.joint.coords()[JointAxis::AngX as usize].to_bits());
            }
        }
        for Resident { articulation, pushes } in &self.residents {
            articulation.targets().iter().for_each(|target| out(target.to_bits()));
            pushes.bits(&mut out);
        }
    }
}

impl std::fmt::Debug for WorldSnapshot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WorldSnapshot").field("tick", &self.tick).finish_non_exhaustive()
    }
}
