//! One iteration of training: rollout, style, returns, gradient steps. The loop around it belongs to the program.

use physics_bridge::{Model, ModelError, Terrain};
use policy_core::{ActionScaling, DISCRIMINATOR_INPUT_LEN, DOF_COUNT, POLICY_INPUT_LEN};

use crate::Rng;
use crate::amp::{DiscriminatorLearner, DiscriminatorReport, style_reward};
use crate::env::{CRITIC_INPUT_LEN, Demonstrations, Normalisers, Population, PopulationReport, Stage};
use crate::nn::Network;
use crate::ppo::{Learner, Rollout, UpdateReport};
use crate::recipe::Recipe;

/// Hidden sizes of every policy.
pub const POLICY_HIDDEN: [usize; 2] = [128, 32];

/// The parent of a skill as training needs it.
#[derive(Clone, Debug)]
pub struct Parent {
    /// Its policy.
    pub actor: Network,
    /// Its critic.
    pub critic: Network,
    /// Its discriminator.
    pub discriminator: Network,
    /// Its clips.
    pub demonstrations: Demonstrations,
}

/// Everything a run of a recipe holds.
#[derive(Debug)]
pub struct Training {
    /// The recipe.
    pub recipe: Recipe,
    /// Actor and critic.
    pub learner: Learner,
    /// Judge of the skill's style.
    pub discriminator: DiscriminatorLearner,
    /// Judge of the parent's style near the parent's end of the edge.
    pub parent_discriminator: Option<DiscriminatorLearner>,
    /// Samples so far.
    pub samples: u64,
    population: Population,
    rollout: Rollout,
    judged: Vec<f32>,
    logits: Vec<f32>,
    demonstrations: Demonstrations,
    parent_demonstrations: Option<Demonstrations>,
    start_demonstrations: Option<Demonstrations>,
    normalisers: Normalisers,
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
    /// Gradient steps of the discriminator.
    pub discriminator: DiscriminatorReport,
    /// Squared distance to the parent's parameters.
    pub distance: f64,
    /// Rate of the actor's Adam.
    pub actor_rate: f32,
    /// Seconds of rollout, gradient steps and discriminator.
    pub secs: [f32; 3],
}

impl Training {
    /// Starts a run from random parameters or from the parent's. `demonstrations` are the skill's own clips and those that
    /// episodes may start from besides.
    #[must_use]
    pub fn new(
        recipe: Recipe,
        model: &Model,
        normalisers: Normalisers,
        (demonstrations, start_demonstrations): (Demonstrations, Option<Demonstrations>),
        parent: Option<Parent>,
        seed: u64,
    ) -> Self {
        let mut rng = Rng::new(seed, 1);
        let mut hidden = vec![CRITIC_INPUT_LEN];
        hidden.extend_from_slice(&recipe.ppo.critic_hidden);
        hidden.push(1);
        let (actor, critic) = match &parent {
            Some(parent) if parent.critic.sizes() == hidden => (parent.actor.clone(), parent.critic.clone()),
            Some(parent) => (parent.actor.clone(), Network::new(&hidden, 0.1, &mut rng)),
            None => {
                let sizes = [POLICY_INPUT_LEN, POLICY_HIDDEN[0], POLICY_HIDDEN[1], DOF_COUNT];
                (Network::new(&sizes, 0.01, &mut rng), Network::new(&hidden, 0.1, &mut rng))
            }
        };
        let frozen = parent.as_ref().map(|p| p.actor.clone());
        let mut learner = Learner::new(recipe.ppo.clone(), actor, critic, frozen, rng);
        learner.along_line = recipe.edge;
        let discriminator = DiscriminatorLearner::new(recipe.discriminator.clone(), None, seed, 2);
        let (judge, parent_demonstrations) = match parent {
            Some(p) => (Some(p.discriminator), Some(p.demonstrations)),
            None => (None, None),
        };
        let parent_discriminator = judge
            .filter(|_| recipe.edge)
            .map(|d| DiscriminatorLearner::new(recipe.discriminator.clone(), Some(d), seed, 3));
        let (steps, count) = (recipe.environment.steps, recipe.environment.characters);
        let (low, high) = model.joint_limits();
        let scaling = ActionScaling::from_joint_limits(low, high).expect("a loaded model has finite limits");
        let stage = Stage {
            config: &recipe.environment,
            demonstrations: &demonstrations,
            start_demonstrations: start_demonstrations.as_ref(),
            normalisers: &normalisers,
            edge: recipe.edge,
        };
        let population = Population::new(std::slice::from_ref(model), &scaling, &stage, seed);
        Self {
            rollout: Rollout::new(steps, count, POLICY_INPUT_LEN, DOF_COUNT),
            judged: vec![0.0; steps * count * DISCRIMINATOR_INPUT_LEN],
            logits: vec![0.0; steps * count],
            samples: 0,
            recipe,
            learner,
            discriminator,
            parent_discriminator,
            population,
            demonstrations,
            parent_demonstrations,
            start_demonstrations,
            normalisers,
            model: model.clone(),
            scaling,
            terrain_metres: 0.0,
        }
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
        let stage = Stage {
            config: &self.recipe.environment,
            demonstrations: &self.demonstrations,
            start_demonstrations: self.start_demonstrations.as_ref(),
            normalisers: &self.normalisers,
            edge: self.recipe.edge,
        };
        self.population = Population::new(&grounds, &self.scaling, &stage, self.samples);
        Ok(())
    }

