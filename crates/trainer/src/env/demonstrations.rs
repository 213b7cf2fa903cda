//! Demonstration clips: fitted to the body, lifted, run through the physics' forward kinematics, turned into normalised
//! discriminator frames and states for reference-state initialisation.

use physics_bridge::{Model, Pose};
use policy_core::{
    CharacterState, DISCRIMINATOR_INPUT_LEN, DOF_COUNT, FRAME_AGES, FRAME_LEN, HISTORY_LEN, Normaliser,
    discriminator_frame_into,
};

use super::fitted::{Fitted, SourceError, fit};
use super::tracking::TrackedState;
use crate::Rng;
use crate::clip::{Clip, Motion, TICK_STRIDE};

/// One fitted clip with the frames a discriminator sees.
#[derive(Clone, Debug)]
struct Source {
    motion: Motion,
    /// Normalised frames, one for each pose.
    frames: Vec<[f32; FRAME_LEN]>,
    /// What tracking compares with, one for each pose.
    tracked: Vec<TrackedState>,
    /// Index of the source that is its mirror image; its own when it is taken one way round only.
    mirror: usize,
    /// Share of this clip when one is drawn.
    share: f32,
}

/// Poses that motors lag behind: 0.1 s, damping over gain of every joint of the humanoid, and half a tick.
const AHEAD: usize = 14;

/// A phase of a clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClipPhase {
    source: usize,
    index: usize,
}

/// A state of a clip to start an episode from, and the frames that led to it.
#[derive(Clone, Debug)]
pub struct ReferenceState {
    /// Pose and velocity; horizontal position and heading are the clip's.
    pub pose: Pose,
    /// Normalised frames, oldest first, the last one that of the pose.
    pub frames: Box<[[f32; FRAME_LEN]; HISTORY_LEN]>,
    /// Its phase.
    pub phase: ClipPhase,
}

/// The clips of one skill.
#[derive(Clone, Debug)]
pub struct Demonstrations {
    sources: Vec<Source>,
    shares: f32,
}

impl Demonstrations {
    /// Makes clips ready, and their mirror images where the last entry says so; `share` says how often each is drawn.
    ///
    /// # Errors
    /// When a clip is too short or the physics refuses a pose.
    pub fn from_clips(
        clips: &[(Clip, f32, bool)],
        model: &Model,
        normaliser: &Normaliser,
    ) -> Result<Self, SourceError> {
        let mut sources = Vec::new();
        for (clip, share, mirrored) in clips {
            let both = [Some(clip.clone()), mirrored.then(|| clip.mirrored())];
            let (first, ways) = (sources.len(), both.iter().flatten().count());
            for (way, clip) in both.into_iter().flatten().enumerate() {
                let Fitted { motion, states, .. } = fit(&clip, model)?;
                let frame = |state: &CharacterState| {
                    let mut frame = [0.0; FRAME_LEN];
                    discriminator_frame_into(state, &mut frame);
                    normaliser.normalise_in_place(&mut frame);
                    frame
                };
                let frames = states.iter().map(frame).collect();
                let tracked = states.iter().map(TrackedState::of).collect();
                let mirror = first + (way + 1) % ways;
                sources.push(Source { motion, frames, tracked, mirror, share: share / ways as f32 });
            }
        }
        let shares = sources.iter().map(|s| s.share).sum();
        Ok(Self { sources, shares })
    }

