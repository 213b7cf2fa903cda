//! What a discriminator sees: features of one frame, and the history of frames that it scores.
//!
//! A frame holds height (1), rotation (6), linear (3) and angular velocity (3) of the root in the heading frame, the
//! local rotation of every jointed body (6 each), joint velocities (1 each), hands and feet relative to the root (3
//! each). See AMP (Peng et al. 2021), section 5.

use alloc::vec::Vec;

use glam::Quat;

use crate::heading::{Heading, axes_xz, product};
use crate::observation::Cursor;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// Ages of the frames a discriminator sees, in control ticks, newest first.
pub const FRAME_AGES: [usize; 5] = [0, 1, 2, 4, 8];

/// Frames a [`FrameHistory`] must have seen before it can be scored.
pub const HISTORY_LEN: usize = FRAME_AGES[FRAME_AGES.len() - 1] + 1;

/// Writes the raw features of one frame to `out`. Does not allocate.
///
/// # Panics
/// When the state does not fit the skeleton, or `out` is not [`Skeleton::frame_len`] long.
pub fn discriminator_frame_into(skeleton: &Skeleton, state: &CharacterState, out: &mut [f32]) {
    assert!(state.fits(skeleton), "a state of the skeleton");
    assert_eq!(out.len(), skeleton.frame_len(), "numbers of a frame");
    // The state fits, ids of a skeleton are checked when it is made, and `frame_len` counts what is pushed.
    let root = state.root();
    let heading = Heading::from_rotation(root.rotation);
    let mut cursor = Cursor { out, at: 0 };
    cursor.push(state.root_height());
    let (x, z) = axes_xz(root.rotation);
    cursor.push3(heading.heading_from_world(x));
    cursor.push3(heading.heading_from_world(z));
    cursor.push3(heading.heading_from_world(root.linear_velocity));
    cursor.push3(heading.heading_from_world(root.angular_velocity));
    for &body in skeleton.jointed_bodies() {
        let parent = skeleton.parent(body).map_or(Quat::IDENTITY, |parent| state.body(parent).rotation);
        let (x, z) = axes_xz(product(parent.conjugate(), state.body(body).rotation));
        cursor.push3(x);
        cursor.push3(z);
    }
    for &velocity in &state.joint_velocities {
        cursor.push(velocity);
    }
    for &body in skeleton.hands().iter().chain(skeleton.feet()) {
        cursor.push3(heading.heading_from_world(state.body(body).position - root.position));
    }
}

/// The last frames of one character, normalised, as its discriminators need them.
///
/// A ring of [`HISTORY_LEN`] frames; sized once.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameHistory {
    /// [`HISTORY_LEN`] frames, one behind the other.
    frames: Vec<f32>,
    frame_len: usize,
    newest: usize,
    seen: usize,
}

impl FrameHistory {
    /// An empty history for frames of this length. Allocates.
    #[must_use]
    pub fn new(frame_len: usize) -> Self {
        Self { frames: alloc::vec![0.0; HISTORY_LEN * frame_len], frame_len, newest: 0, seen: 0 }
    }

    /// Copies a history of the same size without allocating.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.frames.copy_from_slice(&other.frames);
        (self.newest, self.seen) = (other.newest, other.seen);
    }

    /// Numbers of all frames of a history.
    pub(crate) fn new_len(frame_len: usize) -> usize {
        HISTORY_LEN * frame_len
    }

    /// Forgets all frames, as after a reset.
    pub fn clear(&mut self) {
        self.seen = 0;
    }

    /// Forgets all frames and their bits: what a new history is.
    pub(crate) fn reset(&mut self) {
        self.frames.fill(0.0);
        (self.newest, self.seen) = (0, 0);
    }

    /// The slot of a new frame, for the caller to write; the oldest frame is lost.
    pub fn push(&mut self) -> &mut [f32] {
        // `newest` stays below the number of frames in the ring, here and in `input_into`.
        self.newest = (self.newest + 1) % HISTORY_LEN;
        self.seen = (self.seen + 1).min(HISTORY_LEN);
        &mut self.frames[self.newest * self.frame_len..][..self.frame_len]
    }

    /// True once the oldest frame a discriminator sees is there.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.seen == HISTORY_LEN
    }

    /// Writes the discriminator's input, newest frame first, or returns false while the history is not full.
    ///
    /// # Panics
    /// When `out` has not room for one frame of each of [`FRAME_AGES`] exactly, or frames have no numbers.
    pub fn input_into(&self, out: &mut [f32]) -> bool {
        assert_eq!(out.len(), self.frame_len * FRAME_AGES.len(), "inputs of a discriminator");
        if !self.is_full() {
            return false;
        }
        for (chunk, age) in out.chunks_exact_mut(self.frame_len).zip(FRAME_AGES) {
            let frame = (self.newest + HISTORY_LEN - age) % HISTORY_LEN;
            chunk.copy_from_slice(&self.frames[frame * self.frame_len..][..self.frame_len]);
        }
        true
    }

    /// Frames, slot of the newest and number seen: what its bytes hold.
    pub(crate) fn parts(&self) -> (&[f32], usize, usize) {
        (&self.frames, self.newest, self.seen)
    }

    /// The frames to be overwritten from bytes.
    pub(crate) fn frames_mut(&mut self) -> &mut [f32] {
        &mut self.frames
    }

    /// Sets slot and number from bytes; false when they are out of range.
    pub(crate) fn set_cursor(&mut self, newest: usize, seen: usize) -> bool {
        let fits = newest < HISTORY_LEN && seen <= HISTORY_LEN;
        if fits {
            (self.newest, self.seen) = (newest, seen);
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn history_gives_the_frames_of_the_stated_ages() {
        let mut history = FrameHistory::new(3);
        let mut input = [0.0; 15];
        for tick in 0..20 {
            assert_eq!(history.input_into(&mut input), tick >= HISTORY_LEN);
            history.push().fill(tick as f32);
        }
        assert!(history.input_into(&mut input));
        let seen: [f32; 5] = core::array::from_fn(|i| input[i * 3]);
        assert_eq!(seen, [19.0, 18.0, 17.0, 15.0, 11.0]);
        history.clear();
        assert!(!history.input_into(&mut input));
    }
}
