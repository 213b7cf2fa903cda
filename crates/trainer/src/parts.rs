//! What a run starts from: the networks, clips and course of a recipe, put together from the checkpoints of its parents.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use policy_core::{Controller, ControllerConfig, DOF_COUNT, POLICY_INPUT_LEN};

use crate::Rng;
use crate::amp::DiscriminatorLearner;
use crate::checkpoint::Checkpoint;
use crate::env::{Course, CourseNode, Demonstrations, Recovery};
use crate::nn::Network;
use crate::pack::{Ingredient, PackPlan, bind};
use crate::ppo::{Actor, Learner};
use crate::recipe::Recipe;
use crate::style::{Judge, Judges};
use crate::training::{POLICY_HIDDEN, Parts};
use crate::workplace::Workplace;

/// Plan of the pack, in the folder of recipes.
const PLAN: &str = "pack/humanoid.toml";

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

impl Workplace {
    /// What a recipe starts from.
    pub(crate) fn parts(&self, recipe: &Recipe, seed: u64) -> Result<Parts> {
        if recipe.paths.is_empty() { self.skill_parts(recipe, seed) } else { self.joint_parts(recipe, seed) }
    }

    /// Where a trained skill is: in its own run, else in one that trained it together with others.
    fn trained(&self, name: &str) -> Result<Option<(Checkpoint, PathBuf)>> {
        let own = self.newest(name);
        if own.exists() {
            return Ok(Some((Checkpoint::load(&own)?, own)));
        }
        for recipe in self.recipes_in_order()?.iter().filter(|r| r.paths.iter().flatten().any(|n| n == name))
        {
            let path = self.newest(&recipe.skill);
            if path.exists() {
                return Ok(Some((Checkpoint::load(&path)?, path)));
            }
        }
        Ok(None)
    }

    fn skill(&self, name: &str, needed_by: &str) -> Result<Skill> {
        let (checkpoint, path) = self
            .trained(name)?
            .with_context(|| format!("{needed_by} starts from {name}, which is not trained yet"))?;
        let Ingredient { actor, discriminator, .. } = Ingredient::from_checkpoint(name, &checkpoint, &path)?;
        let recipe = self.recipe(name)?;
        Ok(Skill {
            actor,
            critic: checkpoint.network("critic", &path)?.network.clone(),
            discriminator,
            demonstrations: self.demonstrations(&recipe)?,
            recipe,
        })
    }

    /// One skill: from random parameters, or from its parent's and pulled towards them.
    fn skill_parts(&self, recipe: &Recipe, seed: u64) -> Result<Parts> {
        let mut rng = Rng::new(seed, 1);
        let mut nodes = vec![CourseNode::new(&recipe.skill, &recipe.environment, EDGE_SHARES[1])];
        let learning = DiscriminatorLearner::new(recipe.discriminator.clone(), None, seed, 2);
        let own = Judge { demonstrations: self.demonstrations(recipe)?, discriminator: Some(learning) };
        let mut start_demonstrations = self.start_clips(recipe)?;
        let (actors, critic, judges, path) = match &recipe.parent {
            None => {
                let sizes = [POLICY_INPUT_LEN, POLICY_HIDDEN[0], POLICY_HIDDEN[1], DOF_COUNT];
                let actor = Actor::learning(Network::new(&sizes, 0.01, &mut rng), None);
                let critic = Network::new(&critic_sizes(recipe, 1), 0.1, &mut rng);
                (vec![actor], critic, vec![own], vec![0])
            }
            Some(parent) => {
                let parent = self.skill(parent, &recipe.skill)?;
                let before = &parent.recipe;
                nodes.insert(0, CourseNode::new(&before.skill, &before.environment, EDGE_SHARES[0]));
                let actors =
                    vec![Actor::frozen(parent.actor.clone()), Actor::learning(parent.actor, Some(0))];
                let sizes = critic_sizes(recipe, 1);
                let fits = parent.critic.sizes() == sizes;
                let critic = if fits { parent.critic } else { Network::new(&sizes, 0.1, &mut rng) };
                let config = recipe.discriminator.clone();
                let known = Some(parent.discriminator);
                let discriminator = recipe.edge.then(|| DiscriminatorLearner::new(config, known, seed, 3));
                start_demonstrations.get_or_insert_with(|| parent.demonstrations.clone());
                let judge = Judge { demonstrations: parent.demonstrations, discriminator };
                (actors, critic, vec![judge, own], if recipe.edge { vec![0, 1] } else { vec![1] })
            }
        };
        let course = Course::new(nodes, vec![path]);
        let learner = Learner::new(recipe.ppo.clone(), actors, course.edges().to_vec(), critic, rng);
        let judges = Judges::new(judges, Vec::new());
        Ok(Parts { course, learner, judges, start_demonstrations, recovery: None })
    }

