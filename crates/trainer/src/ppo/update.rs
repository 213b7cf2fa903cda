//! Gradient steps of PPO. A minibatch is split into a fixed number of lanes whose gradients are summed in order, so
//! that the result does not depend on the number of threads.

use rayon::prelude::*;

use super::gaussian::{kl_divergence, log_probability};
use super::learner::{Actor, Learner, line_of};
use super::rollout::Rollout;
use crate::nn::{Network, Pass, clip_norm};

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

/// One share of a minibatch: gathered rows, passes, gradients.
#[derive(Clone, Debug)]
pub(super) struct Lane {
    actor: Pass,
    critic: Pass,
    input: Vec<f32>,
    critic_input: Vec<f32>,
    blend: Vec<f32>,
    /// Rows of each edge.
    groups: Vec<Vec<u32>>,
    /// One for each actor.
    actor_gradients: Vec<Vec<f32>>,
    critic_gradient: Vec<f32>,
    /// Divergence and weight of the rows of each actor.
    divergence: Vec<[f32; 2]>,
    sums: UpdateReport,
}

impl Lane {
    /// Shares of a minibatch.
    pub(super) const COUNT: usize = 4;

    pub(super) fn new((actors, edges): (&[Actor], &[[usize; 2]]), critic: &Network, rows: usize) -> Self {
        let actor = &actors[0].network;
        Self {
            actor: Pass::new(actor.sizes(), rows),
            critic: Pass::new(critic.sizes(), rows),
            input: Vec::with_capacity(rows * actor.inputs()),
            critic_input: vec![0.0; rows * critic.inputs()],
            blend: Vec::with_capacity(rows),
            groups: vec![Vec::new(); edges.len()],
            actor_gradients: vec![vec![0.0; actor.parameters.len()]; actors.len()],
            critic_gradient: vec![0.0; critic.parameters.len()],
            divergence: vec![[0.0; 2]; actors.len()],
            sums: UpdateReport::default(),
        }
    }

    fn accumulate(&mut self, shared: &Shared<'_>, rows: &[u32]) {
        self.actor_gradients.iter_mut().for_each(|g| g.fill(0.0));
        self.critic_gradient.fill(0.0);
        self.divergence.fill([0.0; 2]);
        self.sums = UpdateReport::default();
        self.groups.iter_mut().for_each(Vec::clear);
        for row in rows {
            self.groups[shared.rollout.edge[*row as usize]].push(*row);
        }
        for edge in 0..self.groups.len() {
            self.actor_step(shared, edge);
        }
        self.critic_step(shared, rows);
    }

    /// Gradients of the rows of one edge.
    fn actor_step(&mut self, shared: &Shared<'_>, edge: usize) {
        let rows = &self.groups[edge];
        if rows.is_empty() {
            return;
        }
        let [from, to] = shared.edges[edge];
        let inputs = shared.actors[to].network.inputs();
        self.input.clear();
        self.blend.clear();
        for row in rows.iter().map(|r| *r as usize) {
            self.input.extend_from_slice(&shared.rollout.inputs[row * inputs..(row + 1) * inputs]);
            self.blend.push(shared.rollout.blend[row]);
        }
        let (network, line) = line_of(shared.actors, [from, to], &self.blend);
        self.actor.forward(network, line, &self.input);
        let actions = network.outputs();
        let (means, deltas) = self.actor.output_and_delta(rows.len());
        let pairs = means.chunks_exact(actions).zip(deltas.chunks_exact_mut(actions));
        for ((row, t), (mean, delta)) in rows.iter().zip(&self.blend).zip(pairs) {
            let kl = shared.policy_gradient(*row as usize, mean, delta, &mut self.sums);
            let t = if from == to { 1.0 } else { *t };
            for (actor, weight) in [(from, 1.0 - t), (to, t)] {
                self.divergence[actor][0] += weight * kl;
                self.divergence[actor][1] += weight;
            }
        }
        let (gradient, parent) = match self.actor_gradients.get_disjoint_mut([from, to]) {
            Ok([parent, gradient]) => (gradient, Some(parent).filter(|_| !shared.actors[from].frozen)),
            Err(_) => (&mut self.actor_gradients[to], None),
        };
        self.actor.backward(network, line, &self.input, gradient, parent.map(Vec::as_mut_slice));
    }

    fn critic_step(&mut self, shared: &Shared<'_>, rows: &[u32]) {
        let inputs = shared.critic.inputs();
        for (row, to) in rows.iter().map(|r| *r as usize).zip(self.critic_input.chunks_exact_mut(inputs)) {
            to.copy_from_slice(&shared.rollout.critic_inputs[row * inputs..(row + 1) * inputs]);
        }
        let input = &self.critic_input[..rows.len() * inputs];
        self.critic.forward(shared.critic, None, input);
        let (values, deltas) = self.critic.output_and_delta(rows.len());
        for (row, (value, delta)) in rows.iter().zip(values.iter().zip(deltas)) {
            let error = value - shared.rollout.returns[*row as usize] * (1.0 - shared.gamma);
            self.sums.value_error += error * error;
            *delta = error * shared.scale;
        }
        self.critic.backward(shared.critic, None, input, &mut self.critic_gradient, None);
    }
}

/// What all lanes of a gradient step read.
struct Shared<'a> {
    rollout: &'a Rollout,
    actors: &'a [Actor],
    edges: &'a [[usize; 2]],
    critic: &'a Network,
    gamma: f32,
    clip: f32,
    deviation: f32,
    bound_penalty: f32,
    scale: f32,
}

impl Shared<'_> {
    /// Gradient of the clipped surrogate (PPO, equation 7) and of the bound by the mean action of one row; returns the
    /// row's divergence.
    fn policy_gradient(&self, row: usize, mean: &[f32], delta: &mut [f32], sums: &mut UpdateReport) -> f32 {
        let numbers = row * mean.len()..(row + 1) * mean.len();
        let (action, acted) = (&self.rollout.actions[numbers.clone()], &self.rollout.means[numbers]);
        let now = log_probability(action, mean, self.deviation);
        let ratio = (now - log_probability(action, acted, self.deviation)).clamp(-20.0, 20.0).exp();
        let advantage = self.rollout.advantages[row];
        let stopped = if advantage > 0.0 { ratio > 1.0 + self.clip } else { ratio < 1.0 - self.clip };
        let kl = kl_divergence(mean, acted, self.deviation);
        sums.kl += kl;
        sums.clipped += f32::from(u8::from((ratio - 1.0).abs() > self.clip));
        let slope = if stopped { 0.0 } else { -advantage * ratio / (self.deviation * self.deviation) };
        for ((d, m), a) in delta.iter_mut().zip(mean).zip(action) {
            let excess = (m.abs() - 1.0).max(0.0).copysign(*m);
            *d = (slope * (a - m) + 2.0 * self.bound_penalty * excess) * self.scale;
        }
        kl
    }
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
            if kl > 1.5 * config.target_kl {
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
