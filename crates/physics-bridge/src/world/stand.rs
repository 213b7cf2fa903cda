//! Placing characters and props while the world runs, and reading where they are.

use glam::{DQuat, DVec3, Quat, Vec3};
use policy_core::Heading;
use policy_core::contract::{Fixture, MAX_DISTANCE_M, MAX_SPEED_MPS, Motion, Pose, Prop, ROOT_QPOS, within};

use super::World;
use super::forces::reference;
use super::handle::{CharacterHandle, FixtureHandle, JointHandle, PropHandle};
use super::recover::Standing;
use super::scene::JointRecord;
use super::solids::{quat, vec3, wxyz};
use crate::description::world_error::WorldError;
use crate::kinematics::velocity_at;

impl World {
    /// What a prop was made of.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn prop(&self, prop: PropHandle) -> Result<&Prop, WorldError> {
        Ok(&self.scene.props.at(self.scene.props.index_of(prop)?).prop)
    }

    /// Where a prop is and how it moves.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn motion(&self, prop: PropHandle) -> Result<Motion, WorldError> {
        let body = self.places.prop(self.scene.props.index_of(prop)?).body;
        let ((position, rotation), (spin, velocity)) = self.exact_motion(body);
        Ok(Motion {
            position: position.as_vec3(),
            rotation: rotation.as_quat(),
            velocity: velocity.as_vec3(),
            spin: spin.as_vec3(),
        })
    }

    /// What a fixture was made of.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn fixture(&self, fixture: FixtureHandle) -> Result<&Fixture, WorldError> {
        Ok(self.scene.fixtures.at(self.scene.fixtures.index_of(fixture)?))
    }

    /// The two ends of a rope, metres, world space; `None` for another joint.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn rope_ends(&self, joint: JointHandle) -> Result<Option<[Vec3; 2]>, WorldError> {
        let JointRecord::Rope(rope) = self.scene.joints.at(self.scene.joints.index_of(joint)?) else {
            return Ok(None);
        };
        let end = |prop: Option<usize>, point: DVec3| {
            let world = (DVec3::ZERO, DQuat::IDENTITY);
            let (at, turned) = prop.map_or(world, |prop| self.exact_motion(self.places.prop(prop).body).0);
            (at + turned * point).as_vec3()
        };
        Ok(Some([0, 1].map(|i| end(rope.props[i], rope.points[i]))))
    }

    /// Pose of a body's frame; its angular and linear velocity.
    pub(super) fn exact_motion(&self, body: usize) -> ((DVec3, DQuat), (DVec3, DVec3)) {
        let position = vec3(self.data.xpos()[body]);
        let velocity = velocity_at(self.data.cvel()[body], position - reference(&self.data, body));
        ((position, quat(self.data.xquat()[body])), velocity)
    }

    /// Puts a prop somewhere else. Contacts and forces on it end.
    ///
    /// # Errors
    /// When the handle is stale, the prop hangs on a joint, or a number is out of its range.
    pub fn place_prop(&mut self, prop: PropHandle, motion: Motion) -> Result<(), WorldError> {
        motion.check()?;
        let index = self.scene.props.index_of(prop)?;
        if self.scene.props.at(index).hold.is_some() {
            return Err(WorldError::Jointed);
        }
        self.forces.clear(self.places.prop(index).body);
        self.write_prop(index, &motion);
        self.finish_placing();
        Ok(())
    }

    /// Stands a character on the ground at a point, metres, world space, on the highest fixture there, facing along
    /// `heading`. All of it moves along `heading` at `speed_mps`.
    ///
    /// # Errors
    /// When the handle is stale, or a number is out of its range.
    pub fn stand_at(
        &mut self,
        character: CharacterHandle,
        x: f32,
        y: f32,
        heading: Heading,
        speed_mps: f32,
    ) -> Result<(), WorldError> {
        check_stand(x, y, heading, speed_mps)?;
        let index = self.scene.characters.index_of(character)?;
        self.stand(index, [x, y, MAX_DISTANCE_M], heading.angle(), speed_mps);
        self.finish_placing();
        Ok(())
    }

    /// Puts a character into any position and velocity, laid out as in [`Pose`]. Its motors hold the pose.
    ///
    /// # Errors
    /// When the handle is stale, there are more or fewer numbers than the character has, or a number is not finite.
    pub fn set_pose(
        &mut self,
        character: CharacterHandle,
        qpos: &[f64],
        qvel: &[f64],
    ) -> Result<(), WorldError> {
        let index = self.scene.characters.index_of(character)?;
        Pose::check(qpos, qvel, self.scene.characters.at(index).skeleton().joint_count())?;
        self.write_pose(index, qpos, qvel);
        self.finish_placing();
        Ok(())
    }

    /// Writes position and velocity of a character, in full precision. Allocates only when `out` was made for another
    /// skeleton.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn pose_into(&self, character: CharacterHandle, out: &mut Pose) -> Result<(), WorldError> {
        let index = self.scene.characters.index_of(character)?;
        let layout = &self.places.character(index).layout;
        let stand = self.scene.characters.at(index).stand();
        out.qpos.resize(stand.qpos.len(), 0.0);
        out.qvel.resize(stand.qvel.len(), 0.0);
        layout.our_qpos(self.data.qpos(), &mut out.qpos);
        layout.our_qvel(self.data.qvel(), &mut out.qvel);
        Ok(())
    }

    /// Computes what follows from something that was placed; the history ends.
    pub(super) fn finish_placing(&mut self) {
        self.refresh();
        self.is_touched = true;
        self.restart_history();
    }

    /// Writes the numbers of a free prop.
    pub(super) fn write_prop(&mut self, index: usize, motion: &Motion) {
        let rotation = motion.rotation.as_dquat().normalize();
        self.write_free(
            index,
            (motion.position.as_dvec3(), rotation),
            (motion.spin.as_dvec3(), motion.velocity.as_dvec3()),
        );
    }

    /// Writes the numbers of a free prop in full precision.
    pub(super) fn write_free(
        &mut self,
        index: usize,
        (position, rotation): (DVec3, DQuat),
        (spin, velocity): (DVec3, DVec3),
    ) {
        let span = &self.places.prop(index).span;
        let qpos = &mut self.data.qpos_mut()[span.qpos.clone()];
        qpos[..3].copy_from_slice(&position.to_array());
        qpos[3..].copy_from_slice(&wxyz(rotation));
        let own_spin = rotation.inverse() * spin; // MuJoCo's is in the frame of the body
        let qvel = &mut self.data.qvel_mut()[span.dofs.clone()];
        qvel[..3].copy_from_slice(&velocity.to_array());
        qvel[3..].copy_from_slice(&own_spin.to_array());
        self.data.qacc_warmstart_mut()[span.dofs.clone()].fill(0.0);
    }

    /// Stands a character on the highest ground below `z`. Does not allocate.
    pub(super) fn stand(&mut self, index: usize, [x, y, z]: [f32; 3], heading: f32, speed_mps: f32) {
        let ground = self.height_below(x, y, z);
        let model = self.scene.characters.at(index);
        let (stand, lift) = (model.stand(), model.stand_lift());
        let heading = Heading::from_angle(heading);
        let turn = Quat::from_rotation_z(heading.angle()).as_dquat();
        let [w, i, j, k] = [stand.qpos[3], stand.qpos[4], stand.qpos[5], stand.qpos[6]];
        let world_from_root = turn * DQuat::from_xyzw(i, j, k, w);
        let velocity = heading.direction() * speed_mps;
        let place = self.places.character(index);
        let (layout, span) = (&place.layout, &place.span);
        layout.write_qpos(&stand.qpos, self.data.qpos_mut());
        let root = &mut self.data.qpos_mut()[layout.root_qpos..][..ROOT_QPOS];
        root[..3].copy_from_slice(&[x.into(), y.into(), f64::from(ground) + lift]);
        root[3..].copy_from_slice(&wxyz(world_from_root));
        let qvel = &mut self.data.qvel_mut()[span.dofs.clone()];
        qvel.fill(0.0);
        qvel[..2].copy_from_slice(&[velocity.x.into(), velocity.y.into()]);
        self.hold_pose(index);
        self.standing[index] = Standing { place: [x, y, z], heading: heading.angle() };
    }

    fn write_pose(&mut self, index: usize, qpos: &[f64], qvel: &[f64]) {
        let layout = &self.places.character(index).layout;
        layout.write_qpos(qpos, self.data.qpos_mut());
        layout.write_qvel(qvel, self.data.qvel_mut());
        self.hold_pose(index);
    }

    /// Lets the motors of a character hold its pose; forces on it end.
    fn hold_pose(&mut self, index: usize) {
        let place = self.places.character(index);
        for joint in &place.layout.joints {
            let angle = self.data.qpos()[joint.qpos];
            self.data.ctrl_mut()[joint.ctrl] = angle;
        }
        self.data.qacc_warmstart_mut()[place.span.dofs.clone()].fill(0.0);
        for body in place.span.bodies.clone() {
            self.forces.clear(body);
        }
    }
}

/// Checks where a character is to stand.
pub(super) fn check_stand(x: f32, y: f32, heading: Heading, speed_mps: f32) -> Result<(), WorldError> {
    const WHAT: &str = "a character";
    within(WHAT, "x, y", Vec3::new(x, y, 0.0).length(), [0.0, MAX_DISTANCE_M])?;
    within(WHAT, "heading", heading.angle(), [-7.0, 7.0])?;
    within(WHAT, "speed_mps", speed_mps, [-MAX_SPEED_MPS, MAX_SPEED_MPS])?;
    Ok(())
}
