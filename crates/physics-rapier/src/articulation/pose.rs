//! A character's pose in MuJoCo's terms: set, read, stood on the ground.

use policy_core::contract::{Pose, PoseError, ROOT_QPOS, ROOT_QVEL};
use policy_core::{BodyId, Heading};
use rapier3d::dynamics::{JointAxis, MultibodyJointSet, RigidBodySet};
use rapier3d::geometry::ColliderSet;
use rapier3d::math::{Pose as RapierPose, Rotation, Vector};

use super::{Articulation, Removed, Sets};

/// How far the square of a rotation's length may be from 1 before it is made a unit quaternion again.
///
/// Rounding alone stays below it for about a minute, so short runs keep their bits.
const MOST_DRIFT: f32 = 1e-5;

/// A rotation of length 1, or the same bits when its length is near enough.
pub(super) fn unit(rotation: Rotation) -> Rotation {
    let drift = (rotation.length_squared() - 1.0).abs();
    if drift > MOST_DRIFT { rotation.normalize() } else { rotation }
}

/// Checks a pose as [`Pose::check`], and that single precision can hold its numbers.
pub(crate) fn check_pose(qpos: &[f64], qvel: &[f64], joints: usize) -> Result<(), PoseError> {
    Pose::check(qpos, qvel, joints)?;
    for (field, numbers) in [("qpos", qpos), ("qvel", qvel)] {
        if let Some(index) = numbers.iter().position(|&number| !(number as f32).is_finite()) {
            return Err(PoseError::NotFinite { field, index, found: numbers[index] });
        }
    }
    Ok(())
}

/// Why a character can't be posed in a world.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaceError {
    /// The numbers are no pose.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A part of the character is gone.
    #[error(transparent)]
    Removed(#[from] Removed),
}

impl Articulation {
    /// Puts the character into any position and velocity, laid out as in [`Pose`]. The motors hold the pose until
    /// [`Articulation::actuate`] is called.
    ///
    /// # Errors
    /// When there are more or fewer numbers than the character has, a number is not finite in single precision, the
    /// quaternion is no rotation, or the game removed a part of the character; it is then unchanged.
    pub fn set_pose(&mut self, world: &mut Sets<'_>, qpos: &[f64], qvel: &[f64]) -> Result<(), PlaceError> {
        check_pose(qpos, qvel, self.hinges.len())?;
        self.multibody(world.multibody_joints)?;
        let rotation =
            Rotation::from_xyzw(qpos[4] as f32, qpos[5] as f32, qpos[6] as f32, qpos[3] as f32).normalize();
        let offset = rotation * self.model.root_offset();
        let place = vector(&qpos[..3]) + offset;
        let root = self.bodies[0];
        let body = world.bodies.get_mut(root).ok_or_else(|| self.removed_body(root))?;
        body.set_position(RapierPose::from_parts(place, rotation), true);

        let (multibody, _) = world.multibody_joints.get_mut(self.joint).expect("looked up above");
        let angular = rotation * vector(&qvel[3..6]);
        let linear = vector(&qvel[..3]) + angular.cross(offset);
        let mut velocity = multibody.generalized_velocity_mut();
        velocity.rows_mut(0, 3).copy_from_slice(&linear.to_array());
        velocity.rows_mut(3, 3).copy_from_slice(&angular.to_array());
        for (hinge, &speed) in self.hinges.iter().zip(&qvel[ROOT_QVEL..]) {
            velocity[hinge.dof] = speed as f32;
        }
        for ((hinge, target), &angle) in self.hinges.iter().zip(&mut self.targets).zip(&qpos[ROOT_QPOS..]) {
            let link = multibody.link_mut(hinge.link).expect("looked up above");
            let displacement = angle as f32 - link.joint.coords()[JointAxis::AngX as usize];
            link.joint.apply_displacement(&[displacement]);
            *target = angle as f32;
        }
        multibody.forward_kinematics(world.bodies, true);
        multibody.update_rigid_bodies(world.bodies, true);
        self.before_step(world.bodies, world.multibody_joints)?;
        Ok(())
    }

