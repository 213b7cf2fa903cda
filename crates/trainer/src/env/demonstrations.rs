//! Clips made ready to learn from: fitted, lifted, run through the physics' forward kinematics, turned into
//! normalised discriminator frames and start states.

use physics_bridge::{Model, Pose};
use policy_core::{
    CharacterState, DISCRIMINATOR_INPUT_LEN, DOF_COUNT, FRAME_AGES, FRAME_LEN, HISTORY_LEN, Normaliser,
    discriminator_frame_into,
};

use super::fitted::{Fitted, SourceError, fit};
use super::imitation::Likeness;
use crate::Rng;
use crate::clip::{Clip, Motion, TICK_STRIDE};

/// One fitted clip with the frames a discriminator sees.
#[derive(Clone, Debug)]
struct Source {
    motion: Motion,
    /// Normalised frames, one for each pose.
    frames: Vec<[f32; FRAME_LEN]>,
    /// What an imitation of each pose is held against.
    likenesses: Vec<Likeness>,
    /// Index of the source that is its mirror image; its own when it is taken one way round only.
    mirror: usize,
    /// Share of this clip when one is drawn.
    share: f32,
}

/// Poses that motors lag behind: 0.1 s, damping over gain of every joint of the humanoid, and half a tick.
const AHEAD: usize = 14;

/// A moment of a clip of some demonstrations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment {
    source: usize,
    index: usize,
}

