//! What a game asks of a character each tick.

use glam::Vec2;

use crate::blend::Blend;
use crate::evaluator::BlendMode;
use crate::graph::{GraphPosition, PolicyGraph};

/// Where on the graph to go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Goal {
    /// Stay where it is.
    #[default]
    Stay,
    /// A coordinate on a path; see [`Path::position`](crate::Path::position).
    Path {
        /// Index of the path. One that is not there means [`Goal::Stay`].
        path: usize,
        /// Clamped to the path.
        coordinate: f32,
    },
    /// A node, by the cheapest way. One that is not there means [`Goal::Stay`].
    Node(usize),
}

impl Goal {
    /// The place on the graph, if there is one to go to.
    #[must_use]
    pub fn position(self, graph: &PolicyGraph) -> Option<GraphPosition> {
        match self {
            Goal::Stay => None,
            Goal::Path { path, coordinate } => graph.paths().get(path).map(|p| p.position(coordinate)),
            Goal::Node(node) => (node < graph.nodes().len()).then(|| GraphPosition::node(node)),
        }
    }
}

/// What a game asks of a character each tick. Made by a [`CommandMapper`](crate::CommandMapper), or by the
/// game itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Point on the ground to go to, world space, metres; `None`: where it stands.
    pub target: Option<Vec2>,
    /// Where on the graph to go.
    pub goal: Goal,
    /// Index of a skill to start now.
    pub skill: Option<usize>,
    /// Blend weights that stand in for the place on the graph: manual sliders. Ignored when empty, not finite
    /// or of policies that are not there.
    pub blend: Option<Blend>,
    /// How the blend becomes an action.
    pub mode: BlendMode,
}
