//! The part of the policy graph that a run trains: nodes, each with a policy of its own, and paths through them.

use super::command::INTENT_LEN;
use super::config::EnvironmentConfig;
use super::termination::TerminationRule;
use crate::Rng;

/// A node of a graph.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphNode {
    /// Name of its skill.
    pub name: String,
    /// Speed that its policy is commanded to, metres per second.
    pub speed_mps: f32,
    /// Least scale of the reward for its speed, metres per second.
    pub speed_scale_mps: f32,
    /// Early-termination threshold of its clips' tracking, metres.
    pub max_tracking_error_metres: f32,
    /// What counts as a failure at it.
    pub termination: TerminationRule,
    /// How often episodes rest at it, relative to the other nodes of a path.
    pub share: f32,
    /// Factor on the weight of the task reward.
    pub task: f32,
    /// Mean height of the root above the ground in its clips, metres.
    pub root_metres: f32,
    /// Least seconds to cross its edges; the longer time of the two ends holds.
    pub edge_secs: f32,
}

impl GraphNode {
    /// The node of a skill with these settings.
    #[must_use]
    pub fn new(name: &str, config: &EnvironmentConfig, share: f32) -> Self {
        Self {
            name: name.into(),
            speed_mps: config.command.speed_mps,
            speed_scale_mps: config.reward.speed_scale_mps,
            max_tracking_error_metres: config.termination.max_tracking_error_metres,
            termination: TerminationRule::of(&config.termination),
            share,
            task: 1.0,
            root_metres: 0.0,
            edge_secs: config.command.edge_secs,
        }
    }
}

/// Nodes, paths and the edges under them.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingGraph {
    nodes: Vec<GraphNode>,
    paths: Vec<Vec<usize>>,
    edges: Vec<[usize; 2]>,
}

/// A position on the graph.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GraphPosition {
    /// Index of the edge.
    pub edge: usize,
    /// Blend weight: 0 at the edge's first node, 1 at its second.
    pub t: f32,
}

impl TrainingGraph {
    /// The graph of these paths. A path of one node is that node alone.
    ///
    /// # Panics
    /// When there is no path, a path is empty, or names a node that is not there.
    #[must_use]
    pub fn new(nodes: Vec<GraphNode>, paths: Vec<Vec<usize>>) -> Self {
        assert!(!paths.is_empty(), "a graph has a path");
        assert!(paths.iter().flatten().all(|n| *n < nodes.len()), "nodes of the paths");
        let mut edges: Vec<[usize; 2]> = Vec::new();
        for path in &paths {
            let alone = [path[0], *path.last().expect("a path has nodes")];
            let joined = path.windows(2).map(|p| [p[0], p[1]]);
            for edge in joined.chain((path.len() == 1).then_some(alone)) {
                if !edges.contains(&edge) {
                    edges.push(edge);
                }
            }
        }
        Self { nodes, paths, edges }
    }

    /// Nodes, by index.
    #[must_use]
    pub fn nodes(&self) -> &[GraphNode] {
        &self.nodes
    }

