//! A diagonal normal distribution of one fixed action_std: all that this PPO knows of action distributions.

/// Logarithm of the density of `action` under mean `mean` and the given action_std of every entry.
#[must_use]
pub fn log_probability(action: &[f32], mean: &[f32], action_std: f32) -> f32 {
    let square: f32 = action.iter().zip(mean).map(|(a, m)| ((a - m) / action_std).powi(2)).sum();
    let normaliser = action_std.ln() + 0.5 * std::f32::consts::TAU.ln();
    -0.5 * square - action.len() as f32 * normaliser
}

/// Kullback-Leibler kl between two such distributions of equal action_std.
#[must_use]
pub fn kl_divergence(mean: &[f32], other: &[f32], action_std: f32) -> f32 {
    mean.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f32>() / (2.0 * action_std * action_std)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_has_its_closed_form() {
        // One standard normal number at 1: exp(-1/2) / sqrt(2 pi).
        let expected = (-0.5_f32).exp() / std::f32::consts::TAU.sqrt();
        assert!((log_probability(&[1.0], &[0.0], 1.0).exp() - expected).abs() < 1e-6);
        // Independent entries multiply, and a action_std scales the density.
        let two = log_probability(&[0.3, -0.2], &[0.1, 0.1], 0.5);
        let each = log_probability(&[0.3], &[0.1], 0.5) + log_probability(&[-0.2], &[0.1], 0.5);
        assert!((two - each).abs() < 1e-5);
        let widened = log_probability(&[0.5], &[0.0], 0.5) - log_probability(&[1.0], &[0.0], 1.0);
        assert!((widened - 2.0_f32.ln()).abs() < 1e-6);
    }

    #[test]
    fn divergence_is_the_mean_difference_of_log_densities() {
        let (p, q, s) = ([0.2, -0.1], [0.05, 0.3], 0.4);
        let mut rng = random::Rng::new(4, 0);
        let n = 100_000;
        let mut total = 0.0_f64;
        for _ in 0..n {
            let a = [p[0] + s * rng.normal(), p[1] + s * rng.normal()];
            total += f64::from(log_probability(&a, &p, s) - log_probability(&a, &q, s));
        }
        let found = total / f64::from(n);
        assert!((found - f64::from(kl_divergence(&p, &q, s))).abs() < 0.01, "{found}");
    }
}
