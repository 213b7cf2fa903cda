//! What a population moves along: nodes, each with a policy of its own, and paths through them. A place on a course is
//! an edge and a blend weight, as in the graph of a pack.

use super::command::INTENT_LEN;
use super::config::{EnvironmentConfig, Fall};
use super::fallen::FallRule;
use crate::Rng;

/// A node of a course.
#[derive(Clone, Debug, PartialEq)]
pub struct CourseNode {
    /// Name of its skill.
    pub name: String,
    /// Speed that its policy is commanded to, metres per second.
    pub speed_mps: f32,
    /// Least width of the reward for its speed, metres per second.
    pub least_width_mps: f32,
    /// Distance at which its clip is lost, see [`EnvironmentConfig::lost_metres`].
    pub lost_metres: f32,
    /// What counts as a fall at it.
    pub fall: FallRule,
    /// How often episodes rest at it, beside the other nodes of a path.
    pub share: f32,
    /// Factor on the weight of the task reward.
    pub task: f32,
    /// Height of the pelvis above the ground in its clips, mean, metres.
    pub pelvis_metres: f32,
    /// Seconds that its edges take at least; the longer time of the two ends holds.
    pub edge_secs: f32,
}

impl CourseNode {
    /// The node of a skill with these settings.
    #[must_use]
    pub fn new(name: &str, config: &EnvironmentConfig, share: f32) -> Self {
        let fall = match config.fall {
            Fall::Upright => FallRule::Upright(config.fall_height),
            Fall::Lying => FallRule::Lying,
            Fall::Again => FallRule::Again,
            Fall::Never => FallRule::Never,
        };
        Self {
            name: name.into(),
            speed_mps: config.speed_mps,
            least_width_mps: config.least_width_mps,
            lost_metres: config.lost_metres,
            fall,
            share,
            task: 1.0,
            pelvis_metres: 0.0,
            edge_secs: config.edge_secs,
        }
    }
}

/// Nodes, paths and the edges under them.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    nodes: Vec<CourseNode>,
    paths: Vec<Vec<usize>>,
    edges: Vec<[usize; 2]>,
}

/// A place on a course.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Index of the edge.
    pub edge: usize,
    /// Blend weight: 0 at the edge's first node, 1 at its second.
    pub t: f32,
}

impl Course {
    /// A course along these paths. A path of one node is that node alone.
    ///
    /// # Panics
    /// When there is no path, a path is empty, or names a node that is not there.
    #[must_use]
    pub fn new(nodes: Vec<CourseNode>, paths: Vec<Vec<usize>>) -> Self {
        assert!(!paths.is_empty(), "a course has a path");
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
    pub fn nodes(&self) -> &[CourseNode] {
        &self.nodes
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

    /// The place of a coordinate of a path, clamped to it.
    #[must_use]
    pub fn place(&self, path: usize, coordinate: f32) -> Place {
        let nodes = &self.paths[path];
        let segment = (coordinate.max(0.0) as usize).min(nodes.len().saturating_sub(2));
        let ends = [nodes[segment], nodes[(segment + 1).min(nodes.len() - 1)]];
        let edge = self.edges.iter().position(|e| *e == ends).unwrap_or_default();
        let t = if ends[0] == ends[1] { 1.0 } else { (coordinate - segment as f32).clamp(0.0, 1.0) };
        Place { edge, t }
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
    pub fn speed_mps(&self, place: Place) -> f32 {
        self.between(place, |node| node.speed_mps)
    }

    /// Least width of the reward for the speed, metres per second.
    #[must_use]
    pub fn least_width_mps(&self, place: Place) -> f32 {
        self.between(place, |node| node.least_width_mps)
    }

    /// Height of the pelvis above the ground, metres.
    #[must_use]
    pub fn pelvis_metres(&self, place: Place) -> f32 {
        self.between(place, |node| node.pelvis_metres)
    }

    /// Least seconds to cross the edge, 0 for no limit.
    #[must_use]
    pub fn edge_secs(&self, place: Place) -> f32 {
        let [from, to] = self.edges[place.edge].map(|node| self.nodes[node].edge_secs);
        from.max(to)
    }

    /// Factor on the weight of the task reward.
    #[must_use]
    pub fn task(&self, place: Place) -> f32 {
        self.between(place, |node| node.task)
    }

    /// What counts as a fall.
    #[must_use]
    pub fn fall(&self, place: Place) -> FallRule {
        FallRule::between(self.edges[place.edge].map(|node| self.nodes[node].fall), place.t)
    }

    /// The node that a place is at, if it is not between two.
    #[must_use]
    pub fn node_at(&self, place: Place) -> Option<usize> {
        let end = [0.0, 1.0].iter().position(|t| *t == place.t)?;
        Some(self.edges[place.edge][end])
    }

    /// The node that weighs most.
    #[must_use]
    pub fn nearest(&self, place: Place) -> usize {
        self.edges[place.edge][usize::from(place.t >= 0.5)]
    }

    /// Blend weight of a node.
    #[must_use]
    pub fn weight(&self, place: Place, node: usize) -> f32 {
        let [from, to] = self.edges[place.edge];
        let part = |end: usize, weight: f32| if end == node { weight } else { 0.0 };
        if from == to { part(to, 1.0) } else { part(from, 1.0 - place.t) + part(to, place.t) }
    }

    fn between(&self, place: Place, of: impl Fn(&CourseNode) -> f32) -> f32 {
        let [from, to] = self.edges[place.edge].map(|node| of(&self.nodes[node]));
        from + place.t * (to - from)
    }

    /// Numbers that tell a critic the place: the blend weight, or on a course of more than two nodes that of each.
    #[must_use]
    pub fn place_len(&self) -> usize {
        if self.nodes.len() <= 2 { 1 } else { self.nodes.len() }
    }

    /// Numbers that a critic sees beside the policy's input: the place and, on one of several edges, where it is going and
    /// whether a clip is imitated there.
    #[must_use]
    pub fn context_len(&self) -> usize {
        self.place_len() + if self.edges.len() > 1 { INTENT_LEN + 1 } else { 0 }
    }

    /// Writes the numbers of [`Course::place_len`].
    pub fn place_into(&self, place: Place, out: &mut [f32]) {
        match out {
            [one] => *one = place.t,
            weights => weights.iter_mut().enumerate().for_each(|(i, w)| *w = self.weight(place, i)),
        }
    }
}

#[cfg(test)]
#[path = "course_tests.rs"]
mod tests;
