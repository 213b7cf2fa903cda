//! Means of checkpoints. Policies of one run some million samples apart are as good as each other and err in different
//! ways; their mean errs less (stochastic weight averaging, Izmailov et al. 2018).

use std::path::PathBuf;

use crate::checkpoint::{ACTOR, Checkpoint, CheckpointError, EMA};
use crate::nn::Network;
use crate::posture::Posture;

/// What checkpoints are averaged with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Averaging<'a> {
    /// Weight of each checkpoint; equal ones by default. One below zero leads away from that checkpoint: a policy that has learned on from
    /// another goes further that way.
    pub weights: &'a [f64],
    /// Skills whose policies stay as they are in the first checkpoint.
    pub except: &'a [String],
    /// Skill whose policy a checkpoint gives that trained several skills together, where the first one trained a skill alone.
    pub policy: Option<&'a str>,
    /// Offsets that the means get.
    pub posture: Option<&'a Posture>,
}

impl Averaging<'_> {
    /// Refuses what does not fit so many checkpoints, with what was expected and what was found.
    ///
    /// # Errors
    /// When there are fewer than two, or the weights are not as many or do not add up to 1.
    pub fn check(&self, checkpoints: usize) -> Result<(), [String; 2]> {
        if checkpoints < 2 {
            return Err(["at least two to average".into(), checkpoints.to_string()]);
        }
        let sum: f64 = self.weights.iter().sum();
        let fits = self.weights.len() == checkpoints && (sum - 1.0).abs() < 1e-6;
        if !self.weights.is_empty() && !fits {
            let found = format!("{:?}, which add up to {sum}", self.weights);
            return Err([format!("{checkpoints} weights that add up to 1"), found]);
        }
        Ok(())
    }

    /// Whether a role's policy stays as it is in the first checkpoint.
    fn keeps(&self, role: &str) -> bool {
        self.except.iter().any(|e| role.split_once('.').is_some_and(|(skill, _)| skill == e))
    }

    /// The policy that stands for `role` in a checkpoint: its moving average, where it has one.
    fn policy_in<'c>(
        &self,
        (checkpoint, path): &'c (Checkpoint, PathBuf),
        role: &str,
    ) -> Result<&'c Network, CheckpointError> {
        let alone = role == ACTOR && !checkpoint.networks.contains_key(ACTOR);
        let role = match self.policy {
            Some(skill) if alone => format!("{skill}.{ACTOR}"),
            _ => role.to_owned(),
        };
        match checkpoint.networks.get(&moving_average(&role)) {
            Some(trained) => Ok(&trained.network),
            None => Ok(&checkpoint.network(&role, path)?.network),
        }
    }
}

/// Role of the moving average of a policy.
fn moving_average(role: &str) -> String {
    format!("{}{EMA}", role.strip_suffix(ACTOR).unwrap_or_default())
}

