//! What comes between a controller and its motors: a late tick, noise.

use policy_core::JointTargets;
use policy_core::training::ActionScaling;

use random::Rng;

/// Latency and noise on the way from the controller to the motors; none by default.
#[derive(Clone, Debug, Default)]
pub struct Disturbance {
    late: Option<JointTargets>,
    noise: Option<Noise>,
}

/// Noise on every action.
#[derive(Clone, Debug)]
struct Noise {
    /// Standard deviation of each joint target, radians.
    deviations: Vec<f32>,
    rng: Rng,
}

impl Disturbance {
    /// Joint targets come one tick late; the first ones are `targets`.
    #[must_use]
    pub fn late(mut self, targets: &JointTargets) -> Self {
        self.late = Some(targets.clone());
        self
    }

    /// Normal noise with a standard deviation of `deviation` on every action, in the policy's own scale.
    #[must_use]
    pub fn noisy(mut self, scaling: &ActionScaling, deviation: f32, rng: Rng) -> Self {
        let deviations = scaling.gain().iter().map(|gain| deviation * gain).collect();
        self.noise = Some(Noise { deviations, rng });
        self
    }

    /// Changes what the controller wants into what the motors get.
    pub fn apply(&mut self, targets: &mut JointTargets) {
        if let Some(Noise { deviations, rng }) = &mut self.noise {
            targets.iter_mut().zip(deviations).for_each(|(target, by)| *target += *by * rng.normal());
        }
        if let Some(late) = &mut self.late {
            core::mem::swap(late, targets);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets(value: f32) -> JointTargets {
        JointTargets::from(vec![value; 2])
    }

    #[test]
    fn late_targets_come_a_tick_later() {
        let mut late = Disturbance::default().late(&targets(0.0));
        for value in 1..5 {
            let mut now = targets(value as f32);
            late.apply(&mut now);
            assert_eq!(now, targets(value as f32 - 1.0));
        }
    }

    #[test]
    fn noise_is_scaled_by_the_gain_of_the_joint() {
        let scaling = ActionScaling::from_centre_and_gain(&[0.3, 0.3], &[2.0, 1.0]).unwrap();
        let mut noise = Disturbance::default().noisy(&scaling, 0.1, Rng::new(1, 2));
        let mut squares = [0.0_f64; 2];
        for _ in 0..4000 {
            let mut now = targets(0.0);
            noise.apply(&mut now);
            squares.iter_mut().zip(now.iter()).for_each(|(sum, n)| *sum += f64::from(n * n));
        }
        let deviation = |joint: usize| (squares[joint] / 4000.0).sqrt();
        assert!((deviation(0) - 0.2).abs() < 0.01 && (deviation(1) - 0.1).abs() < 0.005);
    }
}
