//! Actor and critic, and what they do in a rollout.

use random::Rng;

use super::batch::BatchEvaluator;
use super::config::{EMA_DECAY, GAE_LAMBDA, PpoConfig};
use super::lane::Lane;
use super::mirror::Mirror;
use super::rollout::Rollout;
use crate::nn::{Adam, Line, Network};

/// A policy and its optimiser.
#[derive(Clone, Debug)]
pub struct Actor {
    /// The policy.
    pub network: Network,
    /// Its exponential moving average over the updates, which packs take: it is steadier than the policy itself.
    pub ema: Network,
    /// Its optimiser.
    pub adam: Adam,
    /// Index of the actor it is pulled towards, if any.
    pub parent: Option<usize>,
    /// True when it stays as it is.
    pub frozen: bool,
    /// Its present learning rate.
    pub learning_rate: f32,
}

impl Actor {
    /// A policy that learns, pulled towards its parent if it has one.
    #[must_use]
    pub fn learning(network: Network, parent: Option<usize>) -> Self {
        let adam = Adam::new(network.parameters.len());
        Self { adam, ema: network.clone(), network, parent, frozen: false, learning_rate: 0.0 }
    }

    /// A policy that stays as it is.
    #[must_use]
    pub fn frozen(network: Network) -> Self {
        Self { frozen: true, ..Self::learning(network, None) }
    }
}

/// Actors, critic, their optimisers and buffers. Every row of a rollout acts with the blend of the two actors of an edge;
/// an edge from an actor to itself is that actor alone.
#[derive(Clone, Debug)]
pub struct Learner {
    /// Hyper-parameters.
    pub config: PpoConfig,
    /// The policies. The last one is what a recipe of one skill trains.
    pub actors: Vec<Actor>,
    /// Pairs of actors that rows act between.
    pub edges: Vec<[usize; 2]>,
    /// Guesses returns, scaled by `1 - gamma`, from policy inputs and the position on the graph.
    pub critic: Network,
    /// The critic's optimiser.
    pub critic_adam: Adam,
    /// The mirror image of inputs and actions; the symmetry loss needs it.
    pub mirror: Option<Mirror>,
    /// What the actor learns the symmetric mean of, while a phase asks for that: the policy that the phase began with.
    pub teacher: Option<Network>,
    /// Draws actions and shuffles rows.
    pub rng: Rng,
    pub(super) lanes: Vec<Lane>,
    pub(super) order: Vec<u32>,
    pub(super) kl: Vec<[f32; 2]>,
    gathered: Gathered,
    actor_batch: BatchEvaluator,
    critic_batch: BatchEvaluator,
    bootstrap: Vec<f32>,
}

/// Rows of one edge, brought together for one pass.
#[derive(Clone, Debug, Default)]
struct Gathered {
    rows: Vec<usize>,
    input: Vec<f32>,
    blend: Vec<f32>,
    means: Vec<f32>,
}

impl Learner {
    /// A learner that starts from the given networks.
    ///
    /// # Panics
    /// When there is no actor, actors differ in their sizes, or an edge or parent is no actor.
    #[must_use]
    pub fn new(
        config: PpoConfig,
        mut actors: Vec<Actor>,
        edges: Vec<[usize; 2]>,
        critic: Network,
        rng: Rng,
    ) -> Self {
        actors.iter_mut().for_each(|a| a.learning_rate = config.learning_rate);
        let first = &actors.first().expect("a learner has an actor").network;
        assert!(actors.iter().all(|a| a.network.sizes() == first.sizes()), "sizes of the actors");
        let named = edges.iter().flatten().copied().chain(actors.iter().filter_map(|a| a.parent));
        assert!(named.max().is_none_or(|most| most < actors.len()), "actors of edges and parents");
        let lane = Lane::new((&actors, &edges), &critic, config.minibatch.div_ceil(Lane::COUNT));
        Self {
            critic_adam: Adam::new(critic.parameters.len()),
            actor_batch: BatchEvaluator::new(first.sizes()),
            critic_batch: BatchEvaluator::new(critic.sizes()),
            lanes: vec![lane; Lane::COUNT],
            order: Vec::new(),
            kl: vec![[0.0; 2]; actors.len()],
            gathered: Gathered::default(),
            bootstrap: Vec::new(),
            mirror: None,
            teacher: None,
            config,
            actors,
            edges,
            critic,
            rng,
        }
    }

    /// Updates the exponential moving averages.
    pub(super) fn update_ema(&mut self) {
        let keep = EMA_DECAY;
        for actor in self.actors.iter_mut().filter(|a| !a.frozen) {
            let pairs = actor.ema.parameters.iter_mut().zip(&actor.network.parameters);
            pairs.for_each(|(mean, now)| *mean = keep * *mean + (1.0 - keep) * now);
        }
    }

    /// What a recipe of one skill trains: the last actor.
    ///
    /// # Panics
    /// Never: a learner has an actor.
    #[must_use]
    pub fn actor(&self) -> &Network {
        &self.actors.last().expect("a learner has an actor").network
    }

