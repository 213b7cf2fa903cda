//! Graph search: the cheapest way between two skills, and the timed walk along it (paper, section 3.4).
//!
//! All ways are found once, when the graph is made, so that a character's walk looks up one node a tick.

use alloc::vec::Vec;

use crate::graph::{Edge, PolicyGraph};
use crate::ids::NodeId;
use crate::path::GraphPosition;

/// Cheapest ways between all nodes; the cost of an edge is the distance between its policies' parameters.
#[derive(Clone, Debug)]
pub struct RouteTable {
    nodes: usize,
    /// Cost from row to column; infinite where there is no way.
    cost: Vec<f32>,
    /// First node of the way from row to column.
    next: Vec<usize>,
}

impl RouteTable {
    /// Floyd and Warshall's search over at most 64 nodes. An edge costs a hair even where its ends
    /// coincide, so that ways stay short.
    pub(crate) fn new(nodes: usize, edges: &[Edge]) -> Self {
        // Every index below is `row * nodes + column`; the graph checked that edges join its nodes.
        let mut cost = alloc::vec![f32::INFINITY; nodes * nodes];
        let mut next: Vec<usize> = (0..nodes * nodes).map(|i| i % nodes).collect();
        for i in 0..nodes {
            cost[i * nodes + i] = 0.0;
        }
        for edge in edges {
            let [a, b] = edge.nodes.map(NodeId::index);
            let distance = edge.distance.max(1e-6);
            for (a, b) in [(a, b), (b, a)] {
                cost[a * nodes + b] = cost[a * nodes + b].min(distance);
            }
        }
        for via in 0..nodes {
            for a in 0..nodes {
                for b in 0..nodes {
                    let through = cost[a * nodes + via] + cost[via * nodes + b];
                    if through < cost[a * nodes + b] {
                        cost[a * nodes + b] = through;
                        next[a * nodes + b] = next[a * nodes + via];
                    }
                }
            }
        }
        Self { nodes, cost, next }
    }

    /// Cost of the cheapest way, infinite where there is none.
    ///
    /// # Panics
    /// When a node is not in the graph.
    #[must_use]
    pub fn cost(&self, from: NodeId, to: NodeId) -> f32 {
        let (from, to) = (from.index(), to.index());
        assert!(from < self.nodes && to < self.nodes, "nodes of the graph");
        self.cost[from * self.nodes + to]
    }

    /// The node after `from` on the cheapest way to `to`; `None` where there is no way or it is there already.
    ///
    /// # Panics
    /// When a node is not in the graph.
    #[must_use]
    pub fn next(&self, from: NodeId, to: NodeId) -> Option<NodeId> {
        (from != to && self.cost(from, to).is_finite())
            .then(|| NodeId::new(self.next[from.index() * self.nodes + to.index()]))
    }

    /// Nodes of the cheapest way, both ends included; empty where there is none. Allocates.
    ///
    /// # Panics
    /// When a node is not in the graph.
    #[must_use]
    pub fn route(&self, from: NodeId, to: NodeId) -> Vec<NodeId> {
        if !self.cost(from, to).is_finite() {
            return Vec::new();
        }
        let mut nodes = alloc::vec![from];
        let mut at = from;
        // This ends: no step costs more than the one before, and the search takes a detour only where it is cheaper.
        while let Some(next) = self.next(at, to) {
            nodes.push(next);
            at = next;
        }
        nodes
    }
}

impl PolicyGraph {
    /// Moves a position on the graph for `dt_secs` towards `goal`, along the cheapest way. Each edge is crossed at the
    /// rate of [`Edge::seconds`] or [`Edge::seconds_back`]. Stays where there is no way. Does not allocate.
    ///
    /// # Panics
    /// When a node of a position is not in the graph.
    pub fn travel(&self, position: &mut GraphPosition, goal: GraphPosition, dt_secs: f32) {
        let mut left = if dt_secs > 0.0 { dt_secs } else { 0.0 };
        // Every round but the last ends at a node nearer to the goal.
        for _ in 0..self.nodes().len() + 2 {
            if left <= 0.0 {
                return;
            }
            let Some((toward, t)) = self.next_leg(*position, goal) else { return };
            *position = toward;
            let start = if t >= toward.t { toward.from } else { toward.to };
            let seconds = self.edge_between(toward.from, toward.to).map_or(0.0, |e| e.seconds_from(start));
            let needed = (t - toward.t).abs() * seconds;
            if needed > left {
                position.t += (t - toward.t).signum() * left / seconds;
                return;
            }
            position.t = t;
            left -= needed;
        }
    }

    /// Where a character that is asked to go to `goal` comes to rest: at `goal`, or at the nearer node of an edge that is only
    /// crossed ([`Edge::transit`]). A character in the half of one node rests there until `goal` is beyond 0.6 of the way to the
    /// other, so that a trembling trigger does not send it to and fro.
    #[must_use]
    pub fn settled(&self, goal: GraphPosition, present: GraphPosition) -> GraphPosition {
        if !self.edge_at(goal).is_some_and(|edge| edge.transit) {
            return goal;
        }
        let threshold = match present.along(goal.from, goal.to) {
            Some(t) if t < 0.5 => 0.6,
            Some(_) => 0.4,
            None => 0.5,
        };
        GraphPosition::node(if goal.t < threshold { goal.from } else { goal.to })
    }

    /// The present position on the edge to travel next, and how far along it to go; `None` at the goal or where
    /// there is no way.
    fn next_leg(&self, position: GraphPosition, goal: GraphPosition) -> Option<(GraphPosition, f32)> {
        let Some(node) = position.as_node() else {
            if let Some(t) = goal.along(position.from, position.to) {
                return (t != position.t).then_some((position, t));
            }
            let scale = self.edge_between(position.from, position.to).map_or(0.0, |e| e.distance);
            let back = position.t * scale + self.cost_to(position.from, goal);
            let forth = (1.0 - position.t) * scale + self.cost_to(position.to, goal);
            if back.is_infinite() && forth.is_infinite() {
                return None;
            }
            return Some((position, if back <= forth { 0.0 } else { 1.0 }));
        };
        match goal.as_node() {
            Some(target) => self.routes().next(node, target).map(|next| (leg(node, next), 1.0)),
            None if node == goal.from => Some((leg(node, goal.to), goal.t)),
            None if node == goal.to => Some((leg(node, goal.from), 1.0 - goal.t)),
            None => {
                let by_from = self.routes().cost(node, goal.from) + goal.t * self.goal_distance(goal);
                let by_to = self.routes().cost(node, goal.to) + (1.0 - goal.t) * self.goal_distance(goal);
                let target = if by_from <= by_to { goal.from } else { goal.to };
                self.routes().next(node, target).map(|next| (leg(node, next), 1.0))
            }
        }
    }

    fn goal_distance(&self, goal: GraphPosition) -> f32 {
        self.edge_between(goal.from, goal.to).map_or(f32::INFINITY, |e| e.distance)
    }

    fn cost_to(&self, node: NodeId, goal: GraphPosition) -> f32 {
        match goal.as_node() {
            Some(target) => self.routes().cost(node, target),
            None => {
                let distance = self.goal_distance(goal);
                let by_from = self.routes().cost(node, goal.from) + goal.t * distance;
                by_from.min(self.routes().cost(node, goal.to) + (1.0 - goal.t) * distance)
            }
        }
    }
}

fn leg(from: NodeId, to: NodeId) -> GraphPosition {
    GraphPosition { from, to, t: 0.0 }
}