    /// Stands the character at a point of the ground, metres, world space, facing along `heading`, its lowest point
    /// touching the point's height. All of it moves along `heading` at `speed_mps`: 0 for a policy that stands,
    /// [`WALKING_START_MPS`](crate::WALKING_START_MPS) for one that only walks. Allocates two short lists.
    ///
    /// # Errors
    /// When a number is not finite, or the game removed a part of the character; it is then unchanged.
    pub fn stand_at(
        &mut self,
        world: &mut Sets<'_>,
        point: [f32; 3],
        heading: Heading,
        speed_mps: f32,
    ) -> Result<(), PlaceError> {
        let Pose { mut qpos, mut qvel } = self.model.stand().clone();
        let [w, i, j, k] = [qpos[3], qpos[4], qpos[5], qpos[6]];
        let half = f64::from(heading.angle()) / 2.0;
        let (sin, cos) = (half.sin(), half.cos());
        // The turn about z times the rotation of the standing pose.
        qpos[3..7].copy_from_slice(&[
            cos * w - sin * k,
            cos * i - sin * j,
            cos * j + sin * i,
            cos * k + sin * w,
        ]);
        (qpos[0], qpos[1]) = (point[0].into(), point[1].into());
        let velocity = heading.direction() * speed_mps;
        (qvel[0], qvel[1]) = (velocity.x.into(), velocity.y.into());
        Pose::check(&[&[f64::from(point[2])], &qpos[1..]].concat(), &qvel, self.hinges.len())?;
        self.set_pose(world, &qpos, &qvel)?;
        qpos[2] += f64::from(point[2]) - f64::from(self.lowest_point(world));
        self.set_pose(world, &qpos, &qvel)
    }

    /// Writes position and velocity. Allocates only when `out` was made for another skeleton.
    ///
    /// # Errors
    /// When the game removed a part of the character.
    pub fn pose_into(
        &self,
        bodies: &RigidBodySet,
        joints: &MultibodyJointSet,
        out: &mut Pose,
    ) -> Result<(), Removed> {
        let multibody = self.multibody(joints)?;
        let handle = self.bodies[0];
        let body = bodies.get(handle).ok_or_else(|| self.removed_body(handle))?;
        let root = self.root_state(multibody, body.position());
        let (p, q, v) = (root.position, root.rotation, root.linear_velocity);
        let w = q.inverse() * root.angular_velocity;
        out.qpos.clear();
        out.qpos.extend([p.x, p.y, p.z, q.w, q.x, q.y, q.z].map(f64::from));
        out.qvel.clear();
        out.qvel.extend([v.x, v.y, v.z, w.x, w.y, w.z].map(f64::from));
        for hinge in &self.hinges {
            let angle =
                multibody.link(hinge.link).expect("looked up above").joint.coords()[JointAxis::AngX as usize];
            out.qpos.push(angle.into());
            out.qvel.push(multibody.generalized_velocity()[hinge.dof].into());
        }
        Ok(())
    }

    /// Height of the lowest point of the character, metres.
    fn lowest_point(&self, world: &Sets<'_>) -> f32 {
        let of = |body| self.lowest_point_of(world.bodies, world.colliders, BodyId::new(body));
        (0..self.bodies.len()).map(of).fold(f32::INFINITY, f32::min)
    }

    /// Height of the lowest point of the boxes around a body's colliders, metres; infinite without one.
    pub(crate) fn lowest_point_of(
        &self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        body: BodyId,
    ) -> f32 {
        let Some(body) = self.bodies.get(body.index()).and_then(|&body| bodies.get(body)) else {
            return f32::INFINITY;
        };
        let own = body.colliders().iter().filter_map(|&collider| colliders.get(collider));
        let lowest = own.map(|collider| {
            let within = collider.position_wrt_parent().copied().unwrap_or_default();
            collider.shape().compute_aabb(&(*body.position() * within)).mins.z
        });
        lowest.fold(f32::INFINITY, f32::min)
    }
}

fn vector(numbers: &[f64]) -> Vector {
    Vector::new(numbers[0] as f32, numbers[1] as f32, numbers[2] as f32)
}