    /// One rollout and the gradient steps after it.
    ///
    /// # Errors
    /// When the model can't be set on the terrain of the phase.
    pub fn iterate(&mut self) -> Result<IterationReport, ModelError> {
        self.choose_ground()?;
        let start = std::time::Instant::now();
        self.roll_out();
        let rolled = start.elapsed();
        let task_share = self.recipe.phase_at(self.samples).1.task;
        let style = self.judge(task_share);
        let report = self.learn_style();
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
            discriminator: report,
            distance: self.learner.distance_to_parent(),
            actor_rate: self.learner.actor_rate,
            secs: [
                rolled.as_secs_f32(),
                (start.elapsed() - judged).as_secs_f32(),
                (judged - rolled).as_secs_f32(),
            ],
        })
    }

    fn roll_out(&mut self) {
        let n = self.rollout.characters;
        let stage = Stage {
            config: &self.recipe.environment,
            demonstrations: &self.demonstrations,
            start_demonstrations: self.start_demonstrations.as_ref(),
            normalisers: &self.normalisers,
            edge: self.recipe.edge,
        };
        self.rollout.clear();
        for step in 0..self.rollout.steps {
            let rows = step * n..(step + 1) * n;
            let to = rows.start * CRITIC_INPUT_LEN..rows.end * CRITIC_INPUT_LEN;
            self.rollout.critic_inputs[to].copy_from_slice(&self.population.inputs);
            for (i, row) in self.population.inputs.chunks_exact(CRITIC_INPUT_LEN).enumerate() {
                let at = (rows.start + i) * POLICY_INPUT_LEN;
                self.rollout.inputs[at..at + POLICY_INPUT_LEN].copy_from_slice(&row[..POLICY_INPUT_LEN]);
                self.rollout.blend[rows.start + i] = row[POLICY_INPUT_LEN];
            }
            self.learner.act(&mut self.rollout, step);
            let actions = &self.rollout.actions[rows.start * DOF_COUNT..rows.end * DOF_COUNT];
            let judged =
                &mut self.judged[rows.start * DISCRIMINATOR_INPUT_LEN..rows.end * DISCRIMINATOR_INPUT_LEN];
            self.population.step(&stage, actions, judged);
            self.rollout.record(step, self.population.ends(), &self.population.inputs_after);
            for (reward, terms) in self.rollout.rewards[rows].iter_mut().zip(self.population.terms()) {
                *reward = terms.task;
            }
        }
        self.rollout.last_critic_inputs.copy_from_slice(&self.population.inputs);
    }

    /// Mixes the style reward into the task reward that is there; returns the mean style.
    fn judge(&mut self, task_share: f32) -> f32 {
        self.discriminator.logits_into(&self.judged, &mut self.logits);
        let blend = &self.rollout.blend;
        let mut style: Vec<f32> = self.logits.iter().map(|l| style_reward(*l)).collect();
        if let Some(parent) = &mut self.parent_discriminator {
            parent.logits_into(&self.judged, &mut self.logits);
            for ((style, logit), t) in style.iter_mut().zip(&self.logits).zip(blend) {
                *style = t * *style + (1.0 - t) * style_reward(*logit);
            }
        }
        for (reward, style) in self.rollout.rewards.iter_mut().zip(&style) {
            *reward = task_share * *reward + (1.0 - task_share) * style;
        }
        style.iter().sum::<f32>() / style.len() as f32
    }

    fn learn_style(&mut self) -> DiscriminatorReport {
        let blend = &self.rollout.blend;
        let chosen = |keep: &dyn Fn(f32) -> bool| -> Vec<u32> {
            (0..blend.len() as u32).filter(|row| keep(blend[*row as usize])).collect()
        };
        if let (Some(parent), Some(demonstrations)) =
            (&mut self.parent_discriminator, &self.parent_demonstrations)
        {
            parent.update(demonstrations, &self.judged, &chosen(&|t| t < 0.4));
        }
        self.discriminator.update(&self.demonstrations, &self.judged, &chosen(&|t| t > 0.6))
    }
}
