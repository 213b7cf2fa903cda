//! Means of checkpoints. Policies of one run some million samples apart are as good as each other and err in different
//! ways; their mean errs less (stochastic weight averaging, Izmailov et al. 2018).

use std::path::PathBuf;

use crate::checkpoint::{ACTOR, Checkpoint, CheckpointError, EMA};
use crate::nn::Network;

/// The first checkpoint with every policy, and its moving average, replaced by the mean of the moving averages of all; policies
/// whose role begins with one of `except` and a dot stay as they are in the first. Paths are named in errors.
///
/// # Errors
/// When a policy is missing in a checkpoint or has other sizes there.
///
/// # Panics
/// When there is no checkpoint.
pub fn average(
    checkpoints: &[(Checkpoint, PathBuf)],
    except: &[String],
) -> Result<Checkpoint, CheckpointError> {
    let mut mean = checkpoints.first().expect("a checkpoint to average").0.clone();
    let is_kept =
        |role: &str| except.iter().any(|e| role.split_once('.').is_some_and(|(skill, _)| skill == e));
    let roles: Vec<String> =
        mean.networks.keys().filter(|role| role.ends_with(ACTOR) && !is_kept(role)).cloned().collect();
    for role in roles {
        let ema = format!("{}{EMA}", role.strip_suffix(ACTOR).unwrap_or_default());
        let mut sum = vec![0.0_f64; mean.networks[&role].network.parameters.len()];
        for (checkpoint, path) in checkpoints {
            let network = match checkpoint.networks.get(&ema) {
                Some(trained) => &trained.network,
                None => &checkpoint.network(&role, path)?.network,
            };
            let sizes = mean.networks[&role].network.sizes();
            if network.sizes() != sizes {
                return Err(CheckpointError::Content {
                    path: path.clone(),
                    expected: format!("a {role} of sizes {sizes:?}"),
                    found: format!("{:?}", network.sizes()),
                });
            }
            sum.iter_mut().zip(&network.parameters).for_each(|(sum, p)| *sum += f64::from(*p));
        }
        let count = checkpoints.len() as f64;
        let set = |network: &mut Network| {
            network.parameters.iter_mut().zip(&sum).for_each(|(p, sum)| *p = (sum / count) as f32);
        };
        for role in [&role, &ema] {
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
        let mean = average(&all, &["b".to_owned()]).unwrap();
        let first = |role: &str| mean.networks[role].network.parameters[0];
        assert_eq!(["a.actor", "a.ema", "b.actor", "critic"].map(first), [2.0, 2.0, 5.0, 7.0]);
        assert_eq!(average(&all, &[]).unwrap().networks["b.actor"].network.parameters[0], 5.5);
    }

    #[test]
    fn policies_that_are_missing_or_of_other_sizes_are_named() {
        let one = of(&[("a.actor", 1.0)], 3);
        let missing = average(&[one.clone(), of(&[("b.actor", 1.0)], 3)], &[]).unwrap_err();
        assert!(missing.to_string().contains("a.actor"), "{missing}");
        let other = average(&[one, of(&[("a.actor", 1.0)], 4)], &[]).unwrap_err();
        assert!(other.to_string().contains("[4, 2]"), "{other}");
    }
}
