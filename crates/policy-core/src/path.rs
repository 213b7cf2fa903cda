//! Paths of the policy graph and positions on it (paper, section 3.2).

use alloc::string::String;
use alloc::vec::Vec;

use crate::blend::Blend;
use crate::ids::{NodeId, PolicyId};

/// An ordered list of at least two nodes, each joined to the next by an edge. Made by [`PolicyGraph::from_parts`](crate::PolicyGraph::from_parts).
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    pub(crate) name: String,
    pub(crate) nodes: Vec<NodeId>,
}

impl Path {
    /// Unique name, such as `speed`.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Nodes from coordinate 0 on; at least two.
    #[must_use]
    pub fn nodes(&self) -> &[NodeId] {
        &self.nodes
    }

    /// The greatest coordinate on the path.
    #[must_use]
    pub fn end(&self) -> f32 {
        // The graph refuses paths of fewer than two nodes, here and below.
        (self.nodes.len() - 1) as f32
    }

    /// The position on the graph of a coordinate: between nodes i and i+1 lies `i + t`. Clamped to the path;
    /// NaN is its start.
    #[must_use]
    pub fn position(&self, coordinate: f32) -> GraphPosition {
        let coordinate = if coordinate.is_nan() { 0.0 } else { coordinate.clamp(0.0, self.end()) };
        let segment = (coordinate as usize).min(self.nodes.len() - 2);
        GraphPosition {
            from: self.nodes[segment],
            to: self.nodes[segment + 1],
            t: coordinate - segment as f32,
        }
    }

    /// The coordinate of a position on the graph, if the path runs through it.
    #[must_use]
    pub fn coordinate(&self, position: GraphPosition) -> Option<f32> {
        let at_node = |node: NodeId| self.nodes.iter().position(|&n| n == node).map(|i| i as f32);
        if let Some(node) = position.as_node() {
            return at_node(node);
        }
        self.nodes.windows(2).enumerate().find_map(|(i, pair)| {
            let t = position.along(pair[0], pair[1])?;
            Some(i as f32 + t)
        })
    }
}

/// A position on the graph: `t` of the way along an edge. A node is any position with `from == to`, or `t` of 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GraphPosition {
    /// Node where `t` is 0.
    pub from: NodeId,
    /// Node where `t` is 1.
    pub to: NodeId,
    /// In [0, 1].
    pub t: f32,
}

impl GraphPosition {
    /// The position of a node.
    #[must_use]
    pub fn node(node: NodeId) -> Self {
        Self { from: node, to: node, t: 0.0 }
    }

    /// The node, when the position is one.
    #[must_use]
    pub fn as_node(self) -> Option<NodeId> {
        if self.from == self.to || self.t <= 0.0 {
            Some(self.from)
        } else if self.t >= 1.0 {
            Some(self.to)
        } else {
            None
        }
    }

    /// The nearer node.
    #[must_use]
    pub fn nearest_node(self) -> NodeId {
        if self.t < 0.5 { self.from } else { self.to }
    }

    /// How far along the edge from `a` to `b` the position lies, if it lies on that edge or its ends.
    #[must_use]
    pub fn along(self, a: NodeId, b: NodeId) -> Option<f32> {
        match self.as_node() {
            Some(node) if node == a => Some(0.0),
            Some(node) if node == b => Some(1.0),
            Some(_) => None,
            None if (self.from, self.to) == (a, b) => Some(self.t),
            None if (self.from, self.to) == (b, a) => Some(1.0 - self.t),
            None => None,
        }
    }

    /// Whether both are one node, or one place on one edge, whichever end it is counted from.
    #[must_use]
    pub fn is_same_place(self, other: Self) -> bool {
        match self.as_node() {
            Some(node) => other.as_node() == Some(node),
            None => other.along(self.from, self.to) == Some(self.t),
        }
    }

    /// Blend of the policies at this position.
    #[must_use]
    pub fn blend(self) -> Blend {
        let [from, to] = [self.from, self.to].map(PolicyId::from);
        Blend::between(from, to, self.t)
    }
}
