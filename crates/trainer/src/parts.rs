//! What a run starts from: networks, clips and graph of a recipe, from the checkpoints of its parents.

use std::path::PathBuf;

use anyhow::{Context, Result, anyhow, ensure};
use policy_core::Skeleton;
use random::Rng;

use crate::amp::DiscriminatorLearner;
use crate::checkpoint::{CRITIC, Checkpoint};
use crate::env::{Demonstrations, GraphNode, TerminationHeights, TrainingGraph, mirror_of};
use crate::nn::Network;
use crate::pack::TrainedSkill;
use crate::ppo::{Actor, Learner};
use crate::recipe::{ClipShare, Phase, Recipe};
use crate::style::{Discriminators, NodeDiscriminator};
use crate::training::{POLICY_HIDDEN, Parts, PhaseBodies};
use crate::workspace::Workspace;

mod company;
mod joint;

/// How often episodes of an edge rest at the parent and at the child.
const EDGE_SHARES: [f32; 2] = [0.3, 0.7];

/// A skill that is trained already.
struct Skill {
    recipe: Recipe,
    actor: Network,
    critic: Network,
    discriminator: Network,
    demonstrations: Demonstrations,
}

impl Workspace {
    /// What a recipe starts from.
    pub(crate) fn parts(&self, recipe: &Recipe, seed: u64) -> Result<Parts> {
        let mut parts = if recipe.paths.is_empty() {
            self.skill_parts(recipe, seed)
        } else {
            self.joint_parts(recipe, seed)
        }?;
        if recipe.phases.iter().any(|phase| phase.ppo.symmetry > 0.0) {
            let timed = recipe.first().environment.command.clock_seconds > 0.0;
            let mirror = mirror_of(self.model.skeleton(), &self.normalisers.observation, timed);
            parts.learner.mirror =
                Some(mirror.with_context(|| format!("{}: ppo.symmetry needs a mirror image", recipe.skill))?);
        }
        Ok(parts)
    }

    /// Where a trained skill is: in the run that parents are to come from, in its own run, else in one that trained it together with others.
    pub(crate) fn trained(&self, name: &str) -> Result<Option<(Checkpoint, PathBuf)>> {
        if let Some(together) = self.parents.as_ref().map(|run| self.newest(run)).transpose()?.flatten()
            && TrainedSkill::is_in(name, &together.0)
        {
            return Ok(Some(together));
        }
        if let Some(own) = self.newest(name)? {
            return Ok(Some(own));
        }
        for recipe in self.recipes_in_order()?.iter().filter(|r| r.paths.iter().flatten().any(|n| n == name))
        {
            if let Some(together) = self.newest(&recipe.skill)? {
                return Ok(Some(together));
            }
        }
        Ok(None)
    }

    fn skill(&self, name: &str, needed_by: &str) -> Result<Skill> {
        let (checkpoint, path) = self
            .trained(name)?
            .with_context(|| format!("{needed_by} starts from {name}, which is not trained yet"))?;
        let TrainedSkill { actor, discriminator, .. } =
            TrainedSkill::from_checkpoint(name, &checkpoint, &path)?;
        let recipe = self.recipe(name)?;
        ensure!(!recipe.clips.is_empty(), "expected {name} to have clips of its own, found a joint recipe");
        Ok(Skill {
            actor,
            critic: checkpoint.network(CRITIC, &path)?.network.clone(),
            discriminator,
            demonstrations: self.demonstrations(&recipe)?,
            recipe,
        })
    }