    /// All skills of some paths together, none of them frozen.
    fn joint_parts(&self, recipe: &Recipe, seed: u64) -> Result<Parts> {
        let mut names: Vec<&String> = Vec::new();
        for name in recipe.paths.iter().flatten() {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let index = |name: &String| names.iter().position(|n| *n == name);
        let (mut nodes, mut actors, mut root) = (Vec::new(), Vec::new(), None);
        let mut judges: Vec<Judge> = Vec::new();
        for (i, name) in names.iter().enumerate() {
            let skill = self.skill(name, &recipe.skill)?;
            let task = skill.recipe.phases.last().map_or(1.0, |phase| phase.task);
            let pelvis_metres = skill.demonstrations.pelvis_metres();
            let node = CourseNode::new(name, &skill.recipe.environment, 1.0);
            nodes.push(CourseNode { task, pelvis_metres, ..node });
            let parent = skill.recipe.parent.as_ref().and_then(index);
            let frozen = recipe.frozen.contains(name);
            actors.push(Actor { frozen, ..Actor::learning(skill.actor, parent) });
            let known = Some(skill.discriminator);
            let learner = DiscriminatorLearner::new(recipe.discriminator.clone(), known, seed, 10 + i as u64);
            judges.push(Judge { demonstrations: skill.demonstrations, discriminator: Some(learner) });
            if skill.recipe.parent.is_none() {
                root = Some(skill.critic);
            }
        }
        let paths = recipe.paths.iter().map(|p| p.iter().filter_map(index).collect()).collect();
        let course = Course::new(nodes, paths);
        let mut halfway = Vec::new();
        for ends in &recipe.halfway {
            let edge = ends.each_ref().map(index);
            let edge = course.edges().iter().position(|e| e.map(Some) == edge);
            let edge = edge.with_context(|| {
                format!("expected an edge of the paths in halfway, found {} to {}", ends[0], ends[1])
            })?;
            halfway.push(edge);
            let known = judges[course.edges()[edge][1]].discriminator.as_ref().map(|d| d.network.clone());
            let seed = seed.wrapping_add(halfway.len() as u64);
            let learner = DiscriminatorLearner::new(recipe.discriminator.clone(), known, seed, 30);
            judges.push(Judge { demonstrations: self.halfway_clip(ends)?, discriminator: Some(learner) });
        }
        let sizes = critic_sizes(recipe, course.context_len());
        let mut rng = Rng::new(seed, 1);
        let critic = match root {
            Some(root) if root.sizes() == sizes => root,
            Some(root) if root.inputs() == POLICY_INPUT_LEN + 1 && root.sizes()[1..] == sizes[1..] => {
                widened(&root, &course)
            }
            _ => Network::new(&sizes, 0.1, &mut rng),
        };
        ensure!(critic.sizes() == sizes, "expected a critic of sizes {sizes:?}, found {:?}", critic.sizes());
        let learner = Learner::new(recipe.ppo.clone(), actors, course.edges().to_vec(), critic, rng);
        let start_demonstrations = self.start_clips(recipe)?;
        let recovery = match &recipe.environment.start.after {
            Some(after) => Some(self.recovery(&after.skill, &course)?),
            None => None,
        };
        let judges = Judges::new(judges, halfway);
        Ok(Parts { course, learner, judges, start_demonstrations, recovery })
    }

    /// An episodic skill of the pack's plan, ready to raise characters.
    fn recovery(&self, name: &str, course: &Course) -> Result<Recovery> {
        let plan = PackPlan::load(&self.recipes.join(PLAN))?;
        let skill = plan.skills.iter().find(|s| s.name == name).cloned();
        let skill = skill.with_context(|| format!("expected an episodic skill of {PLAN}, found {name}"))?;
        let node = course.nodes().iter().position(|node| node.name == skill.returns_to);
        let node = node.with_context(|| {
            format!("{name}: expected to return to a skill of the paths, found {}", skill.returns_to)
        })?;
        let needed =
            |n: &str| n == skill.policy || n == skill.returns_to || Some(n) == skill.discriminator.as_deref();
        let mut plan = plan.only(needed);
        plan.skills.retain(|s| s.name == name);
        let mut ingredients = Vec::new();
        for policy in &plan.policies {
            let (checkpoint, path) = self.trained(&policy.name)?.with_context(|| {
                format!("starts after {name} need {}, which is not trained yet", policy.name)
            })?;
            ingredients.push(Ingredient::from_checkpoint(&policy.name, &checkpoint, &path)?);
        }
        let pack = Arc::new(bind(&plan, &ingredients, &self.normalisers, &self.model)?);
        let config = ControllerConfig { recover: false, ..ControllerConfig::default() };
        Ok(Recovery { controller: Controller::with_config(pack, config), skill: 0, node })
    }

    /// The faster skill's first clip, half-way to a pose of the slower one's.
    fn halfway_clip(&self, ends: &[String; 2]) -> Result<Demonstrations> {
        let mut recipes = [self.recipe(&ends[0])?, self.recipe(&ends[1])?];
        recipes.sort_by(|a, b| a.environment.speed_mps.total_cmp(&b.environment.speed_mps));
        let [slow, fast] = recipes.map(|recipe| self.clips.load(&recipe.clips[0].name));
        let clip = fast?.towards(&slow?, 0.5);
        Ok(Demonstrations::from_clips(&[(clip, 1.0, true)], &self.model, &self.normalisers.frame)?)
    }

    /// Clips that a recipe names for starts.
    fn start_clips(&self, recipe: &Recipe) -> Result<Option<Demonstrations>> {
        let names = &recipe.environment.start.clips;
        let named = names.iter().map(|name| (name.as_str(), 1.0, true));
        (!names.is_empty()).then(|| self.clips_ready(named)).transpose()
    }
}

fn critic_sizes(recipe: &Recipe, context_len: usize) -> Vec<usize> {
    let mut sizes = vec![POLICY_INPUT_LEN + context_len];
    sizes.extend_from_slice(&recipe.ppo.critic_hidden);
    sizes.push(1);
    sizes
}

/// A critic of one blend weight, which was always 1, as a critic of the weights of many nodes, which sum to 1: every
/// node's weight does what the one did, and where the place is going does nothing yet.
fn widened(critic: &Network, course: &Course) -> Network {
    let mut sizes = critic.sizes().to_vec();
    sizes[0] = POLICY_INPUT_LEN + course.context_len();
    let mut wide = Network::zeros(&sizes);
    let (from, to) = (critic.layers(), wide.layers());
    let policy = POLICY_INPUT_LEN * from[0].outputs;
    let old = &critic.parameters[from[0].weight.clone()];
    let new = &mut wide.parameters[to[0].weight.clone()];
    new[..policy].copy_from_slice(&old[..policy]);
    let places = new[policy..].chunks_exact_mut(from[0].outputs).take(course.place_len());
    places.for_each(|row| row.copy_from_slice(&old[policy..]));
    let rest = wide.parameters.len() - to[0].weight.end;
    wide.parameters[to[0].weight.end..].copy_from_slice(&critic.parameters[critic.parameters.len() - rest..]);
    wide
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::env::EnvironmentConfig;
    use crate::nn::Pass;

    #[test]
    fn a_widened_critic_says_what_it_said() {
        let mut rng = Rng::new(1, 0);
        let critic = Network::new(&[POLICY_INPUT_LEN + 1, 8, 1], 1.0, &mut rng);
        let node = |name: &str| CourseNode::new(name, &EnvironmentConfig::default(), 1.0);
        let course = Course::new(["a", "b", "c"].map(node).to_vec(), vec![vec![0, 1, 2]]);
        let wide = widened(&critic, &course);
        let mut input: Vec<f32> = (0..POLICY_INPUT_LEN).map(|_| rng.normal()).collect();
        let mut of_wide = input.clone();
        input.push(1.0);
        of_wide.extend_from_slice(&[0.25, 0.0, 0.75, 1.5, -2.0, 1.0]);
        let (mut a, mut b) = (Pass::new(critic.sizes(), 1), Pass::new(wide.sizes(), 1));
        a.forward(&critic, None, &input);
        b.forward(&wide, None, &of_wide);
        assert!((a.output(1)[0] - b.output(1)[0]).abs() < 1e-4);
    }
}
