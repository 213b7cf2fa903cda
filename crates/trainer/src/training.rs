//! One iteration of training: rollout, style, returns, gradient steps. The loop around it belongs to the program.

use physics_bridge::{Model, ModelError};
use policy_core::GraphPosition;
use policy_core::training::ActionScaling;

use crate::amp::DiscriminatorReport;
use crate::checkpoint::{ACTOR, CRITIC, DISCRIMINATOR, EMA, PARENT_DISCRIMINATOR, TEACHER};
use crate::env::{
    EnvironmentConfig, EpisodeReport, GraphNode, Normalisers, RandomisationConfig, RewardTerms,
    TrainingGraph, VecEnv,
};
use crate::nn::{Adam, Network};
use crate::ppo::{Done, Learner, Rollout, UpdateReport};
use crate::recipe::Recipe;
use crate::style::Discriminators;

mod shared;

use shared::Shared;
pub use shared::{Parts, PhaseBodies};

/// Hidden sizes of every policy.
pub const POLICY_HIDDEN: [usize; 2] = [128, 32];

/// Everything a run of a recipe holds.
#[derive(Debug)]
pub struct Training {
    /// The recipe.
    pub recipe: Recipe,
    /// Actors and critic.
    pub learner: Learner,
    /// Discriminators of the nodes' styles.
    pub discriminators: Discriminators,
    /// Samples so far.
    pub samples: u64,
    /// Seed of the environments' random numbers.
    seed: u64,
    /// Index of the phase that is set up, once one is.
    phase: Option<usize>,
    shared: Shared,
    envs: VecEnv,
    rollout: Rollout,
    discriminator_inputs: Vec<f32>,
    /// How far each row's character had to turn, see [`RewardTerms::turning`].
    turning: Vec<f32>,
    model: Model,
    scaling: ActionScaling,
}

/// What an iteration measured.
#[derive(Clone, Copy, Debug, Default)]
pub struct IterationReport {
    /// Episodes and task reward.
    pub episodes: EpisodeReport,
    /// Mean style reward.
    pub style: f32,
    /// Mean reward of all.
    pub reward: f32,
    /// Gradient steps of PPO.
    pub update: UpdateReport,
    /// Gradient steps of the discriminators.
    pub discriminator: DiscriminatorReport,
    /// Mean squared distance to the parents' parameters.
    pub distance: f64,
    /// Geometric mean of the actors' learning rates.
    pub learning_rate: f32,
    /// Seconds of rollout, gradient steps and discriminators.
    pub secs: [f32; 3],
}

impl Training {
    /// Starts a run. Its environments draw from random numbers of `seed`.
    #[must_use]
    pub fn new(recipe: Recipe, model: &Model, normalisers: Normalisers, parts: Parts, seed: u64) -> Self {
        let Parts { graph, learner, discriminators, start_demonstrations, hand_over, bodies, company } =
            parts;
        let environment = &recipe.first().environment;
        let shape = (environment.horizon, environment.num_envs);
        let skeleton = model.skeleton().clone();
        let scaling = ActionScaling::from_skeleton(&skeleton);
        let demonstrations = discriminators.demonstrations();
        let [inputs, actions] = [skeleton.policy_input_len(), skeleton.joint_count()];
        let scored = skeleton.discriminator_input_len();
        let shared = Shared {
            graph,
            start_demonstrations,
            hand_over,
            normalisers,
            bodies,
            phase: 0,
            company,
            skeleton,
        };
        let context = shared.context(environment, &demonstrations);
        let envs = VecEnv::new(std::slice::from_ref(model), &scaling, &context, seed);
        Self {
            rollout: Rollout::new(shape, (inputs, context.critic_inputs()), actions),
            discriminator_inputs: vec![0.0; shape.0 * shape.1 * scored],
            turning: vec![0.0; shape.0 * shape.1],
            samples: 0,
            seed,
            phase: None,
            learner,
            discriminators,
            envs,
            shared,
            model: model.clone(),
            scaling,
            recipe,
        }
    }

    /// Networks that learn, with their optimisers, by their roles in a checkpoint: `actor`, its moving average `ema`,
    /// `discriminator`, `critic`; and the `teacher`, which stays as it is. Where skills are trained together all but the last have
    /// the skill's name before them, with a dot.
    pub fn networks_mut(&mut self) -> Vec<(String, &mut Network, Option<&mut Adam>)> {
        let together = !self.recipe.paths.is_empty();
        let last = self.shared.graph.nodes().len() - 1;
        let mut all = Vec::new();
        let halfway = self.discriminators.halfway().to_vec();
        let (scorers, between) = self.discriminators.scorers.split_at_mut(last + 1);
        let nodes = self.shared.graph.nodes().iter().zip(self.learner.actors.iter_mut().zip(scorers));
        for (i, (node, (actor, scorer))) in nodes.enumerate() {
            let role = |what: &str| if together { format!("{}.{what}", node.name) } else { what.to_owned() };
            if together || i == last {
                all.push((role(ACTOR), &mut actor.network, Some(&mut actor.adam)));
                all.push((role(EMA), &mut actor.ema, None));
            }
            if let Some(d) = &mut scorer.discriminator {
                let what = if together || i == last { DISCRIMINATOR } else { PARENT_DISCRIMINATOR };
                all.push((role(what), &mut d.network, Some(&mut d.adam)));
            }
        }
        for (edge, scorer) in halfway.iter().zip(between) {
            let [from, to] =
                self.shared.graph.pairs()[*edge].map(|node| &self.shared.graph.nodes()[node].name);
            if let Some(d) = &mut scorer.discriminator {
                all.push((format!("{from}-{to}.{DISCRIMINATOR}"), &mut d.network, Some(&mut d.adam)));
            }
        }
        if let Some(teacher) = &mut self.learner.teacher {
            all.push((TEACHER.to_owned(), teacher, None));
        }
        all.push((CRITIC.to_owned(), &mut self.learner.critic, Some(&mut self.learner.critic_adam)));
        all
    }

