//! What can be read of a character without changing it.

use glam::{DMat3, DVec3, Quat, Vec3};
use policy_core::{Body, CharacterState};

use crate::character::Character;
use crate::contact::Contact;
use crate::pose::{BodyPoses, Pose};

impl Character {
    /// Writes what a policy senses: motion of the body frames in world axes, joint velocities, and the
    /// height of the ground below the pelvis.
    pub fn sense_into(&self, out: &mut CharacterState) {
        let layout = self.model.layout();
        let (xpos, xquat, cvel) = (self.data.xpos(), self.data.xquat(), self.data.cvel());
        let reference = self.velocity_reference();
        for (body, &id) in out.bodies.iter_mut().zip(&layout.body_ids) {
            let position = DVec3::from(xpos[id]);
            let (angular, linear) = velocity_at(cvel[id], position - reference);
            body.position = position.as_vec3();
            body.rotation = rotation(xquat[id]);
            body.linear_velocity = linear.as_vec3();
            body.angular_velocity = angular.as_vec3();
        }
        let qvel = self.data.qvel();
        for (velocity, &dof) in out.joint_velocities.iter_mut().zip(&layout.joint_dof) {
            *velocity = qvel[dof] as f32;
        }
        let pelvis = out.body(Body::Pelvis).position;
        out.ground_height = self.model.height_at(pelvis.x, pelvis.y);
    }

    /// Writes where the bodies are.
    pub fn poses_into(&self, out: &mut BodyPoses) {
        let (xpos, xquat) = (self.data.xpos(), self.data.xquat());
        for (index, &id) in self.model.layout().body_ids.iter().enumerate() {
            out.positions[index] = DVec3::from(xpos[id]).as_vec3();
            out.rotations[index] = rotation(xquat[id]);
        }
    }

    /// Position and velocity now, in full precision.
    #[must_use]
    pub fn pose(&self) -> Pose {
        let layout = self.model.layout();
        Pose { qpos: layout.our_qpos(self.data.qpos()), qvel: layout.our_qvel(self.data.qvel()) }
    }

    /// Centre of mass of the whole character, metres, world space.
    #[must_use]
    pub fn centre_of_mass(&self) -> Vec3 {
        self.velocity_reference().as_vec3()
    }

    /// Velocity of the centre of mass, metres per second, world space.
    #[must_use]
    pub fn centre_of_mass_velocity(&self) -> Vec3 {
        let (masses, xipos, cvel) = (self.data.model().body_mass(), self.data.xipos(), self.data.cvel());
        let reference = self.velocity_reference();
        let (mut momentum, mut mass) = (DVec3::ZERO, 0.0);
        for &id in &self.model.layout().body_ids {
            momentum += masses[id] * velocity_at(cvel[id], DVec3::from(xipos[id]) - reference).1;
            mass += masses[id];
        }
        (momentum / mass).as_vec3()
    }

    /// Speed of a body's frame, metres per second, world space.
    #[must_use]
    pub fn speed_of(&self, body: Body) -> f32 {
        let id = self.model.layout().body_ids[body.index()];
        let offset = DVec3::from(self.data.xpos()[id]) - self.velocity_reference();
        velocity_at(self.data.cvel()[id], offset).1.length() as f32
    }

    /// Where the character touched during the last substep, at most 64 points. Empty until the first step
    /// after it was posed or restored.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Height of the lowest point of the character above the ground below that point, metres; negative when
    /// it is in the ground. Exact on flat ground, close on a terrain.
    #[must_use]
    pub fn clearance(&self) -> f32 {
        self.clearance_where(|_| true)
    }

    /// The same of the lowest point of one body.
    #[must_use]
    pub fn clearance_of(&self, body: Body) -> f32 {
        self.clearance_where(|other| other == body)
    }

    fn clearance_where(&self, counts: impl Fn(Body) -> bool) -> f32 {
        let (centres, matrices) = (self.data.geom_xpos(), self.data.geom_xmat());
        let mut clearance = f64::INFINITY;
        let shapes = self.model.shapes().iter().zip(self.model.shape_geoms());
        for (shape, &geom) in shapes.filter(|(shape, _)| counts(shape.body)) {
            // MuJoCo's matrices are row by row, glam's column by column.
            let world_from_shape = DMat3::from_cols_array(&matrices[geom]).transpose();
            shape.kind.low_points(DVec3::from(centres[geom]), world_from_shape, |point, below| {
                let ground = self.model.height_at(point.x as f32, point.y as f32);
                clearance = clearance.min(point.z - below - f64::from(ground));
            });
        }
        clearance as f32
    }

    /// The point that MuJoCo's body velocities are of: it moves with the body, and is now where the centre
    /// of mass of the whole character is.
    pub(crate) fn velocity_reference(&self) -> DVec3 {
        DVec3::from(self.data.subtree_com()[self.model.layout().body_ids[Body::Pelvis.index()]])
    }
}

/// Angular velocity, and linear velocity `offset` away from the reference point.
pub(crate) fn velocity_at([wx, wy, wz, vx, vy, vz]: [f64; 6], offset: DVec3) -> (DVec3, DVec3) {
    let angular = DVec3::new(wx, wy, wz);
    (angular, DVec3::new(vx, vy, vz) + angular.cross(offset))
}

/// MuJoCo's wxyz quaternion in single precision.
pub(crate) fn rotation([w, x, y, z]: [f64; 4]) -> Quat {
    Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32)
}
