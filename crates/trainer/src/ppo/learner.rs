//! Actor and critic, and what they do in a rollout.

use rayon::prelude::*;

use super::config::PpoConfig;
use super::rollout::Rollout;
use super::update::Lane;
use crate::nn::{Adam, Line, Network, Pass};
use crate::rng::Rng;

/// Evaluates a network on many rows with all threads. The result does not depend on their number.
#[derive(Clone, Debug)]
pub struct BatchEvaluator {
    lanes: Vec<Pass>,
    block: usize,
}

impl BatchEvaluator {
    /// An evaluator for networks of these sizes.
    #[must_use]
    pub fn new(sizes: &[usize]) -> Self {
        let block = 128;
        Self { lanes: vec![Pass::new(sizes, block); 4], block }
    }

    /// Writes the outputs of `network` for every row of `input` to `out`.
    ///
    /// # Panics
    /// When `out` is not one output row for each input row.
    pub fn evaluate(&mut self, network: &Network, line: Option<Line<'_>>, input: &[f32], out: &mut [f32]) {
        let (inputs, outputs, block) = (network.inputs(), network.outputs(), self.block);
        let rows = input.len() / inputs;
        assert_eq!(out.len(), rows * outputs, "outputs of a batch");
        let per_lane = rows.div_ceil(self.lanes.len()).max(1);
        let lanes = self.lanes.par_iter_mut().zip(input.par_chunks(per_lane * inputs));
        lanes.zip(out.par_chunks_mut(per_lane * outputs)).enumerate().for_each(
            |(lane, ((pass, input), out))| {
                let blocks = input.chunks(block * inputs).zip(out.chunks_mut(block * outputs));
                for (i, (input, out)) in blocks.enumerate() {
                    let first = lane * per_lane + i * block;
                    let rows = input.len() / inputs;
                    let line = line.map(|l| Line { parent: l.parent, blend: &l.blend[first..first + rows] });
                    pass.forward(network, line, input);
                    out.copy_from_slice(pass.output(rows));
                }
            },
        );
    }
}

/// Actor, critic, their optimisers and buffers.
#[derive(Clone, Debug)]
pub struct Learner {
    /// Hyper-parameters.
    pub config: PpoConfig,
    /// The policy that learns.
    pub actor: Network,
    /// Guesses returns, scaled by `1 - gamma`, from policy inputs and the blend weight.
    pub critic: Network,
    /// The frozen policy it is pulled towards, if any.
    pub parent: Option<Network>,
    /// True when rows act with blends of parent and actor.
    pub along_line: bool,
    /// Rate of the actor's Adam now.
    pub actor_rate: f32,
    /// The actor's optimiser.
    pub actor_adam: Adam,
    /// The critic's optimiser.
    pub critic_adam: Adam,
    /// Draws actions and shuffles rows.
    pub rng: Rng,
    pub(super) lanes: Vec<Lane>,
    pub(super) order: Vec<u32>,
    actor_batch: BatchEvaluator,
    critic_batch: BatchEvaluator,
    bootstrap: Vec<f32>,
}

impl Learner {
    /// A learner that starts from the given networks.
    ///
    /// # Panics
    /// When the critic doesn't take one input more than the actor, or the parent has other sizes than the actor.
    #[must_use]
    pub fn new(
        config: PpoConfig,
        actor: Network,
        critic: Network,
        parent: Option<Network>,
        rng: Rng,
    ) -> Self {
        assert_eq!(critic.inputs(), actor.inputs() + 1, "inputs of the critic");
        assert!(parent.as_ref().is_none_or(|p| p.sizes() == actor.sizes()), "sizes of the parent");
        let lane = Lane::new(&actor, &critic, config.minibatch.div_ceil(Lane::COUNT));
        Self {
            actor_rate: config.actor_rate,
            actor_adam: Adam::new(actor.parameters.len()),
            critic_adam: Adam::new(critic.parameters.len()),
            actor_batch: BatchEvaluator::new(actor.sizes()),
            critic_batch: BatchEvaluator::new(critic.sizes()),
            lanes: vec![lane; Lane::COUNT],
            order: Vec::new(),
            bootstrap: Vec::new(),
            along_line: false,
            config,
            actor,
            critic,
            parent,
            rng,
        }
    }

    /// Writes the mean action of every row of `input` to `means`; `blend` holds a blend weight for each.
    pub fn means_into(&mut self, input: &[f32], blend: &[f32], means: &mut [f32]) {
        let line = line_of(self.parent.as_ref(), self.along_line, blend);
        self.actor_batch.evaluate(&self.actor, line, input, means);
    }

    /// Draws the actions of tick `step` of a rollout whose inputs of that tick are there.
    pub fn act(&mut self, rollout: &mut Rollout, step: usize) {
        let n = rollout.characters;
        let (inputs, actions) = (self.actor.inputs(), self.actor.outputs());
        let rows = step * n..(step + 1) * n;
        let numbers = rows.start * actions..rows.end * actions;
        let input = &rollout.inputs[rows.start * inputs..rows.end * inputs];
        let blend = &rollout.blend[rows];
        self.means_into(input, blend, &mut rollout.means[numbers.clone()]);
        let pairs = rollout.actions[numbers.clone()].iter_mut().zip(&rollout.means[numbers]);
        for (action, mean) in pairs {
            *action = mean + self.config.deviation * self.rng.normal();
        }
    }

    /// Values every row, then writes advantages and returns from the rewards that are there.
    pub fn compute_returns(&mut self, rollout: &mut Rollout) {
        let scale = 1.0 / (1.0 - self.config.gamma);
        self.critic_batch.evaluate(&self.critic, None, &rollout.critic_inputs, &mut rollout.values);
        rollout.values.iter_mut().for_each(|v| *v *= scale);
        let mut after = std::mem::take(&mut self.bootstrap);
        after.clear();
        after.resize(rollout.characters + rollout.cut_off.len(), 0.0);
        let (last, cut_off) = after.split_at_mut(rollout.characters);
        self.critic_batch.evaluate(&self.critic, None, &rollout.last_critic_inputs, last);
        let rows: Vec<f32> = rollout.cut_off.iter().flat_map(|(_, row)| row.iter().copied()).collect();
        self.critic_batch.evaluate(&self.critic, None, &rows, cut_off);
        last.iter_mut().chain(cut_off.iter_mut()).for_each(|v| *v *= scale);
        rollout.estimate_advantages(self.config.gamma, self.config.gae_lambda, last, cut_off);
        rollout.normalise_advantages();
        self.bootstrap = after;
    }

    /// Squared distance of the actor's parameters to its parent's; zero without one.
    #[must_use]
    pub fn distance_to_parent(&self) -> f64 {
        self.parent.as_ref().map_or(0.0, |p| self.actor.squared_distance(p))
    }
}

pub(super) fn line_of<'a>(
    parent: Option<&'a Network>,
    along_line: bool,
    blend: &'a [f32],
) -> Option<Line<'a>> {
    parent.filter(|_| along_line).map(|parent| Line { parent, blend })
}
