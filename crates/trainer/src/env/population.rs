//! All characters that learn, stepped by all threads. What happens to a character depends on its own random numbers
//! alone, never on how threads share the work.

use physics_bridge::Model;
use policy_core::{ActionScaling, DISCRIMINATOR_INPUT_LEN, DOF_COUNT, POLICY_INPUT_LEN};
use rayon::prelude::*;

use super::agent::{Agent, Episode, Recovery};
use super::command::INTENT_LEN;
use super::config::EnvironmentConfig;
use super::course::Course;
use super::demonstrations::Demonstrations;
use super::normalisers::Normalisers;
use super::reward::RewardTerms;
use crate::Rng;
use crate::ppo::Done;

/// What all characters share in a phase of training.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    /// Settings.
    pub config: &'a EnvironmentConfig,
    /// What characters move along.
    pub course: &'a Course,
    /// Clips of the course's nodes.
    pub demonstrations: &'a [&'a Demonstrations],
    /// Other clips, for starts.
    pub start_demonstrations: Option<&'a Demonstrations>,
    /// What raises characters that were dropped, for starts.
    pub recovery: Option<&'a Recovery>,
    /// The graph's normalisers.
    pub normalisers: &'a Normalisers,
}

impl Stage<'_> {
    /// Inputs of the critic: the policy's and [`Course::context_len`] more.
    #[must_use]
    pub fn critic_inputs(&self) -> usize {
        POLICY_INPUT_LEN + self.course.context_len()
    }
}

/// Nodes that a report tells apart; a course with more counts the rest with the last.
pub const REPORTED_NODES: usize = 8;

/// What happened nearest to one node of the course.
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
pub struct PopulationReport {
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
    /// Reward of all ticks for being like the clip.
    pub imitation: f64,
    /// |speed - commanded speed| of all ticks, metres per second.
    pub speed_error: f64,
    /// By node of the course.
    pub nodes: [NodeReport; REPORTED_NODES],
}

/// All characters that learn.
#[derive(Debug)]
pub struct Population {
    agents: Vec<Agent>,
    ends: Vec<Done>,
    terms: Vec<RewardTerms>,
    episodes: Vec<Option<Episode>>,
    /// Node nearest to where every character acted in the last tick.
    nearest: Vec<usize>,
    scaling: ActionScaling,
    /// Critic inputs of every character now; the policy's are their first [`POLICY_INPUT_LEN`].
    pub inputs: Vec<f32>,
    /// Critic inputs right after the last tick, before any reset.
    pub inputs_after: Vec<f32>,
    /// What has happened since it was last taken.
    pub report: PopulationReport,
}

impl Population {
    /// Starts an episode for every character; they share the given grounds in turn.
    ///
    /// # Panics
    /// When there is no model.
    #[must_use]
    pub fn new(grounds: &[Model], scaling: &ActionScaling, stage: &Stage<'_>, seed: u64) -> Self {
        let count = stage.config.characters;
        let width = stage.critic_inputs();
        let ground = |i: usize| &grounds[i % grounds.len()];
        let agents = (0..count).map(|i| Agent::new(ground(i), Rng::new(seed, 1000 + i as u64))).collect();
        let mut population = Self {
            agents,
            ends: vec![Done::No; count],
            terms: vec![RewardTerms::default(); count],
            episodes: vec![None; count],
            nearest: vec![0; count],
            scaling: scaling.clone(),
            inputs: vec![0.0; count * width],
            inputs_after: vec![0.0; count * width],
            report: PopulationReport::default(),
        };
        let rows = population.inputs.par_chunks_exact_mut(width);
        population.agents.par_iter_mut().zip(rows).for_each(|(agent, row)| {
            agent.reset(stage, true);
            write_input(agent, stage, row);
        });
        population
    }

    /// The characters.
    #[must_use]
    pub fn agents(&self) -> &[Agent] {
        &self.agents
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
    pub fn step(&mut self, stage: &Stage<'_>, actions: &[f32], discriminator_inputs: &mut [f32]) {
        let count = self.agents.len();
        assert_eq!(actions.len(), count * DOF_COUNT, "actions of a population");
        assert_eq!(discriminator_inputs.len(), count * DISCRIMINATOR_INPUT_LEN, "discriminator inputs");
        let (scaling, width) = (&self.scaling, stage.critic_inputs());
        let outs = self
            .ends
            .par_iter_mut()
            .zip(self.terms.par_iter_mut())
            .zip(self.episodes.par_iter_mut().zip(self.nearest.par_iter_mut()))
            .zip(self.inputs.par_chunks_exact_mut(width))
            .zip(self.inputs_after.par_chunks_exact_mut(width))
            .zip(discriminator_inputs.par_chunks_exact_mut(DISCRIMINATOR_INPUT_LEN));
        let pairs = self.agents.par_iter_mut().zip(actions.par_chunks_exact(DOF_COUNT)).with_min_len(8);
        pairs.zip(outs).for_each(
            |((agent, action), (((((end, terms), (episode, node)), input), after), judged))| {
                let action: &[f32; DOF_COUNT] = action.try_into().expect("a chunk of this length");
                let judged: &mut [f32; DISCRIMINATOR_INPUT_LEN] =
                    judged.try_into().expect("a chunk of this length");
                (*terms, *end) = agent.step(stage, scaling, action, judged);
                *episode = (*end != Done::No).then(|| agent.episode(*end));
                *node = stage.course.nearest(agent.command.place);
                write_input(agent, stage, after);
                if *end == Done::No {
                    agent.advance_command(stage);
                } else {
                    agent.reset(stage, false);
                }
                write_input(agent, stage, input);
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
            report.imitation += f64::from(terms.imitation);
            report.speed_error += f64::from((terms.speed_mps - terms.commanded_mps).abs());
        }
    }
}

fn write_input(agent: &Agent, stage: &Stage<'_>, row: &mut [f32]) {
    let (input, rest) = row.split_at_mut(POLICY_INPUT_LEN);
    let (place, intent) = rest.split_at_mut(stage.course.place_len());
    agent.input_into(stage, input);
    stage.course.place_into(agent.command.place, place);
    agent.command.intent_into(intent);
    if let Some(last) = intent.get_mut(INTENT_LEN) {
        *last = f32::from(u8::from(agent.imitates()));
    }
}
