//! Means and deviations of everything observed in the clips: one for the whole graph.

use physics_bridge::Model;
use policy_core::observe_into;
use policy_core::training::{LEAST_DEVIATION, Normaliser, discriminator_frame_into};

use clips::{Clip, FitError, Fitted, fit};

/// The normalisers of the whole graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Normalisers {
    /// Of an observation, without the target.
    pub observation: Normaliser,
    /// Of a discriminator frame.
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
    pub fn from_clips(clips: &[Clip], model: &Model) -> Result<Self, FitError> {
        assert!(!clips.is_empty(), "a normaliser needs a clip");
        let skeleton = model.skeleton();
        let mut observation = Moments::new(skeleton.observation_len());
        let mut frame = Moments::new(skeleton.frame_len());
        for clip in clips {
            for clip in [clip.clone(), clip.mirrored()] {
                let Fitted { states, .. } = fit(&clip, model)?;
                let weight = 1.0 / states.len() as f64;
                for state in &states {
                    let mut seen = vec![0.0; skeleton.observation_len()];
                    observe_into(skeleton, state, &mut seen);
                    observation.add(&seen, weight);
                    let mut seen = vec![0.0; skeleton.frame_len()];
                    discriminator_frame_into(skeleton, state, &mut seen);
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
            (variance.max(0.0).sqrt() as f32).max(LEAST_DEVIATION)
        };
        let deviation: Vec<f32> = self.sum.iter().zip(&self.square).map(deviation).collect();
        Normaliser::from_mean_and_deviation(&mean, &deviation)
            .expect("moments of finite numbers are finite and the deviation has a floor")
    }
}
