//! Gradient steps of PPO. A minibatch is split into a fixed number of lanes whose gradients are summed in order, so
//! that the result does not depend on the number of threads.

use rayon::prelude::*;

use super::lane::{Lane, Shared};
use super::learner::{Actor, Learner};
use super::rollout::Rollout;
use crate::nn::clip_norm;

/// Means over the rows of all gradient steps of one update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UpdateReport {
    /// Divergence of the policy from the one that acted.
    pub kl: f32,
    /// Squared error of the critic, in scaled returns.
    pub value_error: f32,
    /// Share of rows whose ratio left the clip range.
    pub clipped: f32,
    /// Largest norm of an actor's gradient before clipping.
    pub gradient_norm: f32,
}

impl Learner {
    /// Takes the gradient steps of all epochs and steers each actor's rate by the divergence of its rows that they cause.
    pub fn update(&mut self, rollout: &Rollout) -> UpdateReport {
        let rows = u32::try_from(rollout.rows()).expect("a rollout has fewer than 2^32 rows");
        self.order.clear();
        self.order.extend(0..rows);
        let mut total = UpdateReport::default();
        let mut steps = 0.0;
        self.divergence.fill([0.0; 2]);
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
                        for (sum, more) in self.divergence.iter_mut().zip(&lane.divergence) {
                            *sum = [sum[0] + more[0], sum[1] + more[1]];
                        }
                    }
                }
                total.kl += report.kl;
                total.value_error += report.value_error;
                total.clipped += report.clipped;
                total.gradient_norm += report.gradient_norm;
                steps += 1.0;
            }
            self.order = order;
        }
        self.steer_rates();
        self.average();
        for value in [&mut total.kl, &mut total.value_error, &mut total.clipped, &mut total.gradient_norm] {
            *value /= steps;
        }
        total
    }

    fn gradient_step(&mut self, rollout: &Rollout, minibatch: &[u32]) -> UpdateReport {
        let shared = Shared {
            rollout,
            actors: &self.actors,
            edges: &self.edges,
            critic: &self.critic,
            gamma: self.config.gamma,
            clip: self.config.clip,
            deviation: self.config.deviation,
            bound_penalty: self.config.bound_penalty,
            guide: if rollout.guides.is_empty() { 0.0 } else { self.config.guide },
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
            let Actor { network, adam, frozen, rate, .. } = &mut self.actors[index];
            if !*frozen {
                let norm = clip_norm(gradient, self.config.gradient_norm);
                report.gradient_norm = report.gradient_norm.max(norm);
                adam.step(&mut network.parameters, gradient, *rate, 0.0);
            }
        }
        clip_norm(&mut first.critic_gradient, self.config.gradient_norm);
        let rate = self.config.critic_rate;
        self.critic_adam.step(&mut self.critic.parameters, &first.critic_gradient, rate, 0.0);
        report
    }

    fn used_lanes(&self, rows: usize) -> usize {
        rows.div_ceil(rows.div_ceil(Lane::COUNT))
    }

    /// Steers the rate of every actor that had rows by their mean divergence.
    fn steer_rates(&mut self) {
        let config = &self.config;
        for (actor, [sum, weight]) in self.actors.iter_mut().zip(&self.divergence) {
            let kl = sum / weight;
            if config.guide > 0.0 {
                actor.rate = config.most_actor_rate;
            } else if kl > 1.5 * config.target_kl {
                actor.rate /= 1.3;
            } else if kl < config.target_kl / 1.5 {
                actor.rate *= 1.3;
            }
            actor.rate = actor.rate.clamp(config.least_actor_rate, config.most_actor_rate);
        }
    }
}

impl UpdateReport {
    fn add(&mut self, other: &UpdateReport) {
        self.kl += other.kl;
        self.value_error += other.value_error;
        self.clipped += other.clipped;
    }

    fn scale(&mut self, by: f32) {
        self.kl *= by;
        self.value_error *= by;
        self.clipped *= by;
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