    /// Learning rates of the policies that learn, by their roles in a checkpoint.
    pub fn learning_rates_mut(&mut self) -> Vec<(String, &mut f32)> {
        let together = !self.recipe.paths.is_empty();
        let last = self.shared.graph.nodes().len() - 1;
        let nodes = self.shared.graph.nodes().iter().zip(&mut self.learner.actors).enumerate();
        let learns = nodes.filter(|(index, _)| together || *index == last);
        learns
            .map(|(_, (node, actor))| {
                let role = if together { format!("{}.{ACTOR}", node.name) } else { ACTOR.to_owned() };
                (role, &mut actor.learning_rate)
            })
            .collect()
    }

    /// What characters move along.
    #[must_use]
    pub fn graph(&self) -> &TrainingGraph {
        &self.shared.graph
    }

    /// Sets up the phase after the samples so far, when it is another one than before.
    fn enter_phase(&mut self) -> Result<(), ModelError> {
        let index = self.recipe.phase_at(self.samples);
        if self.phase == Some(index) {
            return Ok(());
        }
        let before = self.phase.replace(index).map(|before| &self.recipe.phases[before].environment);
        let phase = &self.recipe.phases[index];
        self.shared.phase = index;
        let earlier = self.recipe.phase_at(self.samples.saturating_sub(self.rollout.rows() as u64));
        if self.recipe.phases[earlier].ppo.learning_rate != phase.ppo.learning_rate {
            self.learner.actors.iter_mut().for_each(|a| a.learning_rate = phase.ppo.learning_rate);
        }
        self.learner.config.clone_from(&phase.ppo);
        let teacher = self.learner.teacher.take().filter(|_| earlier == index);
        self.learner.teacher =
            phase.ppo.symmetrise.then(|| teacher.unwrap_or_else(|| self.learner.actor().clone()));
        self.discriminators.set_config(&phase.discriminator);
        if self.recipe.paths.is_empty() {
            let last = self.shared.graph.nodes().len() - 1;
            let GraphNode { share, root_metres, .. } = self.shared.graph.nodes()[last];
            let node = GraphNode::new(&self.recipe.skill, &phase.environment, share);
            self.shared.graph.set_node(last, GraphNode { root_metres, ..node });
        }
        self.shared.graph.set_edge_secs_factors(phase.environment.command.edge_secs_factors);
        let randomisation = &phase.environment.randomisation;
        if before.map_or([0.0; 6], models_of) != models_of(&phase.environment) {
            let models = randomisation.models(&self.model)?;
            let demonstrations = self.discriminators.demonstrations();
            let context = self.shared.context(&phase.environment, &demonstrations);
            self.envs = VecEnv::new(&models, &self.scaling, &context, self.seed.wrapping_add(self.samples));
        }
        Ok(())
    }

    /// One rollout and the gradient steps after it.
    ///
    /// # Errors
    /// When the model can't be set on the grounds of the phase.
    pub fn iterate(&mut self) -> Result<IterationReport, ModelError> {
        self.enter_phase()?;
        let start = std::time::Instant::now();
        self.roll_out();
        let rolled = start.elapsed();
        let (style, discriminator) = self.score_style();
        let scored = start.elapsed();
        self.learner.compute_returns(&mut self.rollout);
        let update = self.learner.update(&self.rollout);
        self.samples += self.rollout.rows() as u64;
        let rows = self.rollout.rows() as f32;
        Ok(IterationReport {
            episodes: std::mem::take(&mut self.envs.report),
            style,
            reward: self.rollout.rewards.iter().sum::<f32>() / rows,
            update,
            discriminator,
            distance: self.learner.distance_to_parent(),
            learning_rate: self.learner.learning_rate(),
            secs: [
                rolled.as_secs_f32(),
                (start.elapsed() - scored).as_secs_f32(),
                (scored - rolled).as_secs_f32(),
            ],
        })
    }