/// The first checkpoint with every policy, and its moving average, replaced by the mean of the moving averages of all. Paths are named in
/// errors.
///
/// # Errors
/// When a policy is missing in a checkpoint or has other sizes there.
///
/// # Panics
/// When there is no checkpoint.
pub fn average(
    checkpoints: &[(Checkpoint, PathBuf)],
    averaging: Averaging<'_>,
) -> Result<Checkpoint, CheckpointError> {
    let mut mean = checkpoints.first().expect("a checkpoint to average").0.clone();
    let averaged = |role: &&String| role.ends_with(ACTOR) && !averaging.keeps(role);
    let roles: Vec<String> = mean.networks.keys().filter(averaged).cloned().collect();
    let total = if averaging.weights.is_empty() { checkpoints.len() as f64 } else { 1.0 };
    for role in roles {
        let mut sum = vec![0.0_f64; mean.networks[&role].network.parameters.len()];
        let weights = averaging.weights.iter().copied().chain(std::iter::repeat(1.0));
        for (checkpoint, weight) in checkpoints.iter().zip(weights) {
            let network = averaging.policy_in(checkpoint, &role)?;
            let sizes = mean.networks[&role].network.sizes();
            if network.sizes() != sizes {
                return Err(CheckpointError::Content {
                    path: checkpoint.1.clone(),
                    expected: format!("a {role} of sizes {sizes:?}"),
                    found: format!("{:?}", network.sizes()),
                });
            }
            sum.iter_mut().zip(&network.parameters).for_each(|(sum, p)| *sum += weight * f64::from(*p));
        }
        let mut mean_of_role: Vec<f64> = sum.iter().map(|sum| sum / total).collect();
        if let Some(posture) = averaging.posture {
            posture.apply(&mut mean_of_role);
        }
        let set = |network: &mut Network| {
            network.parameters.iter_mut().zip(&mean_of_role).for_each(|(p, mean)| *p = *mean as f32);
        };
        for role in [&role, &moving_average(&role)] {
            if let Some(trained) = mean.networks.get_mut(role) {
                set(&mut trained.network);
            }
        }
    }
    Ok(mean)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::checkpoint::Trained;
    use crate::nn::Adam;
    use random::Rng;

    fn of(values: &[(&str, f32)], inputs: usize) -> (Checkpoint, PathBuf) {
        let network = |value: f32| {
            let mut network = Network::zeros(&[inputs, 2]);
            network.parameters.fill(value);
            let adam = Adam::new(network.parameters.len());
            Trained { network, adam }
        };
        let networks: HashMap<_, _> =
            values.iter().map(|(role, value)| ((*role).to_owned(), network(*value))).collect();
        (Checkpoint::new(networks, (1, 2, 3.0), 1e-4, Rng::new(1, 1)), "x".into())
    }

    #[test]
    fn policies_become_the_mean_of_the_moving_averages() {
        let all = [
            of(&[("a.actor", 9.0), ("a.ema", 1.0), ("b.actor", 5.0), ("critic", 7.0)], 3),
            of(&[("a.actor", 8.0), ("a.ema", 3.0), ("b.actor", 6.0), ("critic", 8.0)], 3),
        ];
        let mean = average(&all, Averaging { except: &["b".into()], ..Averaging::default() }).unwrap();
        let first = |role: &str| mean.networks[role].network.parameters[0];
        assert_eq!(["a.actor", "a.ema", "b.actor", "critic"].map(first), [2.0, 2.0, 5.0, 7.0]);
        assert_eq!(
            average(&all, Averaging::default()).unwrap().networks["b.actor"].network.parameters[0],
            5.5
        );
    }

    #[test]
    fn a_policy_of_several_stands_in_for_one_alone() {
        let alone = of(&[("actor", 1.0), ("ema", 2.0)], 3);
        let several = of(&[("a.actor", 5.0), ("b.actor", 6.0), ("b.ema", 8.0)], 3);
        let all = [alone, several];
        let first = |policy: Option<&str>, weights: &[f64]| {
            let averaging = Averaging { policy, weights, ..Averaging::default() };
            average(&all, averaging).map(|mean| mean.networks["ema"].network.parameters[0])
        };
        assert_eq!(first(Some("b"), &[]).unwrap(), 5.0);
        assert_eq!(first(Some("a"), &[0.75, 0.25]).unwrap(), 2.75);
        assert_eq!(first(Some("b"), &[1.25, -0.25]).unwrap(), 0.5);
        for (policy, named) in [(None, "actor"), (Some("c"), "c.actor")] {
            let error = first(policy, &[]).unwrap_err().to_string();
            assert!(error.contains(named), "{error}");
        }
    }

    #[test]
    fn weights_are_one_for_each_and_add_up_to_one() {
        let check = |weights: &[f64], count| Averaging { weights, ..Averaging::default() }.check(count);
        assert_eq!(check(&[], 2), Ok(()));
        assert_eq!(check(&[1.15, -0.15], 2), Ok(()));
        assert_eq!(check(&[], 1).unwrap_err(), ["at least two to average", "1"]);
        for (weights, count) in [(&[0.5, 0.5][..], 3), (&[0.5, 0.6], 2), (&[f64::NAN, 1.0], 2)] {
            let [expected, found] = check(weights, count).unwrap_err();
            assert_eq!(expected, format!("{count} weights that add up to 1"));
            assert!(found.contains(&format!("{weights:?}")), "{found}");
        }
    }

    #[test]
    fn policies_that_are_missing_or_of_other_sizes_are_named() {
        let one = of(&[("a.actor", 1.0)], 3);
        let missing = average(&[one.clone(), of(&[("b.actor", 1.0)], 3)], Averaging::default()).unwrap_err();
        assert!(missing.to_string().contains("a.actor"), "{missing}");
        let other = average(&[one, of(&[("a.actor", 1.0)], 4)], Averaging::default()).unwrap_err();
        assert!(other.to_string().contains("[4, 2]"), "{other}");
    }
}
