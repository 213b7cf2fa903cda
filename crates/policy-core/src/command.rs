//! What a game asks of a character each tick.

use glam::Vec2;

use crate::blend::Blend;
use crate::graph::PolicyGraph;
use crate::ids::{NodeId, PathId, SkillId};
use crate::path::GraphPosition;

/// Where on the graph to go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Goal {
    /// Stay at the present position.
    #[default]
    Stay,
    /// A coordinate on a path; see [`Path::position`](crate::training::Path::position).
    Path {
        /// The path. One that is not there means [`Goal::Stay`].
        path: PathId,
        /// Clamped to the path.
        coordinate: f32,
    },
    /// A node, by the cheapest way. One that is not there means [`Goal::Stay`].
    Node(NodeId),
}

impl Goal {
    /// The position on the graph, if there is one to go to.
    #[must_use]
    pub fn position(self, graph: &PolicyGraph) -> Option<GraphPosition> {
        match self {
            Goal::Stay => None,
            Goal::Path { path, coordinate } => {
                graph.paths().get(path.index()).map(|p| p.position(coordinate))
            }
            Goal::Node(node) => (node.index() < graph.nodes().len()).then(|| GraphPosition::node(node)),
        }
    }
}

/// What a game asks of a character each tick. Made by a [`CommandMapper`](crate::CommandMapper), or by the
/// game itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Point on the ground to go to, world space, metres; `None`: where it stands.
    pub target: Option<Vec2>,
    /// Direction to face, world space, of any length; `None`: where it goes. Only policies that strafe
    /// ([`Node::strafes`](crate::training::Node::strafes)) face one way and move another; the others turn to the target.
    pub facing: Option<Vec2>,
    /// Where on the graph to go.
    pub goal: Goal,
    /// A skill to start. It stays pending until the position on the graph allows it or
    /// [`Controller::cancel_pending_skill`](crate::Controller::cancel_pending_skill) is called.
    pub skill: Option<SkillId>,
    /// Blend weights that replace the position on the graph: manual sliders. Ignored when empty, not finite
    /// or of policies that are not there.
    pub blend: Option<Blend>,
}
