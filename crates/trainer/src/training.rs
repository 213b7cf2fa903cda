//! One iteration of training: rollout, style, returns, gradient steps. The loop around it belongs to the program.

use physics_bridge::{Model, ModelError, Terrain};
use policy_core::{ActionScaling, DISCRIMINATOR_INPUT_LEN, DOF_COUNT, POLICY_INPUT_LEN};

use crate::amp::DiscriminatorReport;
use crate::env::{Course, Demonstrations, Normalisers, Place, Population, PopulationReport, Recovery};
use crate::nn::{Adam, Network};
use crate::ppo::{Learner, Rollout, UpdateReport};
use crate::recipe::Recipe;
use crate::setting::Setting;
use crate::style::Judges;

/// Hidden sizes of every policy.
pub const POLICY_HIDDEN: [usize; 2] = [128, 32];

/// Role of the discriminator that judges a parent's style, in a checkpoint.
pub const PARENT_DISCRIMINATOR: &str = "parent_discriminator";

/// Role of a policy's running mean, in a checkpoint.
pub const AVERAGE: &str = "average";

/// What a run starts from. Actors, judges and clips are in the order of the course's nodes.
#[derive(Debug)]
pub struct Parts {
    /// Nodes and paths.
    pub course: Course,
    /// Actors and critic.
    pub learner: Learner,
    /// Judges of the nodes' styles, with their clips.
    pub judges: Judges,
    /// Other clips that episodes may start from.
    pub start_demonstrations: Option<Demonstrations>,
    /// What raises characters that were dropped, for starts.
    pub recovery: Option<Recovery>,
}

/// Everything a run of a recipe holds.
#[derive(Debug)]
pub struct Training {
    /// The recipe.
    pub recipe: Recipe,
    /// Actors and critic.
    pub learner: Learner,
    /// Judges of the nodes' styles.
    pub judges: Judges,
    /// Samples so far.
    pub samples: u64,
    setting: Setting,
    population: Population,
    rollout: Rollout,
    judged: Vec<f32>,
    model: Model,
    scaling: ActionScaling,
    terrain_metres: f32,
}

/// What an iteration measured.
#[derive(Clone, Copy, Debug, Default)]
pub struct IterationReport {
    /// Episodes and task reward.
    pub population: PopulationReport,
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
    /// Geometric mean of the rates of the actors' Adam.
    pub actor_rate: f32,
    /// Seconds of rollout, gradient steps and discriminators.
    pub secs: [f32; 3],
}

impl Training {
    /// Starts a run.
    #[must_use]
    pub fn new(recipe: Recipe, model: &Model, normalisers: Normalisers, parts: Parts, seed: u64) -> Self {
        let Parts { course, learner, judges, start_demonstrations, recovery } = parts;
        let shape = (recipe.environment.steps, recipe.environment.characters);
        let (low, high) = model.joint_limits();
        let scaling = ActionScaling::from_joint_limits(low, high).expect("a loaded model has finite limits");
        let demonstrations = judges.demonstrations();
        let environment = recipe.environment_at(0);
        let task = recipe.phase_at(0).1.task;
        let setting = Setting { environment, task, course, start_demonstrations, recovery, normalisers };
        let stage = setting.stage(&demonstrations);
        let population = Population::new(std::slice::from_ref(model), &scaling, &stage, seed);
        Self {
            rollout: Rollout::new(shape, (POLICY_INPUT_LEN, stage.critic_inputs()), DOF_COUNT),
            judged: vec![0.0; shape.0 * shape.1 * DISCRIMINATOR_INPUT_LEN],
            samples: 0,
            recipe,
            learner,
            judges,
            population,
            setting,
            model: model.clone(),
            scaling,
            terrain_metres: 0.0,
        }
    }

    /// Networks that learn, with their optimisers, by their roles in a checkpoint: `actor`, its running mean `average`,
    /// `discriminator`, `critic`; where skills are trained together all but the last have the skill's name before them,
    /// with a dot.
    pub fn networks_mut(&mut self) -> Vec<(String, &mut Network, Option<&mut Adam>)> {
        let together = !self.recipe.paths.is_empty();
        let last = self.setting.course.nodes().len() - 1;
        let mut all = Vec::new();
        let halfway = self.judges.halfway().to_vec();
        let (judges, between) = self.judges.judges.split_at_mut(last + 1);
        let nodes = self.setting.course.nodes().iter().zip(self.learner.actors.iter_mut().zip(judges));
        for (i, (node, (actor, judge))) in nodes.enumerate() {
            let role = |what: &str| if together { format!("{}.{what}", node.name) } else { what.to_owned() };
            if together || i == last {
                all.push((role("actor"), &mut actor.network, Some(&mut actor.adam)));
                all.push((role(AVERAGE), &mut actor.average, None));
            }
            if let Some(d) = &mut judge.discriminator {
                let what = if together || i == last { "discriminator" } else { PARENT_DISCRIMINATOR };
                all.push((role(what), &mut d.network, Some(&mut d.adam)));
            }
        }
        for (edge, judge) in halfway.iter().zip(between) {
            let [from, to] =
                self.setting.course.edges()[*edge].map(|node| &self.setting.course.nodes()[node].name);
            if let Some(d) = &mut judge.discriminator {
                all.push((format!("{from}-{to}.discriminator"), &mut d.network, Some(&mut d.adam)));
            }
        }
        all.push(("critic".to_owned(), &mut self.learner.critic, Some(&mut self.learner.critic_adam)));
        all
    }

