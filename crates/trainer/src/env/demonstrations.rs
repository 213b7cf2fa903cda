//! Demonstration clips: fitted to the body, lifted, run through the physics' forward kinematics, turned into normalised
//! discriminator frames and states for reference-state initialisation.

use clips::{Clip, FitError, Fitted, MOTION_HZ, Motion, TICK_STRIDE, fit};
use physics_bridge::{Model, Pose};
use policy_core::training::{FRAME_AGES, HISTORY_LEN, Normaliser, discriminator_frame_into};
use policy_core::{CharacterState, JointActuation};
use random::Rng;

use super::tracking::TrackedState;

/// One fitted clip with the frames a discriminator sees.
#[derive(Clone, Debug)]
struct Source {
    motion: Motion,
    /// Normalised frames, `[poses][frame]`.
    frames: Vec<f32>,
    /// What tracking compares with, one for each pose.
    tracked: Vec<TrackedState>,
    /// Index of the source that is its mirror image; its own when it is taken one way round only.
    mirror: usize,
    /// Share of this clip when one is drawn.
    share: f32,
}

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
    /// Normalised frames, `[ticks][frame]`, oldest first, the last one that of the pose.
    pub frames: Vec<f32>,
    /// Its phase.
    pub phase: ClipPhase,
}

/// The clips of one skill.
#[derive(Clone, Debug)]
pub struct Demonstrations {
    sources: Vec<Source>,
    shares: f32,
    frame_len: usize,
    /// Poses that the motor of each joint lags behind: damping over gain, and half a tick.
    lags: Vec<usize>,
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
    ) -> Result<Self, FitError> {
        let frame_len = model.skeleton().frame_len();
        let mut sources = Vec::new();
        for (clip, share, mirrored) in clips {
            let both = [Some(clip.clone()), mirrored.then(|| clip.mirrored())];
            let (first, ways) = (sources.len(), both.iter().flatten().count());
            for (way, clip) in both.into_iter().flatten().enumerate() {
                let Fitted { motion, states, .. } = fit(&clip, model)?;
                let frame = |state: &CharacterState| {
                    let mut frame = vec![0.0; frame_len];
                    discriminator_frame_into(model.skeleton(), state, &mut frame);
                    normaliser.normalise_in_place(&mut frame);
                    frame
                };
                let frames = states.iter().flat_map(frame).collect();
                let tracked = states.iter().map(TrackedState::of).collect();
                let mirror = first + (way + 1) % ways;
                sources.push(Source { motion, frames, tracked, mirror, share: share / ways as f32 });
            }
        }
        let shares = sources.iter().map(|s| s.share).sum();
        let half_a_tick = 0.5 / model.control_hz();
        let lag = |joint: &JointActuation| {
            ((joint.damping / joint.gain + half_a_tick) * MOTION_HZ).round() as usize
        };
        let lags = model.actuation().joints.iter().map(lag).collect();
        Ok(Self { sources, shares, frame_len, lags })
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

    /// Seconds from the beginning of the clip to a phase.
    #[must_use]
    pub fn seconds_at(&self, phase: ClipPhase) -> f32 {
        (phase.index as f64 * self.sources[phase.source].motion.dt_secs) as f32
    }

    /// True when the clip of that phase begins anew where it ends.
    #[must_use]
    pub fn loops(&self, phase: ClipPhase) -> bool {
        self.sources[phase.source].motion.looping
    }

    /// Writes the joint angles that motors without lag would need now to be at the clip's pose a tick later: those of the pose
    /// that lies ahead by the time constant of each joint, damping over gain, and half a tick.
    ///
    /// # Panics
    /// When `out` has not one number for each joint.
    pub fn ahead_into(&self, phase: ClipPhase, out: &mut [f32]) {
        assert_eq!(out.len(), self.lags.len(), "one angle for each joint");
        let motion = &self.sources[phase.source].motion;
        let len = motion.poses.len();
        for (joint, (out, lag)) in out.iter_mut().zip(&self.lags).enumerate() {
            let index = phase.index + lag;
            let pose = &motion.poses[if motion.looping { index % len } else { index.min(len - 1) }];
            *out = pose.qpos[7 + joint] as f32;
        }
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
    ///
    /// # Panics
    /// When `out` has not room for one frame of each age exactly.
    pub fn sample_into(&self, rng: &mut Rng, out: &mut [f32]) {
        assert_eq!(out.len(), self.frame_len * FRAME_AGES.len(), "inputs of a discriminator");
        let ClipPhase { source, index } = self.sample_phase(rng);
        let source = &self.sources[source];
        for (chunk, age) in out.chunks_exact_mut(self.frame_len).zip(FRAME_AGES) {
            chunk.copy_from_slice(self.frame(source, source.motion.earlier(index, age)));
        }
    }

    /// Samples a state for reference-state initialisation.
    #[must_use]
    pub fn sample_reference_state(&self, rng: &mut Rng) -> ReferenceState {
        let phase = self.sample_phase(rng);
        let (source, index) = (&self.sources[phase.source], phase.index);
        let ages = (0..HISTORY_LEN).rev();
        let frames = ages.flat_map(|age| self.frame(source, source.motion.earlier(index, age)));
        ReferenceState { pose: source.motion.poses[index].clone(), frames: frames.copied().collect(), phase }
    }

    fn frame<'a>(&self, source: &'a Source, index: usize) -> &'a [f32] {
        &source.frames[index * self.frame_len..(index + 1) * self.frame_len]
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::Quat;

    use super::super::made_up::{body, still};
    use super::*;

    #[test]
    fn the_nearest_moment_is_that_of_the_same_pose() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let model = Model::load(path).unwrap();
        let mut clip = still(31);
        for (i, rotations) in clip.local_rotations.iter_mut().enumerate() {
            rotations[body("torso")] = Quat::from_rotation_y(0.04 * i as f32);
        }
        let plain = Normaliser::from_mean_and_deviation(&[0.0; 125], &[1.0; 125]).unwrap();
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
            // Damping over gain is 0.1 s for every joint of the humanoid: 12 poses, and half a tick.
            assert!(clips.lags.iter().all(|lag| *lag == 14));
            assert_eq!(clips.after(phase), Some(ClipPhase { source: 0, index: index + TICK_STRIDE }));
        }
    }
}