    fn roll_out(&mut self) {
        let n = self.rollout.num_envs;
        let config = &self.recipe.phases[self.recipe.phase_at(self.samples)].environment;
        let demonstrations = self.discriminators.demonstrations();
        let context = self.shared.context(config, &demonstrations);
        let width = context.critic_inputs();
        let (skeleton, graph) = (context.skeleton, context.graph);
        let [inputs, joints] = [skeleton.policy_input_len(), skeleton.joint_count()];
        let scored = skeleton.discriminator_input_len();
        self.rollout.clear();
        let symmetrises = self.learner.config.symmetrise;
        let tracks = self.learner.config.behaviour_cloning > 0.0;
        let targets = if tracks || symmetrises { self.rollout.actions.len() } else { 0 };
        self.rollout.cloning_targets.resize(targets, f32::NAN);
        for step in 0..self.rollout.horizon {
            let rows = step * n..(step + 1) * n;
            self.rollout.critic_inputs[rows.start * width..rows.end * width]
                .copy_from_slice(&self.envs.inputs);
            let seen = self.envs.inputs.chunks_exact(width).zip(self.envs.envs());
            for (row, (input, env)) in rows.clone().zip(seen) {
                if tracks {
                    let out = &mut self.rollout.cloning_targets[row * joints..(row + 1) * joints];
                    env.reference_action_into(&context, &self.scaling, out);
                }
                let at = row * inputs;
                self.rollout.inputs[at..at + inputs].copy_from_slice(&input[..inputs]);
                (self.rollout.edge[row], self.rollout.blend[row]) =
                    graph.pair_and_blend(env.command.position);
                self.rollout.deterministic[row] = env.is_deterministic();
            }
            self.learner.act(&mut self.rollout, step);
            if symmetrises {
                self.learner.symmetric_targets(&mut self.rollout, step);
            }
            let actions = &self.rollout.actions[rows.start * joints..rows.end * joints];
            let frames = rows.start * scored..rows.end * scored;
            self.envs.step(&context, actions, &mut self.discriminator_inputs[frames]);
            self.rollout.record(step, self.envs.ends(), &self.envs.inputs_after);
            let at = self.rollout.edge[rows.clone()].iter().zip(&self.rollout.blend[rows.clone()]);
            let rewards = self.rollout.rewards[rows].iter_mut().zip(self.envs.terms());
            let turning = self.turning[step * n..].iter_mut();
            for ((((reward, terms), end), (edge, t)), turning) in
                rewards.zip(self.envs.ends()).zip(at).zip(turning)
            {
                let share = task_share(config, graph, graph.position_of(*edge, *t), terms.turning);
                *reward = reward_of(config, share, terms, *end);
                *turning = terms.turning;
            }
        }
        self.rollout.last_critic_inputs.copy_from_slice(&self.envs.inputs);
    }

    /// Adds the style reward, weighted by what the others leave, to the rewards that are there, and teaches the discriminators.
    /// Returns the mean style reward.
    fn score_style(&mut self) -> (f32, DiscriminatorReport) {
        let config = &self.recipe.phases[self.recipe.phase_at(self.samples)].environment;
        let graph = &self.shared.graph;
        let positions = (&self.rollout.edge[..], &self.rollout.blend[..]);
        let style = self.discriminators.style(graph, positions, &self.discriminator_inputs);
        let at = positions.0.iter().zip(positions.1).map(|(edge, t)| graph.position_of(*edge, *t));
        let tracking = tracking_share(config);
        let rows = self.rollout.rewards.iter_mut().zip(style).zip(at.zip(&self.turning));
        for ((reward, style), (position, turning)) in rows {
            *reward += (1.0 - task_share(config, graph, position, *turning) - tracking) * style;
        }
        let mean = style.iter().sum::<f32>() / style.len() as f32;
        (mean, self.discriminators.learn(graph, positions, &self.discriminator_inputs))
    }
}

/// What the bodies and worlds of the environments are made by.
fn models_of(config: &EnvironmentConfig) -> [f32; 6] {
    let RandomisationConfig { terrain_metres, step_metres, slope_metres, dynamics, long_steps, .. } =
        config.randomisation;
    let long_steps = f32::from(u8::from(long_steps && dynamics > 0.0));
    [terrain_metres, step_metres, slope_metres, dynamics, long_steps, config.meetings.share]
}

/// Weight of the task reward at a position. A character that turns gives a part of the style's.
fn task_share(
    config: &EnvironmentConfig,
    graph: &TrainingGraph,
    position: GraphPosition,
    turning: f32,
) -> f32 {
    let share = config.reward.task_weight * graph.task(position);
    let style = 1.0 - share - tracking_share(config);
    share + turning * (1.0 - config.reward.turning_style_factor) * style
}

/// Share of the weights that tracking takes. In joint training it takes none: its reward is added to the others.
fn tracking_share(config: &EnvironmentConfig) -> f32 {
    if config.reward.tracking_share > 0.0 { 0.0 } else { config.reward.tracking_weight }
}

/// Reward of a tick, without that for style.
fn reward_of(config: &EnvironmentConfig, task_share: f32, terms: &RewardTerms, end: Done) -> f32 {
    let reward = &config.reward;
    let fall = if end == Done::Failed { reward.fall_cost } else { 0.0 };
    let cost = fall + reward.foot_slip_cost * terms.foot_slip_mps;
    task_share * terms.task + reward.tracking_weight * terms.tracking - cost
}

#[cfg(test)]
mod tests;