    /// One skill: from random parameters, or from its parent's and pulled towards them.
    fn skill_parts(&self, recipe: &Recipe, seed: u64) -> Result<Parts> {
        let mut rng = Rng::new(seed, 1);
        let skeleton = self.model.skeleton();
        let scored = skeleton.discriminator_input_len();
        let demonstrations = self.demonstrations(recipe)?;
        let root_metres = demonstrations.root_metres();
        let node = GraphNode::new(&recipe.skill, &recipe.last().environment, EDGE_SHARES[1]);
        let mut nodes = vec![GraphNode { root_metres, ..node }];
        let learning = DiscriminatorLearner::new(recipe.first().discriminator.clone(), scored, None, seed, 2);
        let own = NodeDiscriminator { demonstrations, discriminator: Some(learning) };
        let mut start_demonstrations = self.start_clips(recipe)?;
        let (actors, critic, scorers) = match &recipe.parent {
            None => {
                let [first, second] = POLICY_HIDDEN;
                let sizes = [skeleton.policy_input_len(), first, second, skeleton.joint_count()];
                let actor = Actor::learning(Network::new(&sizes, 0.01, &mut rng), None);
                let critic = Network::new(&critic_sizes(skeleton, recipe, 1), 0.1, &mut rng);
                (vec![actor], critic, vec![own])
            }
            Some(parent) => {
                let parent = self.skill(parent, &recipe.skill)?;
                let (skill, before) = (&parent.recipe.skill, &parent.recipe.last().environment);
                let root_metres = parent.demonstrations.root_metres();
                nodes.insert(0, GraphNode { root_metres, ..GraphNode::new(skill, before, EDGE_SHARES[0]) });
                let actors =
                    vec![Actor::frozen(parent.actor.clone()), Actor::learning(parent.actor, Some(0))];
                let sizes = critic_sizes(skeleton, recipe, 1);
                let fits = parent.critic.sizes() == sizes;
                let critic = if fits { parent.critic } else { Network::new(&sizes, 0.1, &mut rng) };
                let config = recipe.first().discriminator.clone();
                let known = Some(parent.discriminator);
                let discriminator =
                    recipe.edge.then(|| DiscriminatorLearner::new(config, scored, known, seed, 3));
                start_demonstrations.get_or_insert_with(|| parent.demonstrations.clone());
                let scorer = NodeDiscriminator { demonstrations: parent.demonstrations, discriminator };
                (actors, critic, vec![scorer, own])
            }
        };
        let factors = recipe.last().environment.command.edge_secs_factors;
        let graph = match nodes.len() {
            2 if recipe.edge => TrainingGraph::along(nodes, &[vec![0, 1]], factors)?,
            count => TrainingGraph::alone(nodes, count - 1)?,
        };
        let learner = Learner::new(recipe.first().ppo.clone(), actors, graph.pairs().to_vec(), critic, rng);
        let discriminators = Discriminators::new(scorers, Vec::new());
        let bodies = bodies(recipe, skeleton)?;
        Ok(Parts {
            graph,
            learner,
            discriminators,
            start_demonstrations,
            hand_over: Vec::new(),
            bodies,
            company: self.company(recipe)?,
        })
    }

    /// Clips that a recipe names for starts.
    fn start_clips(&self, recipe: &Recipe) -> Result<Option<Demonstrations>> {
        let names = &recipe.first().environment.reset.clips;
        let named: Vec<_> = names.iter().map(|name| ClipShare::whole(name)).collect();
        (!named.is_empty()).then(|| self.clips_ready(&named)).transpose()
    }
}

/// Heights that tell standing from lying, and the bodies that are pushed, of each phase.
fn bodies(recipe: &Recipe, skeleton: &Skeleton) -> Result<Vec<PhaseBodies>> {
    let unknown = |field: &'static str| {
        move |name| anyhow!("{}: expected bodies of the character in {field}, found {name}", recipe.skill)
    };
    let of_phase = |Phase { environment, .. }: &Phase| {
        let heights = TerminationHeights::new(&environment.termination, skeleton);
        let pushed = environment.randomisation.pushed(skeleton);
        Ok(PhaseBodies {
            heights: heights.map_err(unknown("min_heights"))?,
            pushed: pushed.map_err(unknown("push_bodies"))?,
        })
    };
    recipe.phases.iter().map(of_phase).collect()
}

/// Sizes of a recipe's critic.
fn critic_sizes(skeleton: &Skeleton, recipe: &Recipe, context_len: usize) -> Vec<usize> {
    let mut sizes = vec![skeleton.policy_input_len() + context_len];
    sizes.extend_from_slice(&recipe.first().ppo.critic_hidden);
    sizes.push(1);
    sizes
}
