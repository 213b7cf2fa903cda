//! What a policy senses of a character in a world.

use policy_core::{BodyState, CharacterState};
use rapier3d::dynamics::{Multibody, MultibodyJointSet, RigidBodySet};
use rapier3d::math::Vector;

use super::pose::unit;
use super::{Articulation, Removed};

impl Articulation {
    /// Writes what a policy senses: motion of the body frames in world axes, and joint velocities. `ground_height` is
    /// that of the ground below the root, metres; the game casts a ray or knows its terrain. Where the ground is uneven,
    /// [`CharacterState::sense_ground`] afterwards says what rises ahead of the legs. Allocates only when `out` was made
    /// for another skeleton.
    ///
    /// Rapier's own body velocities are those at the start of its last substep, so they are computed here from the
    /// generalised ones.
    ///
    /// # Errors
    /// When the game removed a body or joint of the character; `out` is then partly written.
    pub fn sense_into(
        &self,
        bodies: &RigidBodySet,
        joints: &MultibodyJointSet,
        ground_height: f32,
        out: &mut CharacterState,
    ) -> Result<(), Removed> {
        let skeleton = self.model.skeleton();
        if !out.fits(skeleton) {
            *out = CharacterState::new(skeleton);
        }
        let multibody = self.multibody(joints)?;
        for (index, &handle) in self.bodies.iter().enumerate() {
            let body = bodies.get(handle).ok_or_else(|| self.removed_body(handle))?;
            out.bodies[index] = match skeleton.bodies()[index].parent {
                None => self.root_state(multibody, body.position()),
                Some(parent) => {
                    let parent = out.bodies[parent.index()];
                    let [mut place, mut linear, mut angular] =
                        [parent.position, parent.linear_velocity, parent.angular_velocity];
                    for &hinge in &self.chains[index] {
                        let hinge = &self.hinges[hinge];
                        let child = self.links[hinge.child];
                        let child = bodies.get(child).ok_or_else(|| self.removed_body(child))?.position();
                        let anchor = *child * hinge.anchor;
                        linear += angular.cross(anchor - place);
                        place = anchor;
                        angular += child.rotation * hinge.axis * multibody.generalized_velocity()[hinge.dof];
                    }
                    let own = body.position();
                    linear += angular.cross(own.translation - place);
                    BodyState {
                        position: own.translation,
                        rotation: own.rotation,
                        linear_velocity: linear,
                        angular_velocity: angular,
                    }
                }
            };
        }
        for (out, hinge) in out.joint_velocities.iter_mut().zip(&self.hinges) {
            *out = multibody.generalized_velocity()[hinge.dof];
        }
        out.sense_level_ground(ground_height);
        Ok(())
    }

    /// Motion of the root in the MJCF's frame. Rapier's is at the centre of mass.
    pub(super) fn root_state(&self, multibody: &Multibody, pose: &rapier3d::math::Pose) -> BodyState {
        let velocity = multibody.generalized_velocity();
        let rotation = unit(pose.rotation);
        let offset = rotation * self.model.root_offset();
        let angular = Vector::new(velocity[3], velocity[4], velocity[5]);
        let linear = Vector::new(velocity[0], velocity[1], velocity[2]) - angular.cross(offset);
        BodyState {
            position: pose.translation - offset,
            rotation,
            linear_velocity: linear,
            angular_velocity: angular,
        }
    }
}
