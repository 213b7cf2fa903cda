//! What a run takes over from a checkpoint.

use std::collections::HashMap;
use std::path::Path;

use anyhow::{Result, bail};

use crate::checkpoint::{
    ACTOR, CRITIC, Checkpoint, DISCRIMINATOR, EMA, PARENT_DISCRIMINATOR, Progress, TEACHER,
};
use crate::nn::Adam;
use crate::pack::TrainedSkill;
use crate::training::Training;

/// One skill of a run that trained it together with others: its policy, or the moving average of it, and its discriminator.
/// The critic stays behind, because a run of one skill asks it other things. Any other checkpoint stays as it is.
pub(super) fn skill_alone(mut checkpoint: Checkpoint, skill: &str) -> Checkpoint {
    if !TrainedSkill::is_in(skill, &checkpoint) {
        return checkpoint;
    }
    let mut take = |role: &str| checkpoint.networks.remove(&format!("{skill}.{role}"));
    let ema = take(EMA);
    let alone = [(ACTOR, ema.or_else(|| take(ACTOR))), (DISCRIMINATOR, take(DISCRIMINATOR))];
    let mut networks: HashMap<_, _> =
        alone.into_iter().filter_map(|(role, trained)| Some((role.to_owned(), trained?))).collect();
    for trained in networks.values_mut() {
        trained.adam = Adam::new(trained.network.parameters.len());
    }
    let p = &checkpoint.progress;
    Checkpoint::new(networks, (p.seed, p.samples, p.secs), p.learning_rate, p.rng)
}

/// Puts a checkpoint's networks into a training that `begins` with them, or continues; returns the seconds spent before.
pub(super) fn restore(
    training: &mut Training,
    checkpoint: &Checkpoint,
    path: &Path,
    begins: bool,
) -> Result<f64> {
    if !begins && checkpoint.networks.contains_key(TEACHER) {
        training.learner.teacher = Some(training.learner.actor().clone());
    }
    for (role, network, adam) in training.networks_mut() {
        // Discriminators of a parent or half-way can be learned anew, and the critic of a run that begins; a moving average
        // begins where its policy is.
        let actor = role.strip_suffix(EMA).map(|before| format!("{before}{ACTOR}"));
        let known = checkpoint.networks.contains_key(&role);
        let optional = role == PARENT_DISCRIMINATOR || role.contains('-') || (role == CRITIC && begins);
        if optional && !known {
            continue;
        }
        let trained = checkpoint.network(actor.filter(|_| !known).as_deref().unwrap_or(&role), path)?;
        if trained.network.sizes() != network.sizes() {
            bail!(
                "{}: expected a {role} of sizes {:?}, found {:?}",
                path.display(),
                network.sizes(),
                trained.network.sizes()
            );
        }
        network.clone_from(&trained.network);
        if let Some(adam) = adam {
            adam.clone_from(&trained.adam);
        }
    }
    training.samples = checkpoint.progress.samples;
    let Progress { learning_rate, learning_rates, rng, secs, .. } = &checkpoint.progress;
    if begins {
        // A run of its own: the recipe's learning rate, and random numbers of its own seed.
        let phase = training.recipe.phase_at(training.samples);
        let learning_rate = training.recipe.phases[phase].ppo.learning_rate;
        training.learning_rates_mut().into_iter().for_each(|(_, rate)| *rate = learning_rate);
    } else {
        for (role, rate) in training.learning_rates_mut() {
            *rate = *learning_rates.get(&role).unwrap_or(learning_rate);
        }
        training.learner.rng = *rng;
    }
    Ok(*secs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkpoint::Trained;
    use crate::nn::Network;

    #[test]
    fn a_skill_alone_can_be_trained_on() {
        let trained = || {
            let network = Network::zeros(&[3, 2, 1]);
            let adam = Adam { steps: 7, ..Adam::new(network.parameters.len()) };
            Trained { network, adam }
        };
        let roles = ["walk.actor", "walk.discriminator", "idle.actor", "critic"];
        let networks = roles.map(|role| (role.to_owned(), trained())).into();
        let rng = random::Rng::new(1, 1);
        let alone = skill_alone(Checkpoint::new(networks, (1, 10, 1.0), 1e-4, rng), "walk");
        let mut found: Vec<_> = alone.networks.keys().map(String::as_str).collect();
        found.sort_unstable();
        assert_eq!(found, [ACTOR, DISCRIMINATOR]);
        for Trained { mut network, mut adam } in alone.networks.into_values() {
            assert_eq!(adam.steps, 0, "Adam begins anew");
            let gradient = vec![1.0; network.parameters.len()];
            adam.step(&mut network.parameters, &gradient, 0.1, 0.0);
        }
    }
}
