//! What a joint run starts from: several skills, each with the networks and clips of its own run.

use anyhow::{Context, Result};
use files::quoted;
use policy_core::{Controller, ControllerConfig, SkillId};
use random::Rng;

use super::company::PLAN;
use super::{bodies, critic_sizes};
use crate::amp::DiscriminatorLearner;
use crate::env::{Demonstrations, GraphNode, HandOver, HandOverConfig, TrainingGraph};
use crate::nn::Network;
use crate::pack::PackPlan;
use crate::ppo::{Actor, Learner};
use crate::recipe::Recipe;
use crate::style::{Discriminators, NodeDiscriminator};
use crate::training::Parts;
use crate::workspace::Workspace;

impl Workspace {
    /// All skills of some paths together.
    pub(super) fn joint_parts(&self, recipe: &Recipe, seed: u64) -> Result<Parts> {
        let mut names: Vec<&String> = Vec::new();
        for name in recipe.paths.iter().flatten() {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let index = |name: &String| names.iter().position(|n| *n == name);
        let skeleton = self.model.skeleton();
        let scored = skeleton.discriminator_input_len();
        let (mut nodes, mut actors, mut root) = (Vec::new(), Vec::new(), None);
        let mut scorers: Vec<NodeDiscriminator> = Vec::new();
        for (i, name) in names.iter().enumerate() {
            let skill = self.skill(name, &recipe.skill)?;
            let root_metres = skill.demonstrations.root_metres();
            let node = GraphNode::new(name, &skill.recipe.last().environment, 1.0);
            let task = skill.recipe.last().environment.reward.task_weight;
            nodes.push(GraphNode { task, root_metres, ..node });
            let parent = skill.recipe.parent.as_ref().and_then(index);
            actors.push(Actor::learning(skill.actor, parent));
            let (config, known) = (recipe.first().discriminator.clone(), Some(skill.discriminator));
            let learner = DiscriminatorLearner::new(config, scored, known, seed, 10 + i as u64);
            scorers.push(NodeDiscriminator {
                demonstrations: skill.demonstrations,
                discriminator: Some(learner),
            });
            if skill.recipe.parent.is_none() {
                root = Some(skill.critic);
            }
        }
        let paths: Vec<Vec<usize>> =
            recipe.paths.iter().map(|p| p.iter().filter_map(index).collect()).collect();
        let factors = recipe.last().environment.command.edge_secs_factors;
        let graph = TrainingGraph::along(nodes, &paths, factors)?;
        let halfway = self.halfway_edges(recipe, &graph, index)?;
        for (count, (ends, edge)) in recipe.halfway.iter().zip(&halfway).enumerate() {
            let [_, to] = graph.pairs()[*edge];
            let known = scorers[to].discriminator.as_ref().map(|d| d.network.clone());
            let (config, seed) = (recipe.first().discriminator.clone(), seed.wrapping_add(count as u64 + 1));
            let discriminator = Some(DiscriminatorLearner::new(config, scored, known, seed, 30));
            let demonstrations = self.halfway_clip(ends)?;
            scorers.push(NodeDiscriminator { demonstrations, discriminator });
        }
        let mut rng = Rng::new(seed, 1);
        let critic =
            joint_critic(root, critic_sizes(skeleton, recipe, graph.context_len()), &graph, &mut rng);
        let learner = Learner::new(recipe.first().ppo.clone(), actors, graph.pairs().to_vec(), critic, rng);
        let start_demonstrations = self.start_clips(recipe)?;
        let starts = &recipe.first().environment.reset.hand_over;
        let hand_over = starts.iter().map(|start| self.hand_over(start, &graph)).collect::<Result<_>>()?;
        let discriminators = Discriminators::new(scorers, halfway);
        let bodies = bodies(recipe, skeleton)?;
        Ok(Parts {
            graph,
            learner,
            discriminators,
            start_demonstrations,
            hand_over,
            bodies,
            company: self.company(recipe)?,
        })
    }

    /// Indices of the edges whose middle has a style of its own.
    fn halfway_edges(
        &self,
        recipe: &Recipe,
        graph: &TrainingGraph,
        index: impl Fn(&String) -> Option<usize>,
    ) -> Result<Vec<usize>> {
        let edge = |ends: &[String; 2]| {
            let wanted = ends.each_ref().map(&index);
            let found = graph.pairs().iter().position(|pair| pair.map(Some) == wanted);
            found.with_context(|| {
                format!("expected an edge of the paths in halfway, found {} to {}", ends[0], ends[1])
            })
        };
        recipe.halfway.iter().map(edge).collect()
    }

    /// An episodic skill of the pack's plan, ready to play.
    fn hand_over(&self, start: &HandOverConfig, graph: &TrainingGraph) -> Result<HandOver> {
        let name = &start.skill;
        let plan = PackPlan::load(&self.recipes.join(PLAN))?;
        let skill = plan.skills.iter().find(|s| s.name == *name).cloned();
        let skill = skill.with_context(|| format!("expected an episodic skill of {PLAN}, found {name}"))?;
        let on_paths = |wanted: &String| {
            let node = graph.nodes().iter().position(|node| node.name == *wanted);
            node.with_context(|| format!("{name}: expected a skill of the paths, found {}", quoted(wanted)))
        };
        let node = on_paths(&skill.returns_to)?;
        let out_of = start.out_of.iter().map(on_paths).collect::<Result<Vec<_>>>()?;
        let needed =
            |n: &str| n == skill.policy || n == skill.returns_to || Some(n) == skill.discriminator.as_deref();
        let mut plan = plan.only(needed);
        plan.skills.retain(|s| s.name == *name);
        let pack = self.pack_of(plan, &format!("starts at the end of {name}"), |_| true)?;
        let config =
            ControllerConfig { auto_recover: false, assist_rise: false, ..ControllerConfig::unassisted() };
        let controller = Controller::with_config(pack, config);
        Ok(HandOver { controller, skill: SkillId::new(0), node, out_of })
    }

    /// The faster skill's first clip, half-way to a pose of the slower one's.
    fn halfway_clip(&self, ends: &[String; 2]) -> Result<Demonstrations> {
        let mut recipes = [self.recipe(&ends[0])?, self.recipe(&ends[1])?];
        let speed = |recipe: &Recipe| recipe.last().environment.command.speed_mps;
        recipes.sort_by(|a, b| speed(a).total_cmp(&speed(b)));
        let first = |recipe: &Recipe| {
            let clip = recipe.clips.first();
            let clip = clip.with_context(|| format!("expected a clip of {}, found none", recipe.skill))?;
            anyhow::Ok(self.clips.load(&clip.name)?)
        };
        let clip = first(&recipes[1])?.towards(&first(&recipes[0])?, 0.5)?;
        Ok(Demonstrations::from_clips(&[(clip, 1.0, true)], &self.model, &self.normalisers.frame)?)
    }
}

/// The critic of a joint run: that of the root of the graph where it fits or can be widened, else a new one.
fn joint_critic(root: Option<Network>, sizes: Vec<usize>, graph: &TrainingGraph, rng: &mut Rng) -> Network {
    let policy = sizes[0] - graph.context_len();
    match root {
        Some(root) if root.sizes() == sizes => root,
        Some(root) if root.inputs() == policy + 1 && root.sizes()[1..] == sizes[1..] => widened(&root, graph),
        _ => Network::new(&sizes, 0.1, rng),
    }
}

/// A critic of one blend weight, which was always 1, as a critic of the weights of many nodes, which sum to 1. Every node's
/// weight does what the one did; where the position is going does nothing yet.
fn widened(critic: &Network, graph: &TrainingGraph) -> Network {
    let mut sizes = critic.sizes().to_vec();
    let inputs = critic.inputs() - 1;
    sizes[0] = inputs + graph.context_len();
    let mut wide = Network::zeros(&sizes);
    let (from, to) = (critic.layers(), wide.layers());
    let policy = inputs * from[0].outputs;
    let old = &critic.parameters[from[0].weight.clone()];
    let new = &mut wide.parameters[to[0].weight.clone()];
    new[..policy].copy_from_slice(&old[..policy]);
    let positions = new[policy..].chunks_exact_mut(from[0].outputs).take(graph.position_len());
    positions.for_each(|row| row.copy_from_slice(&old[policy..]));
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
        let critic = Network::new(&[226, 8, 1], 1.0, &mut rng);
        let node = |name: &str| GraphNode::new(name, &EnvironmentConfig::default(), 1.0);
        let graph =
            TrainingGraph::along(["a", "b", "c"].map(node).to_vec(), &[vec![0, 1, 2]], [1.0; 2]).unwrap();
        let wide = widened(&critic, &graph);
        let mut input: Vec<f32> = (0..225).map(|_| rng.normal()).collect();
        let mut of_wide = input.clone();
        input.push(1.0);
        of_wide.extend_from_slice(&[0.25, 0.0, 0.75, 1.5, -2.0, 1.0]);
        let (mut a, mut b) = (Pass::new(critic.sizes(), 1), Pass::new(wide.sizes(), 1));
        a.forward(&critic, None, &input);
        b.forward(&wide, None, &of_wide);
        assert!((a.output(1)[0] - b.output(1)[0]).abs() < 1e-4);
    }
}
