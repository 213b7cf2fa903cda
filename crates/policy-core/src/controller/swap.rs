//! Another pack under a running controller.

use alloc::sync::Arc;

use super::Controller;
use crate::controller_state::ControllerState;
use crate::graph::PolicyGraph;
use crate::ids::{NodeId, SkillId};
use crate::pack::CharacterPack;
use crate::path::GraphPosition;
use crate::report::TickReport;
use crate::skill::SkillProgress;

/// Why a pack can't take the place of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SwapError {
    /// It is for another body.
    #[error("expected a pack for the same skeleton: the same bodies and joints in the same order")]
    Skeleton,
}

impl Controller {
    /// Goes on with another pack for the same skeleton, for hot reload. Position, running, pending and interrupted skill are kept by
    /// their names, and so are the times that a pending skill has waited and a character still settles. A position that the new pack lacks becomes the start node; a skill that it lacks is
    /// dropped. Allocates.
    ///
    /// # Errors
    /// When bodies or joints differ; then nothing changes.
    pub fn set_pack(&mut self, pack: Arc<CharacterPack>) -> Result<(), SwapError> {
        if **self.pack.skeleton() != **pack.skeleton() {
            return Err(SwapError::Skeleton);
        }
        let old = self.state.report;
        let (graph, new_graph) = (self.pack.graph(), pack.graph());
        let skill = |id: SkillId| pack.skill_named(&self.pack.skills()[id.index()].name);
        let position = carried(graph, new_graph, old.position);
        let pending = old.pending_skill.and_then(skill);
        let mut config = self.config;
        config.start = new_graph.node_named(&graph.node(self.start_node()).name).unwrap_or_default();
        let start = GraphPosition::node(config.start);
        let mut state = ControllerState::new(&pack);
        state.report = TickReport::at(position.unwrap_or(start));
        state.report.pending_skill = pending;
        state.report.skill = old.skill.and_then(|running| {
            let (named, acts) = (skill(running.skill)?, skill(running.acts)?);
            Some(SkillProgress { skill: named, acts, ..running }).filter(|s| s.fits(pack.skills()))
        });
        state.interrupted = self.state.interrupted.and_then(skill);
        state.pending_secs = self.state.pending_secs;
        state.settle_secs = self.state.settle_secs;
        state.fall = self.state.fall;
        state.targets.copy_from_slice(&self.state.targets);
        state.handover_from.copy_from_slice(&self.state.handover_from);
        state.handover_secs = self.state.handover_secs;
        if self.pack.tensors().discriminator_normaliser == pack.tensors().discriminator_normaliser {
            state.history.clone_from(&self.state.history);
        }
        let mut next = Self::with_config(pack, config);
        next.state = state;
        *self = next;
        Ok(())
    }

    pub(super) fn start_node(&self) -> NodeId {
        let start = self.config.start;
        if start.index() < self.pack.graph().nodes().len() { start } else { NodeId::default() }
    }
}

/// The same position on another graph, by names.
fn carried(old: &PolicyGraph, new: &PolicyGraph, position: GraphPosition) -> Option<GraphPosition> {
    let node = |id: NodeId| new.node_named(&old.node(id).name);
    let position = GraphPosition { from: node(position.from)?, to: node(position.to)?, t: position.t };
    new.contains(position).then_some(position)
}