    /// Writes the mean action of every row of `input` to `means`, each for its edge and blend weight.
    ///
    /// # Panics
    /// When the lengths don't fit together, or an edge is not there.
    pub fn means_into(&mut self, input: &[f32], edge: &[usize], blend: &[f32], means: &mut [f32]) {
        let (inputs, actions) = (self.actor().inputs(), self.actor().outputs());
        for (index, &ends) in self.edges.iter().enumerate() {
            let Gathered { rows, input: gathered, blend: weights, means: out } = &mut self.gathered;
            rows.clear();
            rows.extend(edge.iter().enumerate().filter(|(_, e)| **e == index).map(|(row, _)| row));
            gathered.clear();
            weights.clear();
            for &row in &*rows {
                gathered.extend_from_slice(&input[row * inputs..(row + 1) * inputs]);
                weights.push(blend[row]);
            }
            out.resize(rows.len() * actions, 0.0);
            let (network, line) = line_of(&self.actors, ends, weights);
            self.actor_batch.evaluate(network, line, gathered, out);
            for (&row, mean) in rows.iter().zip(out.chunks_exact(actions)) {
                means[row * actions..(row + 1) * actions].copy_from_slice(mean);
            }
        }
    }

    /// Writes the targets of behaviour cloning of tick `step`: the mean of the teacher's action and the mirror image of its action in the mirrored
    /// state.
    ///
    /// # Panics
    /// Without a teacher, a mirror or room for the targets.
    pub fn symmetric_targets(&mut self, rollout: &mut Rollout, step: usize) {
        let (Some(teacher), Some(mirror)) = (&self.teacher, &self.mirror) else {
            panic!("expected a teacher and a mirror");
        };
        let (inputs, actions) = (teacher.inputs(), teacher.outputs());
        let rows = step * rollout.num_envs..(step + 1) * rollout.num_envs;
        let seen = &rollout.inputs[rows.start * inputs..rows.end * inputs];
        let targets = &mut rollout.cloning_targets[rows.start * actions..rows.end * actions];
        let Gathered { input: mirrored, means: others, .. } = &mut self.gathered;
        mirrored.resize(seen.len(), 0.0);
        others.resize(targets.len(), 0.0);
        mirror.inputs.apply_rows_into(seen, mirrored);
        self.actor_batch.evaluate(teacher, None, seen, targets);
        self.actor_batch.evaluate(teacher, None, mirrored, others);
        for (target, other) in targets.chunks_exact_mut(actions).zip(others.chunks_exact(actions)) {
            mirror.actions.average_into(other, target);
        }
    }

    /// Draws the actions of tick `step` of a rollout whose inputs of that tick are there.
    pub fn act(&mut self, rollout: &mut Rollout, step: usize) {
        let n = rollout.num_envs;
        let (inputs, actions) = (self.actor().inputs(), self.actor().outputs());
        let rows = step * n..(step + 1) * n;
        let numbers = rows.start * actions..rows.end * actions;
        let input = &rollout.inputs[rows.start * inputs..rows.end * inputs];
        let (edge, blend) = (&rollout.edge[rows.clone()], &rollout.blend[rows.clone()]);
        self.means_into(input, edge, blend, &mut rollout.means[numbers.clone()]);
        let means = rollout.means[numbers.clone()].chunks_exact(actions).zip(&rollout.deterministic[rows]);
        for (action, (mean, deterministic)) in rollout.actions[numbers].chunks_exact_mut(actions).zip(means) {
            let action_std = if *deterministic { 0.0 } else { self.config.action_std };
            for (action, mean) in action.iter_mut().zip(mean) {
                *action = mean + action_std * self.rng.normal();
            }
        }
    }

    /// Values every row, then writes advantages and returns from the rewards that are there.
    pub fn compute_returns(&mut self, rollout: &mut Rollout) {
        let scale = 1.0 / (1.0 - self.config.gamma);
        self.critic_batch.evaluate(&self.critic, None, &rollout.critic_inputs, &mut rollout.values);
        rollout.values.iter_mut().for_each(|v| *v *= scale);
        let mut after = std::mem::take(&mut self.bootstrap);
        after.clear();
        after.resize(rollout.num_envs + rollout.cut_off.len(), 0.0);
        let (last, cut_off) = after.split_at_mut(rollout.num_envs);
        self.critic_batch.evaluate(&self.critic, None, &rollout.last_critic_inputs, last);
        let rows: Vec<f32> = rollout.cut_off.iter().flat_map(|(_, row)| row.iter().copied()).collect();
        self.critic_batch.evaluate(&self.critic, None, &rows, cut_off);
        last.iter_mut().chain(cut_off.iter_mut()).for_each(|v| *v *= scale);
        rollout.estimate_advantages(self.config.gamma, GAE_LAMBDA, last, cut_off);
        rollout.normalise_advantages();
        self.bootstrap = after;
    }

    /// Geometric mean of the learning rates of the actors that learn.
    #[must_use]
    pub fn learning_rate(&self) -> f32 {
        let learning = self.actors.iter().filter(|a| !a.frozen);
        let (sum, count) =
            learning.fold((0.0, 0.0_f32), |(sum, count), a| (sum + a.learning_rate.ln(), count + 1.0));
        (sum / count.max(1.0)).exp()
    }

    /// Mean squared distance of the actors that have a parent to its parameters; zero without one.
    #[must_use]
    pub fn distance_to_parent(&self) -> f64 {
        let distances = self.actors.iter().filter_map(|a| {
            let parent = &self.actors[a.parent?].network;
            Some(a.network.squared_distance(parent))
        });
        let (sum, count) = distances.fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
        sum / f64::max(count, 1.0)
    }
}

/// The network that acts on an edge, and the other one beside it where the edge joins two.
pub(super) fn line_of<'a>(
    actors: &'a [Actor],
    [from, to]: [usize; 2],
    blend: &'a [f32],
) -> (&'a Network, Option<Line<'a>>) {
    let line = (from != to).then(|| Line { parent: &actors[from].network, blend });
    (&actors[to].network, line)
}
