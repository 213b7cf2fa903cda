//! What the physics tells of a character, from the caller's arrays.

use policy_core::glam::{Quat, Vec3};
use policy_core::{BodyState, CharacterState, Skeleton};

use crate::border::input;
use crate::error::{PsStatus, fail};

/// How far from 1 the length of a quaternion may be.
const LENGTH_TOLERANCE: f32 = 0.01;

/// Motion of one body: of its frame as in the MJCF, not of its centre of mass. World space, all at one moment.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PsBody {
    /// Origin of the frame, metres.
    pub position: [f32; 3],
    /// Turns body space to world space: x, y, z, w, of length 1. MuJoCo has w first.
    pub rotation: [f32; 4],
    /// Velocity of the frame's origin, metres per second.
    pub linear_velocity: [f32; 3],
    /// Radians per second about the world's axes.
    pub angular_velocity: [f32; 3],
}

/// What the physics tells of a character.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PsSensed {
    /// One entry for each body of the pack, in its order.
    pub bodies: *const PsBody,
    /// Entries of `bodies`: exactly PsPackInfo.body_count.
    pub body_count: usize,
    /// Angular velocity of each hinge of the pack, in its order, radians per second.
    pub joint_velocities: *const f32,
    /// Entries of `joint_velocities`: exactly PsPackInfo.joint_count.
    pub joint_count: usize,
    /// Height of the ground below the root, metres.
    pub ground_height: f32,
    /// For each body, height of the ground where it comes to, metres: see ps_pack_ground_lookahead_secs. Those of other bodies are
    /// not read. NULL for level ground. As many entries as `bodies`.
    pub ground_heights: *const f32,
}

impl PsSensed {
    /// Copies the arrays into a state of the skeleton. Does not allocate.
    ///
    /// # Safety
    /// Both pointers are as the contract of every function says.
    pub(crate) unsafe fn copy_into(
        &self,
        skeleton: &Skeleton,
        out: &mut CharacterState,
    ) -> Result<(), PsStatus> {
        // SAFETY: the caller's promise is passed on.
        let bodies = unsafe { input("bodies", self.bodies, self.body_count, skeleton.body_count()) }?;
        let joints = skeleton.joint_count();
        // SAFETY: the caller's promise is passed on.
        let velocities =
            unsafe { input("joint velocities", self.joint_velocities, self.joint_count, joints) }?;
        for (to, from) in out.bodies.iter_mut().zip(bodies) {
            *to = BodyState {
                position: Vec3::from_array(from.position),
                rotation: Quat::from_array(from.rotation),
                linear_velocity: Vec3::from_array(from.linear_velocity),
                angular_velocity: Vec3::from_array(from.angular_velocity),
            };
        }
        out.joint_velocities.copy_from_slice(velocities);
        if self.ground_heights.is_null() {
            out.sense_level_ground(self.ground_height);
            return Ok(());
        }
        // SAFETY: the caller's promise is passed on.
        let heights =
            unsafe { input("heights of the ground", self.ground_heights, self.body_count, bodies.len()) }?;
        let mut bad = None;
        out.set_ground(skeleton, self.ground_height, |body, _| {
            let height = heights[body.index()];
            bad = bad.or((!height.is_finite()).then_some(body));
            height
        });
        // The check names it.
        if let Some(body) = bad {
            out.ground_rises[body.index()] = f32::NAN;
        }
        Ok(())
    }
}

/// Refuses numbers that no character has, and names the body or joint.
pub(crate) fn check(skeleton: &Skeleton, state: &CharacterState) -> Result<(), PsStatus> {
    if !state.ground_height.is_finite() {
        let found = state.ground_height;
        let text = format_args!("expected a finite ground_height, found {found}");
        return Err(fail(PsStatus::BadNumber, text));
    }
    for ((body, rise), entry) in state.bodies.iter().zip(&state.ground_rises).zip(skeleton.bodies()) {
        let name = &entry.name;
        let vectors = [
            ("position", body.position),
            ("linear_velocity", body.linear_velocity),
            ("angular_velocity", body.angular_velocity),
        ];
        if let Some((field, found)) = vectors.iter().find(|(_, v)| !v.is_finite()) {
            let text = format_args!("expected a finite {field} of body {name:?}, found {found}");
            return Err(fail(PsStatus::BadNumber, text));
        }
        if !rise.is_finite() {
            let text = format_args!("expected a finite entry of ground_heights for body {name:?}");
            return Err(fail(PsStatus::BadNumber, text));
        }
        let length = body.rotation.length();
        // False for NaN too.
        let unit = (length - 1.0).abs() <= LENGTH_TOLERANCE;
        if !unit {
            let text =
                format_args!("expected a rotation of length 1 of body {name:?}, found length {length}");
            return Err(fail(PsStatus::BadNumber, text));
        }
    }
    let mut velocities = state.joint_velocities.iter().zip(skeleton.joints());
    if let Some((found, joint)) = velocities.find(|(v, _)| !v.is_finite()) {
        let name = &joint.name;
        let text = format_args!("expected a finite joint velocity of {name:?}, found {found}");
        return Err(fail(PsStatus::BadNumber, text));
    }
    Ok(())
}