/// A start state and the frames that led to it.
#[derive(Clone, Debug)]
pub struct StartPose {
    /// Where the character starts; horizontal place and heading are the clip's.
    pub pose: Pose,
    /// Normalised frames, oldest first, the last one that of the pose.
    pub frames: Box<[[f32; FRAME_LEN]; HISTORY_LEN]>,
    /// When that is.
    pub moment: Moment,
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
                let likenesses = states.iter().map(Likeness::of).collect();
                let mirror = first + (way + 1) % ways;
                sources.push(Source { motion, frames, likenesses, mirror, share: share / ways as f32 });
            }
        }
        let shares = sources.iter().map(|s| s.share).sum();
        Ok(Self { sources, shares })
    }

    /// The fitted clips.
    pub fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.sources.iter().map(|s| &s.motion)
    }

    /// Mean height of the pelvis above the ground, metres.
    #[must_use]
    pub fn pelvis_metres(&self) -> f32 {
        let of = |s: &Source| {
            s.likenesses.iter().map(Likeness::pelvis_metres).sum::<f32>() / s.likenesses.len() as f32
        };
        self.sources.iter().map(|s| s.share * of(s)).sum::<f32>() / self.shares
    }

    fn draw(&self, rng: &mut Rng) -> Moment {
        let mut left = rng.uniform() * self.shares;
        let drawn = self.sources.iter().position(|s| {
            left -= s.share;
            left < 0.0
        });
        let source = drawn.unwrap_or(self.sources.len() - 1);
        Moment { source, index: rng.index(self.sources[source].motion.poses.len()) }
    }

    /// A moment in the first tenth of a second of a clip.
    pub fn draw_beginning(&self, rng: &mut Rng) -> Moment {
        Moment { source: self.draw(rng).source, index: rng.index(3 * TICK_STRIDE) }
    }

    /// A control tick later; `None` when the clip is over.
    #[must_use]
    pub fn after(&self, moment: Moment) -> Option<Moment> {
        let motion = &self.sources[moment.source].motion;
        let index = moment.index + TICK_STRIDE;
        let index = if motion.looping { index % motion.poses.len() } else { index };
        (index < motion.poses.len()).then_some(Moment { index, ..moment })
    }

    /// True when the clip of that moment begins anew where it ends.
    #[must_use]
    pub fn loops(&self, moment: Moment) -> bool {
        self.sources[moment.source].motion.looping
    }

    /// Joint angles that motors without lag would need now to be at the clip's pose a tick later: those of the pose that lies
    /// ahead by the time constant of the joints, damping over gain, and half a tick.
    #[must_use]
    pub fn ahead(&self, moment: Moment) -> [f32; DOF_COUNT] {
        let motion = &self.sources[moment.source].motion;
        let (index, len) = (moment.index + AHEAD, motion.poses.len());
        let pose = &motion.poses[if motion.looping { index % len } else { index.min(len - 1) }];
        std::array::from_fn(|joint| pose.qpos[7 + joint] as f32)
    }

    /// What an imitation is held against at that moment.
    #[must_use]
    pub fn likeness(&self, moment: Moment) -> &Likeness {
        &self.sources[moment.source].likenesses[moment.index]
    }

    /// The same moment of the clip's mirror image; the moment itself of a clip that is taken one way round only.
    #[must_use]
    pub fn mirrored(&self, moment: Moment) -> Moment {
        Moment { source: self.sources[moment.source].mirror, ..moment }
    }

    /// The moment that a character is most like.
    ///
    /// # Panics
    /// When there is no clip.
    #[must_use]
    pub fn nearest(&self, is: &Likeness) -> Moment {
        let moments = self.sources.iter().enumerate().flat_map(|(source, s)| {
            let every = s.likenesses.iter().enumerate().step_by(TICK_STRIDE);
            every.map(move |(index, wanted)| (Moment { source, index }, is.reward(wanted)))
        });
        moments.max_by(|a, b| a.1.total_cmp(&b.1)).expect("demonstrations have a clip").0
    }

    /// The moment of a cycle that a character is most like, at most so many control ticks before or after another one.
    #[must_use]
    pub fn nearest_around(&self, moment: Moment, ticks: usize, is: &Likeness) -> Moment {
        let source = &self.sources[moment.source];
        let len = source.likenesses.len();
        let behind = (ticks * TICK_STRIDE).min(len / 2);
        let around = (0..=2 * behind).step_by(TICK_STRIDE).map(|i| (moment.index + len - behind + i) % len);
        let best = around
            .max_by(|a, b| is.reward(&source.likenesses[*a]).total_cmp(&is.reward(&source.likenesses[*b])));
        Moment { index: best.unwrap_or(moment.index), ..moment }
    }

    /// Draws a moment of a clip and writes the discriminator's input there.
    pub fn sample_into(&self, rng: &mut Rng, out: &mut [f32; DISCRIMINATOR_INPUT_LEN]) {
        let Moment { source, index } = self.draw(rng);
        let source = &self.sources[source];
        for (chunk, age) in out.chunks_exact_mut(FRAME_LEN).zip(FRAME_AGES) {
            chunk.copy_from_slice(&source.frames[source.motion.earlier(index, age)]);
        }
    }

    /// Draws a start state.
    #[must_use]
    pub fn draw_start(&self, rng: &mut Rng) -> StartPose {
        let moment = self.draw(rng);
        let (source, index) = (&self.sources[moment.source], moment.index);
        let mut frames = Box::new([[0.0; FRAME_LEN]; HISTORY_LEN]);
        for (age, frame) in frames.iter_mut().rev().enumerate() {
            *frame = source.frames[source.motion.earlier(index, age)];
        }
        StartPose { pose: source.motion.poses[index], frames, moment }
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
            let moment = Moment { source: 0, index };
            assert_eq!(clips.nearest(clips.likeness(moment)), moment);
            assert_eq!(clips.mirrored(moment), moment);
            let before = Moment { source: 0, index: index.saturating_sub(4 * TICK_STRIDE) };
            assert_eq!(clips.nearest_around(before, 6, clips.likeness(moment)), moment);
            if index > 0 {
                assert_ne!(clips.nearest_around(before, 2, clips.likeness(moment)), moment);
            }
            assert_eq!(clips.after(moment), Some(Moment { source: 0, index: index + TICK_STRIDE }));
        }
    }
}
