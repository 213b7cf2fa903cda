//! One share of a minibatch: its rows, gathered edge by edge, and the gradients they give.

use super::config::{BOUND_PENALTY, CLIP};
use super::gaussian::{kl_divergence, log_probability};
use super::learner::{Actor, line_of};
use super::mirror::Mirror;
use super::rollout::Rollout;
use super::update::UpdateReport;
use crate::nn::{Network, Pass};

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
    pub(super) actor_gradients: Vec<Vec<f32>>,
    pub(super) critic_gradient: Vec<f32>,
    /// KL divergence and weight of the rows of each actor.
    pub(super) kl: Vec<[f32; 2]>,
    pub(super) sums: UpdateReport,
}

impl Lane {
    /// Shares of a minibatch.
    pub(super) const COUNT: usize = 4;

    pub(super) fn new((actors, edges): (&[Actor], &[[usize; 2]]), critic: &Network, rows: usize) -> Self {
        let actor = &actors[0].network;
        Self {
            // Each row once more in the mirror.
            actor: Pass::new(actor.sizes(), 2 * rows),
            critic: Pass::new(critic.sizes(), rows),
            input: Vec::with_capacity(2 * rows * actor.inputs()),
            critic_input: vec![0.0; rows * critic.inputs()],
            blend: Vec::with_capacity(2 * rows),
            groups: vec![Vec::new(); edges.len()],
            actor_gradients: vec![vec![0.0; actor.parameters.len()]; actors.len()],
            critic_gradient: vec![0.0; critic.parameters.len()],
            kl: vec![[0.0; 2]; actors.len()],
            sums: UpdateReport::default(),
        }
    }

    pub(super) fn accumulate(&mut self, shared: &Shared<'_>, rows: &[u32]) {
        self.actor_gradients.iter_mut().for_each(|g| g.fill(0.0));
        self.critic_gradient.fill(0.0);
        self.kl.fill([0.0; 2]);
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
        if let Some((mirror, _)) = shared.mirror {
            let seen = self.input.len();
            self.input.resize(2 * seen, 0.0);
            let (seen, mirrored) = self.input.split_at_mut(seen);
            mirror.inputs.apply_rows_into(seen, mirrored);
            self.blend.extend_from_within(..);
        }
        let (network, line) = line_of(shared.actors, [from, to], &self.blend);
        self.actor.forward(network, line, &self.input);
        let actions = network.outputs();
        let (means, deltas) = self.actor.output_and_delta(self.blend.len());
        let (means, mirrored_means) = means.split_at(rows.len() * actions);
        let (deltas, mirrored_deltas) = deltas.split_at_mut(rows.len() * actions);
        let pairs = means.chunks_exact(actions).zip(deltas.chunks_exact_mut(actions));
        for ((row, t), (mean, delta)) in rows.iter().zip(&self.blend).zip(pairs) {
            let kl = shared.policy_gradient(*row as usize, mean, delta, &mut self.sums);
            let t = if from == to { 1.0 } else { *t };
            for (actor, weight) in [(from, 1.0 - t), (to, t)] {
                self.kl[actor][0] += weight * kl;
                self.kl[actor][1] += weight;
            }
        }
        if let Some((mirror, weight)) = shared.mirror {
            mirrored_deltas.fill(0.0);
            let pairs = means.chunks_exact(actions).zip(deltas.chunks_exact_mut(actions));
            let mirrored =
                mirrored_means.chunks_exact(actions).zip(mirrored_deltas.chunks_exact_mut(actions));
            for ((mean, delta), (other, other_delta)) in pairs.zip(mirrored) {
                self.sums.asymmetry +=
                    mirror.asymmetry([mean, other], [delta, other_delta], weight * shared.scale);
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
pub(super) struct Shared<'a> {
    pub(super) rollout: &'a Rollout,
    pub(super) actors: &'a [Actor],
    pub(super) edges: &'a [[usize; 2]],
    pub(super) critic: &'a Network,
    pub(super) gamma: f32,
    pub(super) action_std: f32,
    pub(super) behaviour_cloning: f32,
    pub(super) ignores_rewards: bool,
    /// With a symmetry loss, and its weight.
    pub(super) mirror: Option<(&'a Mirror, f32)>,
    pub(super) scale: f32,
}

impl Shared<'_> {
    /// Gradient of the clipped surrogate (PPO, equation 7) and of the bound by the mean action of one row; returns the
    /// row's KL divergence.
    fn policy_gradient(&self, row: usize, mean: &[f32], delta: &mut [f32], sums: &mut UpdateReport) -> f32 {
        let numbers = row * mean.len()..(row + 1) * mean.len();
        let (action, acted) = (&self.rollout.actions[numbers.clone()], &self.rollout.means[numbers.clone()]);
        let now = log_probability(action, mean, self.action_std);
        let ratio = (now - log_probability(action, acted, self.action_std)).clamp(-20.0, 20.0).exp();
        let advantage = self.rollout.advantages[row];
        let stopped = if advantage > 0.0 { ratio > 1.0 + CLIP } else { ratio < 1.0 - CLIP };
        let kl = kl_divergence(mean, acted, self.action_std);
        sums.kl += kl;
        sums.clipped += f32::from(u8::from((ratio - 1.0).abs() > CLIP));
        let slope = if stopped || self.ignores_rewards {
            0.0
        } else {
            -advantage * ratio / (self.action_std * self.action_std)
        };
        for ((d, m), a) in delta.iter_mut().zip(mean).zip(action) {
            let excess = (m.abs() - 1.0).max(0.0).copysign(*m);
            *d = (slope * (a - m) + 2.0 * BOUND_PENALTY * excess) * self.scale;
        }
        if self.behaviour_cloning > 0.0 {
            let targets = delta.iter_mut().zip(mean).zip(&self.rollout.cloning_targets[numbers]);
            for ((d, m), target) in targets.filter(|(_, target)| target.is_finite()) {
                *d += 2.0 * self.behaviour_cloning * (m - target) * self.scale;
            }
        }
        kl
    }
}
