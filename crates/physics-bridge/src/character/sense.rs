//! What can be read of a character without changing it.

use glam::{DMat3, DVec3, Vec3};
use policy_core::contract::Pose;
use policy_core::{BodyId, CharacterState};

use super::{Character, Contact};
use crate::description::body_poses::BodyPoses;
use crate::kinematics::{poses_into, sense_into, velocity_at, velocity_reference};

impl Character {
    /// Writes what a policy senses: motion of the body frames in world axes, joint velocities, and the
    /// ground below the root and ahead of the legs. Allocates only when `out` was made for another skeleton.
    pub fn sense_into(&self, out: &mut CharacterState) {
        if !out.fits(self.model.skeleton()) {
            *out = CharacterState::new(self.model.skeleton());
        }
        sense_into(&self.data, self.model.layout(), out);
        out.sense_ground(self.model.skeleton(), |at| self.model.height_at(at.x, at.y));
    }

    /// Writes where the bodies are. Allocates only when `out` was made for another skeleton.
    pub fn poses_into(&self, out: &mut BodyPoses) {
        poses_into(&self.data, self.model.layout(), out);
    }

    /// Position and velocity now, in full precision. Allocates; see [`Character::pose_into`].
    #[must_use]
    pub fn pose(&self) -> Pose {
        let mut pose = Pose::new(self.model.skeleton());
        self.pose_into(&mut pose);
        pose
    }

    /// Writes position and velocity, in full precision. Allocates only when `out` was made for another
    /// skeleton.
    pub fn pose_into(&self, out: &mut Pose) {
        let (layout, stand) = (self.model.layout(), self.model.stand());
        out.qpos.resize(stand.qpos.len(), 0.0);
        out.qvel.resize(stand.qvel.len(), 0.0);
        layout.our_qpos(self.data.qpos(), &mut out.qpos);
        layout.our_qvel(self.data.qvel(), &mut out.qvel);
    }

    /// Centre of mass of the whole character, metres, world space.
    #[must_use]
    pub fn centre_of_mass(&self) -> Vec3 {
        velocity_reference(&self.data, self.model.layout()).as_vec3()
    }

    /// Velocity of the centre of mass, metres per second, world space.
    #[must_use]
    pub fn centre_of_mass_velocity(&self) -> Vec3 {
        let (masses, xipos, cvel) = (self.data.model().body_mass(), self.data.xipos(), self.data.cvel());
        let reference = velocity_reference(&self.data, self.model.layout());
        let (mut momentum, mut mass) = (DVec3::ZERO, 0.0);
        for &id in &self.model.layout().body_ids {
            momentum += masses[id] * velocity_at(cvel[id], DVec3::from(xipos[id]) - reference).1;
            mass += masses[id];
        }
        (momentum / mass).as_vec3()
    }

    /// Speed of a body's frame, metres per second, world space.
    ///
    /// # Panics
    /// When there is no such body.
    #[must_use]
    pub fn speed_of(&self, body: BodyId) -> f32 {
        let id = self.model.layout().body_ids[body.index()];
        let offset = DVec3::from(self.data.xpos()[id]) - velocity_reference(&self.data, self.model.layout());
        velocity_at(self.data.cvel()[id], offset).1.length() as f32
    }

    /// Where the character touched during the last substep, at most 64 points or four for each body. Empty
    /// until the first step after it was posed or restored.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Height of the lowest point of the character above the ground below that point, metres; negative when
    /// it is in the ground. Exact on flat ground for spheres, capsules, boxes and meshes, close on a terrain. Of other geoms the
    /// boxes around them count.
    #[must_use]
    pub fn clearance(&self) -> f32 {
        self.clearance_where(|_| true)
    }

    /// The same of the lowest point of one body.
    #[must_use]
    pub fn clearance_of(&self, body: BodyId) -> f32 {
        self.clearance_where(|other| other == body)
    }

    fn clearance_where(&self, counts: impl Fn(BodyId) -> bool) -> f32 {
        let (centres, matrices) = (self.data.geom_xpos(), self.data.geom_xmat());
        let mut clearance = f64::INFINITY;
        // MuJoCo's matrices are row by row, glam's column by column.
        let place =
            |geom: usize| (DVec3::from(centres[geom]), DMat3::from_cols_array(&matrices[geom]).transpose());
        let mut touch = |point: DVec3, below: f64| {
            let ground = self.model.height_at(point.x as f32, point.y as f32);
            clearance = clearance.min(point.z - below - f64::from(ground));
        };
        for bounds in self.model.bounds().iter().filter(|bounds| counts(bounds.body)) {
            let (centre, world_from_geom) = place(bounds.geom);
            bounds.low_points(centre, world_from_geom, &mut touch);
        }
        let shapes = self.model.shapes().iter().zip(self.model.shape_geoms());
        for (shape, &geom) in shapes.filter(|(shape, _)| counts(shape.body)) {
            let (centre, world_from_shape) = place(geom);
            shape.kind.low_points(centre, world_from_shape, &mut touch);
        }
        clearance as f32
    }
}
