//! Means and deviations of everything observed in the clips: one for the whole graph.

use physics_bridge::Model;
use policy_core::{FRAME_LEN, Normaliser, OBSERVATION_LEN, discriminator_frame_into, observe_into};

use super::fitted::{Fitted, SourceError, fit};
use crate::clip::Clip;

/// The normalisers of the whole graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Normalisers {
    /// Of the 223 observed numbers.
    pub observation: Normaliser,
    /// Of the 125 numbers of a discriminator frame.
    pub frame: Normaliser,
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