    /// Replaces a node's settings.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn set_node(&mut self, index: usize, node: GraphNode) {
        self.nodes[index] = node;
    }

    /// Edges, by index.
    #[must_use]
    pub fn edges(&self) -> &[[usize; 2]] {
        &self.edges
    }

    /// Nodes of a path.
    ///
    /// # Panics
    /// When there is no such path.
    #[must_use]
    pub fn path(&self, path: usize) -> &[usize] {
        &self.paths[path]
    }

    /// Number of paths.
    #[must_use]
    pub fn paths(&self) -> usize {
        self.paths.len()
    }

    /// Greatest coordinate of a path.
    #[must_use]
    pub fn end(&self, path: usize) -> f32 {
        (self.paths[path].len() - 1) as f32
    }

    /// The position of a coordinate of a path, clamped to it.
    #[must_use]
    pub fn position(&self, path: usize, coordinate: f32) -> GraphPosition {
        let nodes = &self.paths[path];
        let segment = (coordinate.max(0.0) as usize).min(nodes.len().saturating_sub(2));
        let ends = [nodes[segment], nodes[(segment + 1).min(nodes.len() - 1)]];
        let edge = self.edges.iter().position(|e| *e == ends).unwrap_or_default();
        let t = if ends[0] == ends[1] { 1.0 } else { (coordinate - segment as f32).clamp(0.0, 1.0) };
        GraphPosition { edge, t }
    }

    /// A random coordinate of a path: half of them at a node, by the nodes' shares, half anywhere.
    pub fn draw(&self, path: usize, rng: &mut Rng) -> f32 {
        if rng.chance(0.5) { rng.uniform() * self.end(path) } else { self.draw_node(path, rng) }
    }

    /// The coordinate of a random node of a path, by the nodes' shares.
    pub fn draw_node(&self, path: usize, rng: &mut Rng) -> f32 {
        let nodes = &self.paths[path];
        let total: f32 = nodes.iter().map(|n| self.nodes[*n].share).sum();
        let mut left = rng.uniform() * total;
        let drawn = nodes.iter().position(|n| {
            left -= self.nodes[*n].share;
            left < 0.0
        });
        drawn.unwrap_or(nodes.len() - 1) as f32
    }

    /// Commanded speed, metres per second.
    #[must_use]
    pub fn speed_mps(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.speed_mps)
    }

    /// Least width of the reward for the speed, metres per second.
    #[must_use]
    pub fn speed_scale_mps(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.speed_scale_mps)
    }

    /// Height of the root above the ground, metres.
    #[must_use]
    pub fn root_metres(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.root_metres)
    }

    /// Least seconds to cross the edge towards `asked`, 0 for no limit. The factors, to a faster position and to a slower
    /// one, count where both ends are fully upright.
    #[must_use]
    pub fn edge_secs(&self, position: GraphPosition, asked: GraphPosition, factors: [f32; 2]) -> f32 {
        let ends = self.edges[position.edge].map(|node| &self.nodes[node]);
        let secs = ends[0].edge_secs.max(ends[1].edge_secs);
        let upright = ends.iter().all(|node| node.termination == TerminationRule::Upright(1.0));
        let slower = self.speed_mps(asked) <= self.speed_mps(position);
        if upright { secs * factors[usize::from(slower)] } else { secs }
    }

    /// Factor on the weight of the task reward.
    #[must_use]
    pub fn task(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.task)
    }

    /// What counts as a failure.
    #[must_use]
    pub fn termination(&self, position: GraphPosition) -> TerminationRule {
        TerminationRule::between(
            self.edges[position.edge].map(|node| self.nodes[node].termination),
            position.t,
        )
    }

    /// The node that a position is at, if it is not between two.
    #[must_use]
    pub fn node_at(&self, position: GraphPosition) -> Option<usize> {
        let end = [0.0, 1.0].iter().position(|t| *t == position.t)?;
        Some(self.edges[position.edge][end])
    }

    /// The node that weighs most.
    #[must_use]
    pub fn nearest(&self, position: GraphPosition) -> usize {
        self.edges[position.edge][usize::from(position.t >= 0.5)]
    }

    /// Blend weight of a node.
    #[must_use]
    pub fn weight(&self, position: GraphPosition, node: usize) -> f32 {
        let [from, to] = self.edges[position.edge];
        let part = |end: usize, weight: f32| if end == node { weight } else { 0.0 };
        if from == to { part(to, 1.0) } else { part(from, 1.0 - position.t) + part(to, position.t) }
    }

    fn between(&self, position: GraphPosition, of: impl Fn(&GraphNode) -> f32) -> f32 {
        let [from, to] = self.edges[position.edge].map(|node| of(&self.nodes[node]));
        from + position.t * (to - from)
    }

    /// Length of a position in the critic's input: the blend weight, or with more than two nodes the weight of each.
    #[must_use]
    pub fn position_len(&self) -> usize {
        if self.nodes.len() <= 2 { 1 } else { self.nodes.len() }
    }

    /// Length of what a critic sees beside the policy's input: the position and, with several edges, where it is going and
    /// whether a clip is tracked there.
    #[must_use]
    pub fn context_len(&self) -> usize {
        self.position_len() + if self.edges.len() > 1 { INTENT_LEN + 1 } else { 0 }
    }

    /// Writes the numbers of [`TrainingGraph::position_len`].
    pub fn position_into(&self, position: GraphPosition, out: &mut [f32]) {
        match out {
            [one] => *one = position.t,
            weights => weights.iter_mut().enumerate().for_each(|(i, w)| *w = self.weight(position, i)),
        }
    }
}

#[cfg(test)]
#[path = "graph_tests.rs"]
mod tests;
