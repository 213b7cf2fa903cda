//! Clips made ready to learn from: fitted, lifted, run through the physics' forward kinematics, turned into
//! normalised discriminator frames and start states.

use physics_bridge::{Character, Model, Pose, PoseError};
use policy_core::{
    CharacterState, DISCRIMINATOR_INPUT_LEN, FRAME_AGES, FRAME_LEN, HISTORY_LEN, Normaliser, OBSERVATION_LEN,
    discriminator_frame_into, observe_into,
};

use crate::Rng;
use crate::clip::{Clip, ClipError, JointLimits, Motion};

/// The normalisers of the whole graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Normalisers {
    /// Of the 223 observed numbers.
    pub observation: Normaliser,
    /// Of the 125 numbers of a discriminator frame.
    pub frame: Normaliser,
}

/// Why clips can't be made ready.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// A clip is wrong.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// A fitted pose is refused by the physics.
    #[error("clip {clip}: pose {index} is no pose of the humanoid")]
    Pose {
        /// Name of the clip.
        clip: String,
        /// Index of the pose.
        index: usize,
        /// What is wrong with it.
        source: PoseError,
    },
}

/// One fitted clip with the frames a discriminator sees.
#[derive(Clone, Debug)]
struct Source {
    motion: Motion,
    /// Normalised frames, one for each pose.
    frames: Vec<[f32; FRAME_LEN]>,
    /// Share of this clip when one is drawn.
    share: f32,
}

/// A start state and the frames that led to it.
#[derive(Clone, Debug)]
pub struct StartPose {
    /// Where the character starts; horizontal place and heading are the clip's.
    pub pose: Pose,
    /// Normalised frames, oldest first, the last one that of the pose.
    pub frames: Box<[[f32; FRAME_LEN]; HISTORY_LEN]>,
}

/// The clips of one skill.
#[derive(Clone, Debug)]
pub struct Demonstrations {
    sources: Vec<Source>,
    shares: f32,
}

/// A clip on the ground: its motion, and state and clearance of every pose.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The motion, lifted.
    pub motion: Motion,
    /// What each pose senses, by the physics' forward kinematics.
    pub states: Vec<CharacterState>,
    /// Height of each pose's lowest point, metres; negative inside the ground.
    pub clearances: Vec<f32>,
    /// How far the clip was lifted, metres.
    pub lift: f32,
}

/// Fits a clip and lifts it so that a fifth of its poses touch the ground or sink in.
///
/// # Errors
/// When the clip is too short or the physics refuses a pose.
pub fn fit(clip: &Clip, model: &Model) -> Result<Fitted, SourceError> {
    let (low, high) = model.joint_limits();
    let mut motion = Motion::fit(clip, JointLimits { low, high })?;
    let mut lowest = states(&motion, model)?.1;
    lowest.sort_by(f32::total_cmp);
    let lift = -lowest[lowest.len() / 5];
    motion.lift(f64::from(lift));
    let (states, clearances) = states(&motion, model)?;
    Ok(Fitted { motion, states, clearances, lift })
}

/// State and clearance of every pose by the physics' forward kinematics.
fn states(motion: &Motion, model: &Model) -> Result<(Vec<CharacterState>, Vec<f32>), SourceError> {
    let mut character = Character::new(model);
    let mut states = vec![CharacterState::default(); motion.poses.len()];
    let mut clearances = Vec::with_capacity(motion.poses.len());
    for (index, (pose, state)) in motion.poses.iter().zip(&mut states).enumerate() {
        let refused = |source| SourceError::Pose { clip: motion.name.clone(), index, source };
        character.set_pose(&pose.qpos, &pose.qvel).map_err(refused)?;
        character.sense_into(state);
        clearances.push(character.clearance());
    }
    Ok((states, clearances))
}

impl Demonstrations {
    /// Makes clips and their mirror images ready; `share` says how often each is drawn.
    ///
    /// # Errors
    /// When a clip is too short or the physics refuses a pose.
    pub fn from_clips(
        clips: &[(Clip, f32)],
        model: &Model,
        normaliser: &Normaliser,
    ) -> Result<Self, SourceError> {
        let mut sources = Vec::new();
        for (clip, share) in clips {
            for clip in [clip.clone(), clip.mirrored()] {
                let Fitted { motion, states, .. } = fit(&clip, model)?;
                let frame = |state: &CharacterState| {
                    let mut frame = [0.0; FRAME_LEN];
                    discriminator_frame_into(state, &mut frame);
                    normaliser.normalise_in_place(&mut frame);
                    frame
                };
                let frames = states.iter().map(frame).collect();
                sources.push(Source { motion, frames, share: share * 0.5 });
            }
        }
        let shares = sources.iter().map(|s| s.share).sum();
        Ok(Self { sources, shares })
    }

