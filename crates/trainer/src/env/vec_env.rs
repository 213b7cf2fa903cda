//! All environments, stepped by all threads. An environment depends on its own random numbers alone, never on how threads
//! share the work.

use physics_bridge::Model;
use policy_core::training::ActionScaling;
use random::Rng;
use rayon::prelude::*;

use super::env::{Env, EnvContext, Episode};
use super::reward::RewardTerms;
use crate::ppo::Done;

/// Nodes that a report tells apart; with more of them the rest counts as the last.
pub const REPORTED_NODES: usize = 8;

/// What happened nearest to one node of the graph.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NodeReport {
    /// Ticks of all characters.
    pub ticks: u64,
    /// Episodes that failed there.
    pub failed: u32,
    /// Speed along the wanted direction, summed over the ticks, metres per second.
    pub speed_mps: f64,
}

/// Sums over the episodes that ended and the ticks that passed since the last report.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EpisodeReport {
    /// Episodes that ended.
    pub episodes: u32,
    /// Those that failed.
    pub failed: u32,
    /// Their ticks.
    pub episode_ticks: u64,
    /// Ticks of all characters.
    pub ticks: u64,
    /// Task reward of all ticks.
    pub task: f64,
    /// Tracking reward of all ticks.
    pub tracking: f64,
    /// |speed - commanded speed| of all ticks, metres per second.
    pub speed_error: f64,
    /// By node of the graph.
    pub nodes: [NodeReport; REPORTED_NODES],
}

/// All environments.
#[derive(Debug)]
pub struct VecEnv {
    envs: Vec<Env>,
    ends: Vec<Done>,
    terms: Vec<RewardTerms>,
    episodes: Vec<Option<Episode>>,
    /// Node nearest to where every character acted in the last tick.
    nearest: Vec<usize>,
    scaling: ActionScaling,
    /// Critic inputs of every character now; they begin with the policy's.
    pub inputs: Vec<f32>,
    /// Critic inputs right after the last tick, before any reset.
    pub inputs_after: Vec<f32>,
    /// What has happened since it was last taken.
    pub report: EpisodeReport,
}

impl VecEnv {
    /// Starts an episode in every environment; the models are given out in turn.
    ///
    /// # Panics
    /// When there is no model.
    #[must_use]
    pub fn new(models: &[Model], scaling: &ActionScaling, context: &EnvContext<'_>, seed: u64) -> Self {
        let count = context.config.num_envs;
        let width = context.critic_inputs();
        let model = |i: usize| &models[i % models.len()];
        let envs = (0..count).map(|i| Env::new(model(i), context, Rng::new(seed, 1000 + i as u64))).collect();
        let mut vec_env = Self {
            envs,
            ends: vec![Done::No; count],
            terms: vec![RewardTerms::default(); count],
            episodes: vec![None; count],
            nearest: vec![0; count],
            scaling: scaling.clone(),
            inputs: vec![0.0; count * width],
            inputs_after: vec![0.0; count * width],
            report: EpisodeReport::default(),
        };
        let rows = vec_env.inputs.par_chunks_exact_mut(width);
        vec_env.envs.par_iter_mut().zip(rows).for_each(|(env, row)| {
            env.reset(context, true);
            env.observe_into(context, row);
        });
        vec_env
    }

    /// The environments.
    #[must_use]
    pub fn envs(&self) -> &[Env] {
        &self.envs
    }

    /// How the last tick ended for every character.
    #[must_use]
    pub fn ends(&self) -> &[Done] {
        &self.ends
    }

    /// What the last tick was worth for every character.
    #[must_use]
    pub fn terms(&self) -> &[RewardTerms] {
        &self.terms
    }

    /// One tick of all characters: acts, writes discriminator inputs, resets those whose episode ended.
    ///
    /// # Panics
    /// When there are not as many rows as characters.
    pub fn step(&mut self, context: &EnvContext<'_>, actions: &[f32], discriminator_inputs: &mut [f32]) {
        let (count, joints) = (self.envs.len(), context.skeleton.joint_count());
        let scored_len = context.skeleton.discriminator_input_len();
        assert_eq!(actions.len(), count * joints, "actions of a vec_env");
        assert_eq!(discriminator_inputs.len(), count * scored_len, "discriminator inputs");
        let (scaling, width) = (&self.scaling, context.critic_inputs());
        let outs = self
            .ends
            .par_iter_mut()
            .zip(self.terms.par_iter_mut())
            .zip(self.episodes.par_iter_mut().zip(self.nearest.par_iter_mut()))
            .zip(self.inputs.par_chunks_exact_mut(width))
            .zip(self.inputs_after.par_chunks_exact_mut(width))
            .zip(discriminator_inputs.par_chunks_exact_mut(scored_len));
        let pairs = self.envs.par_iter_mut().zip(actions.par_chunks_exact(joints)).with_min_len(8);
        pairs.zip(outs).for_each(
            |((env, action), (((((end, terms), (episode, node)), input), after), scored))| {
                (*terms, *end) = env.step(context, scaling, action, scored);
                *episode = (*end != Done::No).then(|| env.episode(*end));
                *node = env.command.position.nearest_node().index();
                env.observe_into(context, after);
                if *end == Done::No {
                    env.advance_command(context);
                } else {
                    env.reset(context, false);
                }
                env.observe_into(context, input);
            },
        );
        self.count();
    }

    fn count(&mut self) {
        let report = &mut self.report;
        for episode in self.episodes.iter().flatten() {
            report.episodes += 1;
            report.failed += u32::from(episode.failed);
            report.episode_ticks += u64::from(episode.ticks);
        }
        report.ticks += self.terms.len() as u64;
        for ((node, end), terms) in self.nearest.iter().zip(&self.ends).zip(&self.terms) {
            let node = &mut report.nodes[(*node).min(REPORTED_NODES - 1)];
            node.ticks += 1;
            node.failed += u32::from(*end == Done::Failed);
            node.speed_mps += f64::from(terms.speed_mps);
        }
        for terms in &self.terms {
            report.task += f64::from(terms.task);
            report.tracking += f64::from(terms.tracking);
            report.speed_error += f64::from((terms.speed_mps - terms.commanded_mps).abs());
        }
    }
}