    /// The fitted clips.
    pub fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.sources.iter().map(|s| &s.motion)
    }

    /// Mean height of the root above the ground, metres.
    #[must_use]
    pub fn root_metres(&self) -> f32 {
        let of = |s: &Source| {
            s.tracked.iter().map(TrackedState::root_metres).sum::<f32>() / s.tracked.len() as f32
        };
        self.sources.iter().map(|s| s.share * of(s)).sum::<f32>() / self.shares
    }

    fn sample_phase(&self, rng: &mut Rng) -> ClipPhase {
        let mut left = rng.uniform() * self.shares;
        let drawn = self.sources.iter().position(|s| {
            left -= s.share;
            left < 0.0
        });
        let source = drawn.unwrap_or(self.sources.len() - 1);
        ClipPhase { source, index: rng.index(self.sources[source].motion.poses.len()) }
    }

    /// Samples a phase in the first tenth of a second of a clip.
    pub fn sample_beginning(&self, rng: &mut Rng) -> ClipPhase {
        ClipPhase { source: self.sample_phase(rng).source, index: rng.index(3 * TICK_STRIDE) }
    }

    /// A control tick later; `None` when the clip is over.
    #[must_use]
    pub fn after(&self, phase: ClipPhase) -> Option<ClipPhase> {
        let motion = &self.sources[phase.source].motion;
        let index = phase.index + TICK_STRIDE;
        let index = if motion.looping { index % motion.poses.len() } else { index };
        (index < motion.poses.len()).then_some(ClipPhase { index, ..phase })
    }

    /// True when the clip of that phase begins anew where it ends.
    #[must_use]
    pub fn loops(&self, phase: ClipPhase) -> bool {
        self.sources[phase.source].motion.looping
    }

    /// Joint angles that motors without lag would need now to be at the clip's pose a tick later: those of the pose that lies
    /// ahead by the time constant of the joints, damping over gain, and half a tick.
    #[must_use]
    pub fn ahead(&self, phase: ClipPhase) -> [f32; DOF_COUNT] {
        let motion = &self.sources[phase.source].motion;
        let (index, len) = (phase.index + AHEAD, motion.poses.len());
        let pose = &motion.poses[if motion.looping { index % len } else { index.min(len - 1) }];
        std::array::from_fn(|joint| pose.qpos[7 + joint] as f32)
    }

    /// What tracking compares with at a phase.
    #[must_use]
    pub fn tracked_at(&self, phase: ClipPhase) -> &TrackedState {
        &self.sources[phase.source].tracked[phase.index]
    }

    /// The same phase of the clip's mirror image; the phase itself of a clip that is taken one way round only.
    #[must_use]
    pub fn mirrored(&self, phase: ClipPhase) -> ClipPhase {
        ClipPhase { source: self.sources[phase.source].mirror, ..phase }
    }

    /// The phase with the smallest tracking error.
    ///
    /// # Panics
    /// When there is no clip.
    #[must_use]
    pub fn nearest(&self, is: &TrackedState) -> ClipPhase {
        let phases = self.sources.iter().enumerate().flat_map(|(source, s)| {
            let every = s.tracked.iter().enumerate().step_by(TICK_STRIDE);
            every.map(move |(index, wanted)| (ClipPhase { source, index }, is.reward(wanted)))
        });
        phases.max_by(|a, b| a.1.total_cmp(&b.1)).expect("demonstrations have a clip").0
    }

    /// The phase of a cycle that a character is most like, at most so many control ticks before or after another one.
    #[must_use]
    pub fn nearest_around(&self, phase: ClipPhase, ticks: usize, is: &TrackedState) -> ClipPhase {
        let source = &self.sources[phase.source];
        let len = source.tracked.len();
        let behind = (ticks * TICK_STRIDE).min(len / 2);
        let around = (0..=2 * behind).step_by(TICK_STRIDE).map(|i| (phase.index + len - behind + i) % len);
        let best =
            around.max_by(|a, b| is.reward(&source.tracked[*a]).total_cmp(&is.reward(&source.tracked[*b])));
        ClipPhase { index: best.unwrap_or(phase.index), ..phase }
    }

    /// Samples a phase of a clip and writes the discriminator's input there.
    pub fn sample_into(&self, rng: &mut Rng, out: &mut [f32; DISCRIMINATOR_INPUT_LEN]) {
        let ClipPhase { source, index } = self.sample_phase(rng);
        let source = &self.sources[source];
        for (chunk, age) in out.chunks_exact_mut(FRAME_LEN).zip(FRAME_AGES) {
            chunk.copy_from_slice(&source.frames[source.motion.earlier(index, age)]);
        }
    }

    /// Samples a state for reference-state initialisation.
    #[must_use]
    pub fn sample_reference_state(&self, rng: &mut Rng) -> ReferenceState {
        let phase = self.sample_phase(rng);
        let (source, index) = (&self.sources[phase.source], phase.index);
        let mut frames = Box::new([[0.0; FRAME_LEN]; HISTORY_LEN]);
        for (age, frame) in frames.iter_mut().rev().enumerate() {
            *frame = source.frames[source.motion.earlier(index, age)];
        }
        ReferenceState { pose: source.motion.poses[index], frames, phase }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::Quat;
    use policy_core::Body;

    use super::*;
    use crate::clip::tests::still;

    #[test]
    fn the_nearest_moment_is_that_of_the_same_pose() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let model = Model::load(path).unwrap();
        let mut clip = still(31);
        for (i, rotations) in clip.local_rotations.iter_mut().enumerate() {
            rotations[Body::Torso.index()] = Quat::from_rotation_y(0.04 * i as f32);
        }
        let plain = Normaliser::from_mean_and_deviation(&[0.0; FRAME_LEN], &[1.0; FRAME_LEN]).unwrap();
        let clips = Demonstrations::from_clips(&[(clip, 1.0, false)], &model, &plain).unwrap();
        for index in [0, 5 * TICK_STRIDE, 20 * TICK_STRIDE] {
            let phase = ClipPhase { source: 0, index };
            assert_eq!(clips.nearest(clips.tracked_at(phase)), phase);
            assert_eq!(clips.mirrored(phase), phase);
            let before = ClipPhase { source: 0, index: index.saturating_sub(4 * TICK_STRIDE) };
            assert_eq!(clips.nearest_around(before, 6, clips.tracked_at(phase)), phase);
            if index > 0 {
                assert_ne!(clips.nearest_around(before, 2, clips.tracked_at(phase)), phase);
            }
            assert_eq!(clips.after(phase), Some(ClipPhase { source: 0, index: index + TICK_STRIDE }));
        }
    }
}
