//! Gradient steps of PPO. A minibatch is split into a fixed number of lanes whose gradients are summed in order, so
//! that the result does not depend on the number of threads.

use rayon::prelude::*;

use super::config::{CRITIC_LEARNING_RATE, MAX_GRAD_NORM};
use super::lane::{Lane, Shared};
use super::learner::{Actor, Learner};
use super::rollout::Rollout;
use crate::nn::clip_norm;

/// Means over the rows of all gradient steps of one update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UpdateReport {
    /// KL divergence of the policy from the one that acted.
    pub kl: f32,
    /// Squared error of the critic, in scaled returns.
    pub value_error: f32,
    /// Share of rows whose ratio left the clip range.
    pub clipped: f32,
    /// Root of the mean squared distance between an action and the mirror image of that in the mirrored state, over all
    /// joints; zero without a symmetry loss.
    pub asymmetry: f32,
    /// Largest norm of an actor's gradient before clipping.
    pub grad_norm: f32,
}

impl Learner {
    /// Takes the gradient steps of all epochs. Adapts each actor's learning rate by the KL divergence of its rows.
    pub fn update(&mut self, rollout: &Rollout) -> UpdateReport {
        let rows = u32::try_from(rollout.rows()).expect("a rollout has fewer than 2^32 rows");
        self.order.clear();
        self.order.extend(0..rows);
        let mut total = UpdateReport::default();
        let mut steps = 0.0;
        self.kl.fill([0.0; 2]);
        for epoch in 0..self.config.epochs {
            for i in (1..self.order.len()).rev() {
                let other = self.rng.index(i + 1);
                self.order.swap(i, other);
            }
            let order = std::mem::take(&mut self.order);
            for minibatch in order.chunks(self.config.minibatch) {
                let report = self.gradient_step(rollout, minibatch);
                if epoch + 1 == self.config.epochs {
                    for lane in &self.lanes[..self.used_lanes(minibatch.len())] {
                        for (sum, more) in self.kl.iter_mut().zip(&lane.kl) {
                            *sum = [sum[0] + more[0], sum[1] + more[1]];
                        }
                    }
                }
                total.kl += report.kl;
                total.value_error += report.value_error;
                total.clipped += report.clipped;
                total.asymmetry += report.asymmetry;
                total.grad_norm += report.grad_norm;
                steps += 1.0;
            }
            self.order = order;
        }
        self.adapt_learning_rates();
        self.update_ema();
        let UpdateReport { kl, value_error, clipped, asymmetry, grad_norm } = &mut total;
        for value in [kl, value_error, clipped, asymmetry, grad_norm] {
            *value /= steps;
        }
        total.asymmetry = (total.asymmetry / self.actor().outputs() as f32).sqrt();
        total
    }

    fn gradient_step(&mut self, rollout: &Rollout, minibatch: &[u32]) -> UpdateReport {
        let shared = Shared {
            rollout,
            actors: &self.actors,
            edges: &self.edges,
            critic: &self.critic,
            gamma: self.config.gamma,
            action_std: self.config.action_std,
            behaviour_cloning: if rollout.cloning_targets.is_empty() {
                0.0
            } else {
                self.config.cloning_weight()
            },
            ignores_rewards: self.config.symmetrise,
            mirror: self.mirror.as_ref().map(|m| (m, self.config.symmetry)).filter(|(_, w)| *w > 0.0),
            scale: 1.0 / minibatch.len() as f32,
        };
        let share = minibatch.len().div_ceil(Lane::COUNT);
        let used = self.used_lanes(minibatch.len());
        self.lanes[..used]
            .par_iter_mut()
            .zip(minibatch.par_chunks(share))
            .for_each(|(lane, rows)| lane.accumulate(&shared, rows));
        let mut report = UpdateReport::default();
        let (first, others) = self.lanes[..used].split_first_mut().expect("a minibatch has a lane");
        report.add(&first.sums);
        for lane in others {
            report.add(&lane.sums);
            for (sum, more) in first.actor_gradients.iter_mut().zip(&lane.actor_gradients) {
                add(sum, more);
            }
            add(&mut first.critic_gradient, &lane.critic_gradient);
        }
        report.scale(1.0 / minibatch.len() as f32);
        for (index, gradient) in first.actor_gradients.iter_mut().enumerate() {
            pull_to_parent(&self.actors, index, self.config.regularisation, gradient);
            let Actor { network, adam, frozen, learning_rate, .. } = &mut self.actors[index];
            if !*frozen {
                let norm = clip_norm(gradient, MAX_GRAD_NORM);
                report.grad_norm = report.grad_norm.max(norm);
                adam.step(&mut network.parameters, gradient, *learning_rate, 0.0);
            }
        }
        clip_norm(&mut first.critic_gradient, MAX_GRAD_NORM);
        let parameters = &mut self.critic.parameters;
        self.critic_adam.step(parameters, &first.critic_gradient, CRITIC_LEARNING_RATE, 0.0);
        report
    }

    fn used_lanes(&self, rows: usize) -> usize {
        rows.div_ceil(rows.div_ceil(Lane::COUNT))
    }

    /// Adapts the learning rate of every actor that had rows to their mean KL divergence.
    fn adapt_learning_rates(&mut self) {
        let config = &self.config;
        for (actor, [sum, weight]) in self.actors.iter_mut().zip(&self.kl) {
            let kl = sum / weight;
            if config.cloning_weight() > 0.0 {
                actor.learning_rate = config.max_learning_rate;
            } else if kl > 1.5 * config.target_kl {
                actor.learning_rate /= 1.3;
            } else if kl < config.target_kl / 1.5 {
                actor.learning_rate *= 1.3;
            }
            actor.learning_rate =
                actor.learning_rate.clamp(config.min_learning_rate, config.max_learning_rate);
        }
    }
}

impl UpdateReport {
    fn add(&mut self, other: &UpdateReport) {
        self.kl += other.kl;
        self.value_error += other.value_error;
        self.clipped += other.clipped;
        self.asymmetry += other.asymmetry;
    }

    fn scale(&mut self, by: f32) {
        self.kl *= by;
        self.value_error *= by;
        self.clipped *= by;
        self.asymmetry *= by;
    }
}

/// Adds the gradient of `lambda |w - w_parent|^2`.
fn pull_to_parent(actors: &[Actor], index: usize, lambda: f32, gradient: &mut [f32]) {
    let Some(parent) = actors[index].parent else { return };
    let pairs = actors[index].network.parameters.iter().zip(&actors[parent].network.parameters);
    for (g, (w, p)) in gradient.iter_mut().zip(pairs) {
        *g += 2.0 * lambda * (w - p);
    }
}

fn add(to: &mut [f32], from: &[f32]) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
}

#[cfg(test)]
#[path = "update_tests.rs"]
mod tests;
