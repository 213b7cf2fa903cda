//! What a discriminator sees: features of one frame, and the history of frames it judges.
//!
//! The frame holds pelvis height (1), pelvis rotation (6), linear (3) and angular velocity (3) in the
//! heading frame, local rotation of the 12 jointed bodies (72), joint velocities (28), hands and feet
//! relative to the pelvis (12). See AMP (Peng et al. 2021), section 5.

use glam::Quat;

use crate::body::{Body, DOF_COUNT};
use crate::heading::{Heading, axes_xz};
use crate::observation::Cursor;
use crate::state::CharacterState;

/// Numbers in one discriminator frame.
pub const FRAME_LEN: usize = 1 + 6 + 3 + 3 + 6 * 12 + DOF_COUNT + 3 * 4;

/// Ages of the frames a discriminator sees, in control ticks, newest first.
pub const FRAME_AGES: [usize; 5] = [0, 1, 2, 4, 8];

/// Inputs of a discriminator: one frame for each of [`FRAME_AGES`].
pub const DISCRIMINATOR_INPUT_LEN: usize = FRAME_LEN * FRAME_AGES.len();

/// Frames a [`FrameHistory`] must have seen before it can be judged.
pub const HISTORY_LEN: usize = FRAME_AGES[FRAME_AGES.len() - 1] + 1;

/// Bodies that hang on joints, in the order of their features; hands are welded to the lower arms.
const JOINTED: [Body; 12] = [
    Body::Torso,
    Body::Head,
    Body::RightUpperArm,
    Body::RightLowerArm,
    Body::LeftUpperArm,
    Body::LeftLowerArm,
    Body::RightThigh,
    Body::RightShin,
    Body::RightFoot,
    Body::LeftThigh,
    Body::LeftShin,
    Body::LeftFoot,
];

const ENDS: [Body; 4] = [Body::RightHand, Body::LeftHand, Body::RightFoot, Body::LeftFoot];

/// Writes the raw features of one frame to `out`. Does not allocate.
pub fn discriminator_frame_into(state: &CharacterState, out: &mut [f32; FRAME_LEN]) {
    let pelvis = state.body(Body::Pelvis);
    let heading = Heading::from_rotation(pelvis.rotation);
    let mut cursor = Cursor { out, at: 0 };
    cursor.push(state.height_of(Body::Pelvis));
    let (x, z) = axes_xz(pelvis.rotation);
    cursor.push3(heading.heading_from_world(x));
    cursor.push3(heading.heading_from_world(z));
    cursor.push3(heading.heading_from_world(pelvis.linear_velocity));
    cursor.push3(heading.heading_from_world(pelvis.angular_velocity));
    for body in JOINTED {
        let parent = body.parent().expect("a jointed body hangs on another");
        let local: Quat = state.body(parent).rotation.conjugate() * state.body(body).rotation;
        let (x, z) = axes_xz(local);
        cursor.push3(x);
        cursor.push3(z);
    }
    for &velocity in &state.joint_velocities {
        cursor.push(velocity);
    }
    for body in ENDS {
        cursor.push3(heading.heading_from_world(state.body(body).position - pelvis.position));
    }
    debug_assert_eq!(cursor.at, FRAME_LEN);
}

/// The last frames of one character, normalised, as its discriminators need them.
///
/// A ring of [`HISTORY_LEN`] frames; allocates nothing.
#[derive(Clone, Debug)]
pub struct FrameHistory {
    frames: [[f32; FRAME_LEN]; HISTORY_LEN],
    newest: usize,
    seen: usize,
}

impl Default for FrameHistory {
    fn default() -> Self {
        Self { frames: [[0.0; FRAME_LEN]; HISTORY_LEN], newest: 0, seen: 0 }
    }
}

impl FrameHistory {
    /// Forgets all frames, as after a reset.
    pub fn clear(&mut self) {
        self.seen = 0;
    }

    /// The slot of a new frame, for the caller to write; the oldest frame is lost.
    pub fn push(&mut self) -> &mut [f32; FRAME_LEN] {
        self.newest = (self.newest + 1) % HISTORY_LEN;
        self.seen = (self.seen + 1).min(HISTORY_LEN);
        &mut self.frames[self.newest]
    }

    /// True once the oldest frame a discriminator sees is there.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.seen == HISTORY_LEN
    }

    /// Writes the discriminator's input, newest frame first, or returns false while the history is not full.
    pub fn input_into(&self, out: &mut [f32; DISCRIMINATOR_INPUT_LEN]) -> bool {
        if !self.is_full() {
            return false;
        }
        for (chunk, age) in out.chunks_exact_mut(FRAME_LEN).zip(FRAME_AGES) {
            chunk.copy_from_slice(&self.frames[(self.newest + HISTORY_LEN - age) % HISTORY_LEN]);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_those_of_the_design() {
        assert_eq!((FRAME_LEN, DISCRIMINATOR_INPUT_LEN, HISTORY_LEN), (125, 625, 9));
    }

    #[test]
    fn history_gives_the_frames_of_the_stated_ages() {
        let mut history = FrameHistory::default();
        let mut input = [0.0; DISCRIMINATOR_INPUT_LEN];
        for tick in 0..20 {
            assert_eq!(history.input_into(&mut input), tick >= HISTORY_LEN);
            history.push().fill(tick as f32);
        }
        assert!(history.input_into(&mut input));
        let seen: [f32; 5] = core::array::from_fn(|i| input[i * FRAME_LEN]);
        assert_eq!(seen, [19.0, 18.0, 17.0, 15.0, 11.0]);
        history.clear();
        assert!(!history.input_into(&mut input));
    }
}
