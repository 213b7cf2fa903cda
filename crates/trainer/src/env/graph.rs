//! The part of the policy graph that a run trains: policy-core's graph, and for each node what training needs beside.

use policy_core::training::{GraphError, Path};
use policy_core::{GraphPosition, NodeId, PathId, PolicyGraph};
use random::Rng;

use super::command::{INTENT_LEN, StrafeConfig};
use super::termination::TerminationRule;

mod node;

pub use node::GraphNode;
use node::policy_graph;

/// Nodes, paths and the edges under them.
#[derive(Clone, Debug)]
pub struct TrainingGraph {
    graph: PolicyGraph,
    nodes: Vec<GraphNode>,
    /// Nodes that are trained alone, or the ends of each edge: the pairs of policies that rows act between.
    pairs: Vec<[usize; 2]>,
    /// The node of a run without a path.
    lone: Option<NodeId>,
}

impl TrainingGraph {
    /// A node that is trained alone, beside nodes that nothing acts as.
    ///
    /// # Errors
    /// When a node has a number that no graph can have.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn alone(nodes: Vec<GraphNode>, node: usize) -> Result<Self, GraphError> {
        assert!(node < nodes.len(), "the node that is trained");
        let graph = policy_graph(&nodes, &[], Vec::new(), [1.0; 2])?;
        Ok(Self { graph, nodes, pairs: vec![[node, node]], lone: Some(NodeId::new(node)) })
    }

    /// The graph of these paths. The factors on the seconds of edges, to a faster node and to a slower one, count where both
    /// ends are fully upright.
    ///
    /// # Errors
    /// When there is no path, or one has fewer than two nodes, a node twice in a row, or a node that is not there.
    pub fn along(nodes: Vec<GraphNode>, paths: &[Vec<usize>], factors: [f32; 2]) -> Result<Self, GraphError> {
        let mut pairs: Vec<[usize; 2]> = Vec::new();
        for pair in paths.iter().flat_map(|path| path.windows(2)).map(|pair| [pair[0], pair[1]]) {
            if !pairs.contains(&pair) && !pairs.contains(&[pair[1], pair[0]]) {
                pairs.push(pair);
            }
        }
        if paths.is_empty() || pairs.iter().flatten().any(|node| *node >= nodes.len()) {
            return Err(GraphError::Path { path: "0".into(), from: 0, to: None });
        }
        let named = paths
            .iter()
            .enumerate()
            .map(|(index, path)| (index.to_string(), path.iter().map(|node| NodeId::new(*node)).collect()));
        let graph = policy_graph(&nodes, &pairs, named.collect(), factors)?;
        Ok(Self { graph, nodes, pairs, lone: None })
    }

    /// policy-core's graph, by which positions move.
    #[must_use]
    pub fn policy_graph(&self) -> &PolicyGraph {
        &self.graph
    }

    /// Nodes, by index.
    #[must_use]
    pub fn nodes(&self) -> &[GraphNode] {
        &self.nodes
    }

    /// Replaces what training knows of a node. Its name stays as it is, and the seconds of its edges and its fall height do until
    /// [`TrainingGraph::set_edge_secs_factors`].
    ///
    /// # Panics
    /// When there is no such node.
    pub fn set_node(&mut self, index: usize, node: GraphNode) {
        self.nodes[index] = node;
    }

    /// Sets the seconds of all edges, by what is known of their ends and by these factors, as [`TrainingGraph::along`] does.
    ///
    /// # Panics
    /// When a node has a number that no graph can have, which no checked recipe has.
    pub fn set_edge_secs_factors(&mut self, factors: [f32; 2]) {
        if self.lone.is_some() {
            return;
        }
        let paths = self.graph.paths().iter().map(|path| (path.name().to_owned(), path.nodes().to_vec()));
        let graph = policy_graph(&self.nodes, &self.pairs, paths.collect(), factors);
        self.graph = graph.expect("a graph of the same nodes, with numbers of a checked recipe");
    }

    /// Pairs of policies that rows act between, by index: the ends of each edge, or one node twice.
    #[must_use]
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// Paths; none for a node that is trained alone.
    #[must_use]
    pub fn paths(&self) -> &[Path] {
        self.graph.paths()
    }

    /// Where an episode of this path starts that has coordinate `coordinate`.
    #[must_use]
    pub fn position(&self, path: PathId, coordinate: f32) -> GraphPosition {
        match self.lone {
            Some(node) => GraphPosition::node(node),
            None => self.graph.path(path).position(coordinate),
        }
    }

    /// Greatest coordinate of a path.
    #[must_use]
    pub fn end(&self, path: PathId) -> f32 {
        if self.lone.is_some() { 0.0 } else { self.graph.path(path).end() }
    }

    /// True for a path of more than one node whose first one stands.
    #[must_use]
    pub fn begins_standing(&self, path: PathId) -> bool {
        self.end(path) > 0.0 && self.speed_mps(self.position(path, 0.0)) == 0.0
    }

    /// A random path.
    pub fn sample_path(&self, rng: &mut Rng) -> PathId {
        PathId::new(rng.index(self.graph.paths().len().max(1)))
    }

    /// A random coordinate of a path: half of them at a node, by the nodes' shares, half anywhere.
    pub fn sample(&self, path: PathId, rng: &mut Rng) -> f32 {
        if rng.chance(0.5) { rng.uniform() * self.end(path) } else { self.sample_node(path, rng) }
    }

    /// The coordinate of a random node of a path, by the nodes' shares.
    pub fn sample_node(&self, path: PathId, rng: &mut Rng) -> f32 {
        let Some(nodes) = self.graph.paths().get(path.index()).map(Path::nodes) else { return 0.0 };
        let share = |node: &NodeId| self.nodes[node.index()].share;
        let mut left = rng.uniform() * nodes.iter().map(share).sum::<f32>();
        let drawn = nodes.iter().position(|node| {
            left -= share(node);
            left < 0.0
        });
        drawn.unwrap_or(nodes.len() - 1) as f32
    }

    /// Index of the pair that acts at a position, and the blend weight of its second policy.
    #[must_use]
    pub fn pair_and_blend(&self, position: GraphPosition) -> (usize, f32) {
        let along = |[from, to]: [usize; 2]| position.along(NodeId::new(from), NodeId::new(to));
        let found = self.pairs.iter().enumerate().find_map(|(index, pair)| Some((index, along(*pair)?)));
        // Alone, the node is both ends; its policy is the second one.
        found.map_or((0, 1.0), |(index, t)| (index, if self.lone.is_some() { 1.0 } else { t }))
    }

    /// The position at which a pair acts with a blend weight.
    ///
    /// # Panics
    /// When there is no such pair.
    #[must_use]
    pub fn position_of(&self, pair: usize, t: f32) -> GraphPosition {
        let [from, to] = self.pairs[pair].map(NodeId::new);
        GraphPosition { from, to, t }
    }

    /// Commanded speed, metres per second.
    #[must_use]
    pub fn speed_mps(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.speed_mps)
    }

    /// By how much a character strafes at a position, in [0, 1], and how.
    #[must_use]
    pub fn strafe(&self, position: GraphPosition) -> (f32, Option<StrafeConfig>) {
        let how = [position.from, position.to].iter().find_map(|node| self.nodes[node.index()].strafe);
        (self.between(position, |node| f32::from(u8::from(node.strafe.is_some()))), how)
    }

    /// Least scale of the reward for the speed, metres per second.
    #[must_use]
    pub fn speed_scale_mps(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.speed_scale_mps)
    }

    /// Height of the root above the ground, metres.
    #[must_use]
    pub fn root_metres(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.root_metres)
    }

    /// Factor on the weight of the task reward.
    #[must_use]
    pub fn task(&self, position: GraphPosition) -> f32 {
        self.between(position, |node| node.task)
    }

    /// What counts as a failure.
    #[must_use]
    pub fn termination(&self, position: GraphPosition) -> TerminationRule {
        let ends = [position.from, position.to].map(|node| self.nodes[node.index()].termination);
        TerminationRule::between(ends, position.t)
    }

    /// Blend weight of a node.
    #[must_use]
    pub fn weight(&self, position: GraphPosition, node: usize) -> f32 {
        let part = |end: NodeId, weight: f32| if end.index() == node { weight } else { 0.0 };
        part(position.from, 1.0 - position.t) + part(position.to, position.t)
    }

    fn between(&self, position: GraphPosition, of: impl Fn(&GraphNode) -> f32) -> f32 {
        let [from, to] = [position.from, position.to].map(|node| of(&self.nodes[node.index()]));
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
        self.position_len() + if self.pairs.len() > 1 { INTENT_LEN + 1 } else { 0 }
    }

    /// Writes the numbers of [`TrainingGraph::position_len`].
    pub fn position_into(&self, position: GraphPosition, out: &mut [f32]) {
        match out {
            [one] => *one = self.pair_and_blend(position).1,
            weights => weights.iter_mut().enumerate().for_each(|(i, w)| *w = self.weight(position, i)),
        }
    }
}

#[cfg(test)]
#[path = "graph_tests.rs"]
mod tests;