    /// The fitted clips.
    pub fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.sources.iter().map(|s| &s.motion)
    }

    fn draw(&self, rng: &mut Rng) -> (&Source, usize) {
        let mut left = rng.uniform() * self.shares;
        let drawn = self.sources.iter().find(|s| {
            left -= s.share;
            left < 0.0
        });
        let source = drawn.unwrap_or(&self.sources[self.sources.len() - 1]);
        (source, rng.index(source.motion.poses.len()))
    }

    /// Draws a moment of a clip and writes the discriminator's input there.
    pub fn sample_into(&self, rng: &mut Rng, out: &mut [f32; DISCRIMINATOR_INPUT_LEN]) {
        let (source, index) = self.draw(rng);
        for (chunk, age) in out.chunks_exact_mut(FRAME_LEN).zip(FRAME_AGES) {
            chunk.copy_from_slice(&source.frames[source.motion.earlier(index, age)]);
        }
    }

    /// Draws a start state.
    #[must_use]
    pub fn draw_start(&self, rng: &mut Rng) -> StartPose {
        let (source, index) = self.draw(rng);
        let mut frames = Box::new([[0.0; FRAME_LEN]; HISTORY_LEN]);
        for (age, frame) in frames.iter_mut().rev().enumerate() {
            *frame = source.frames[source.motion.earlier(index, age)];
        }
        StartPose { pose: source.motion.poses[index], frames }
    }
}

impl Normalisers {
    /// Means and deviations over all poses of the clips and their mirror images, every clip weighing the same.
    ///
    /// # Errors
    /// When a clip is too short or the physics refuses a pose.
    ///
    /// # Panics
    /// When there is no clip.
    pub fn from_clips(clips: &[Clip], model: &Model) -> Result<Self, SourceError> {
        assert!(!clips.is_empty(), "a normaliser needs a clip");
        let mut observation = Moments::new(OBSERVATION_LEN);
        let mut frame = Moments::new(FRAME_LEN);
        for clip in clips {
            for clip in [clip.clone(), clip.mirrored()] {
                let Fitted { states, .. } = fit(&clip, model)?;
                let weight = 1.0 / states.len() as f64;
                for state in &states {
                    let mut seen = [0.0; OBSERVATION_LEN];
                    observe_into(state, &mut seen);
                    observation.add(&seen, weight);
                    let mut seen = [0.0; FRAME_LEN];
                    discriminator_frame_into(state, &mut seen);
                    frame.add(&seen, weight);
                }
            }
        }
        Ok(Self { observation: observation.normaliser(), frame: frame.normaliser() })
    }
}

/// Weighted sums of values and their squares.
struct Moments {
    sum: Vec<f64>,
    square: Vec<f64>,
    weight: f64,
}

impl Moments {
    fn new(len: usize) -> Self {
        Self { sum: vec![0.0; len], square: vec![0.0; len], weight: 0.0 }
    }

    fn add(&mut self, values: &[f32], weight: f64) {
        self.weight += weight;
        for ((v, sum), square) in values.iter().zip(&mut self.sum).zip(&mut self.square) {
            *sum += weight * f64::from(*v);
            *square += weight * f64::from(*v).powi(2);
        }
    }

    fn normaliser(&self) -> Normaliser {
        let mean: Vec<f32> = self.sum.iter().map(|s| (s / self.weight) as f32).collect();
        let deviation = |(sum, square): (&f64, &f64)| {
            let variance = square / self.weight - (sum / self.weight).powi(2);
            (variance.max(0.0).sqrt() as f32).max(policy_core::LEAST_DEVIATION)
        };
        let deviation: Vec<f32> = self.sum.iter().zip(&self.square).map(deviation).collect();
        Normaliser::from_mean_and_deviation(&mean, &deviation)
            .expect("moments of finite numbers are finite and the deviation has a floor")
    }
}
