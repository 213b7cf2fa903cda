//! Rises: a character that stands up out of a low gait, such as a crawl, gives all of its weight to the rising variant of that gait.
//!
//! Half-way between a gait on hands and knees and one on two feet there is no way up: what acts there rests on its hands. A variant that has
//! learned to stand up acts until the body stands, and the character goes on from the gait that stands.

use crate::blend::Blend;
use crate::command::Command;
use crate::graph::PolicyGraph;
use crate::ids::NodeId;
use crate::path::GraphPosition;
use crate::variants::switched;

/// Time to the rising variant, and back, seconds.
const CROSS_SECS: [f32; 2] = [0.1, 0.2];

/// What a rise remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rise {
    /// The variant that acts while the share is above 0.
    pub(crate) variant: NodeId,
    /// How far it acts, in [0, 1].
    pub(crate) share: f32,
}

impl Rise {
    /// What it is after a tick of `dt` seconds, with the variant that the character stands up by, where it does.
    pub(crate) fn next(self, rises_by: Option<NodeId>, dt: f32) -> Self {
        let share = switched(self.share, rises_by.is_some(), CROSS_SECS, dt);
        match share > 0.0 {
            true => Self { variant: rises_by.unwrap_or(self.variant), share },
            false => Self::default(),
        }
    }

    /// The command of a tick: a character that stands up has no target.
    pub(crate) fn commanded(self, command: &Command) -> Command {
        let target = command.target.filter(|_| self.share == 0.0);
        Command { target, ..*command }
    }

    /// A blend of gaits with a share given to the rising variant.
    pub(crate) fn with_rise(self, gaits: Blend) -> Blend {
        gaits.with_share(self.variant.into(), self.share)
    }
}

/// The rising variant of the gaits that act at a position, where one has it.
pub(crate) fn rising_variant(graph: &PolicyGraph, position: GraphPosition) -> Option<NodeId> {
    [position.from, position.to].into_iter().find_map(|node| graph.node(node).rising)
}

/// Share of the way down to a low gait from which on a character goes down for good: its hands are already on their way to the ground.
const COMMITS: f32 = 0.55;

/// Where a character goes that is on its way down an edge that is only crossed, to a gait with a rising variant: to the end of it, once it has
/// gone so far, whatever is asked of it. It rises from there.
pub(crate) fn committed(graph: &PolicyGraph, position: GraphPosition) -> Option<GraphPosition> {
    graph.edge_at(position).filter(|edge| edge.transit)?;
    let (GraphPosition { from, to, t }, rises) = (position, |node: NodeId| graph.node(node).rising.is_some());
    match (rises(from), rises(to)) {
        (false, true) if t > COMMITS => Some(GraphPosition::node(to)),
        (true, false) if t < 1.0 - COMMITS => Some(GraphPosition::node(from)),
        _ => None,
    }
}