    /// What characters move along.
    #[must_use]
    pub fn course(&self) -> &Course {
        &self.setting.course
    }

    /// Puts the characters on the ground of the phase that is on, when it has changed.
    fn choose_ground(&mut self) -> Result<(), ModelError> {
        let metres = self.recipe.phase_at(self.samples).1.terrain_metres;
        if metres == self.terrain_metres {
            return Ok(());
        }
        self.terrain_metres = metres;
        let mut grounds = vec![self.model.clone()];
        for seed in (1..4).filter(|_| metres > 0.0) {
            let terrain = Terrain::Wavy { height_m: metres, wavelength_m: 6.0, seed };
            grounds.push(self.model.with_terrain(terrain)?);
        }
        let demonstrations = self.judges.demonstrations();
        let stage = self.setting.stage(&demonstrations);
        self.population = Population::new(&grounds, &self.scaling, &stage, self.samples);
        Ok(())
    }

    /// One rollout and the gradient steps after it.
    ///
    /// # Errors
    /// When the model can't be set on the terrain of the phase.
    pub fn iterate(&mut self) -> Result<IterationReport, ModelError> {
        self.choose_ground()?;
        let phase = self.recipe.phase_at(self.samples).1;
        self.learner.config.deviation = phase.deviation.unwrap_or(self.recipe.ppo.deviation);
        self.learner.config.guide = phase.guide;
        self.setting.environment = self.recipe.environment_at(self.samples);
        self.setting.task = phase.task;
        let start = std::time::Instant::now();
        self.roll_out();
        let rolled = start.elapsed();
        let (style, discriminator) = self.judge();
        let judged = start.elapsed();
        self.learner.compute_returns(&mut self.rollout);
        let update = self.learner.update(&self.rollout);
        self.samples += self.rollout.rows() as u64;
        let rows = self.rollout.rows() as f32;
        Ok(IterationReport {
            population: std::mem::take(&mut self.population.report),
            style,
            reward: self.rollout.rewards.iter().sum::<f32>() / rows,
            update,
            discriminator,
            distance: self.learner.distance_to_parent(),
            actor_rate: self.learner.actor_rate(),
            secs: [
                rolled.as_secs_f32(),
                (start.elapsed() - judged).as_secs_f32(),
                (judged - rolled).as_secs_f32(),
            ],
        })
    }

    fn roll_out(&mut self) {
        let n = self.rollout.characters;
        let demonstrations = self.judges.demonstrations();
        let stage = self.setting.stage(&demonstrations);
        let width = stage.critic_inputs();
        self.rollout.clear();
        let guided = self.learner.config.guide > 0.0;
        self.rollout.guides.resize(if guided { self.rollout.actions.len() } else { 0 }, f32::NAN);
        for step in 0..self.rollout.steps {
            let rows = step * n..(step + 1) * n;
            self.rollout.critic_inputs[rows.start * width..rows.end * width]
                .copy_from_slice(&self.population.inputs);
            let seen = self.population.inputs.chunks_exact(width).zip(self.population.agents());
            for (row, (input, agent)) in rows.clone().zip(seen) {
                if guided {
                    let out = &mut self.rollout.guides[row * DOF_COUNT..(row + 1) * DOF_COUNT];
                    agent.guide_into(&stage, &self.scaling, out);
                }
                let at = row * POLICY_INPUT_LEN;
                self.rollout.inputs[at..at + POLICY_INPUT_LEN].copy_from_slice(&input[..POLICY_INPUT_LEN]);
                self.rollout.edge[row] = agent.command.place.edge;
                self.rollout.blend[row] = agent.command.place.t;
                self.rollout.quiet[row] = agent.is_quiet();
            }
            self.learner.act(&mut self.rollout, step);
            let actions = &self.rollout.actions[rows.start * DOF_COUNT..rows.end * DOF_COUNT];
            let judged =
                &mut self.judged[rows.start * DISCRIMINATOR_INPUT_LEN..rows.end * DISCRIMINATOR_INPUT_LEN];
            self.population.step(&stage, actions, judged);
            self.rollout.record(step, self.population.ends(), &self.population.inputs_after);
            let at = self.rollout.edge[rows.clone()].iter().zip(&self.rollout.blend[rows.clone()]);
            let rewards = self.rollout.rewards[rows].iter_mut().zip(self.population.terms());
            for (((reward, terms), end), (edge, t)) in rewards.zip(self.population.ends()).zip(at) {
                *reward = self.setting.reward(Place { edge: *edge, t: *t }, terms, *end);
            }
        }
        self.rollout.last_critic_inputs.copy_from_slice(&self.population.inputs);
    }

    /// Adds the style reward, by the weight that the others leave, to the rewards that are there and teaches the judges; returns the mean style.
    fn judge(&mut self) -> (f32, DiscriminatorReport) {
        let places = (&self.rollout.edge[..], &self.rollout.blend[..]);
        let style = self.judges.style(&self.setting.course, places, &self.judged);
        let at = places.0.iter().zip(places.1).map(|(edge, t)| Place { edge: *edge, t: *t });
        for ((reward, style), place) in self.rollout.rewards.iter_mut().zip(style).zip(at) {
            *reward += self.setting.style_share(place) * style;
        }
        let mean = style.iter().sum::<f32>() / style.len() as f32;
        (mean, self.judges.learn(&self.setting.course, places, &self.judged))
    }
}
