//! A character's state as a value, and another model for a character under way.

use policy_core::BodyId;
use rapier3d::geometry::ContactPair;

use super::{Character, Pushes};
use crate::articulation::Articulation;
use crate::model::Model;
use crate::saved::SavedSets;

/// The whole state of a character at the end of a tick: its world, contacts included, its targets and pushes.
#[derive(Clone)]
pub struct Snapshot {
    sets: SavedSets,
    articulation: Articulation,
    pushes: Pushes,
    tick: u64,
}

/// The snapshot is of a character of another model or drive.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a snapshot of a character of the same model and drive, found another")]
#[non_exhaustive]
pub struct SnapshotMismatch;

/// The model is of another kind of character.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a model made by `with_settings` or `with_ground` of the character's own, found another")]
#[non_exhaustive]
pub struct ModelMismatch;

impl Character {
    /// The state now. Allocates.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        Snapshot {
            sets: SavedSets::of(&self.world),
            articulation: self.articulation.clone(),
            pushes: self.pushes.clone(),
            tick: self.tick,
        }
    }

    /// Returns to a state. The run continues as it did from there. Allocates.
    ///
    /// # Errors
    /// When the snapshot is of a character of another model or drive; the character is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SnapshotMismatch> {
        let saved = &snapshot.articulation;
        if !saved.model().is(self.model()) || saved.drive() != self.articulation.drive() {
            return Err(SnapshotMismatch);
        }
        let Snapshot { sets, articulation, pushes, tick } = snapshot.clone();
        sets.restore(&mut self.world);
        (self.articulation, self.pushes, self.tick) = (articulation, pushes, tick);
        Ok(())
    }

    /// Applies another ground or other settings from the next step on. `model` is made by
    /// [`Model::with_settings`] or [`Model::with_ground`] of this character's own. Contacts begin anew. Allocates.
    ///
    /// # Errors
    /// When it is of another character; the character is then unchanged.
    pub fn set_model(&mut self, model: &Model) -> Result<(), ModelMismatch> {
        if !self.model().shares_body_with(model) {
            return Err(ModelMismatch);
        }
        let (pose, targets) = (self.pose(), self.articulation.targets().to_vec());
        self.restart_as(model, &pose.qpos, &pose.qvel);
        self.articulation.actuate(&targets);
        Ok(())
    }

    /// Vertical force of the ground on a body in the last physics step, newtons.
    #[must_use]
    pub fn ground_load(&self, body: BodyId) -> f32 {
        let Some(&handle) = self.articulation.bodies().get(body.index()) else { return 0.0 };
        let parent = |collider| self.world.colliders.get(collider).and_then(|c| c.parent());
        let load = |pair: &ContactPair| match [parent(pair.collider1), parent(pair.collider2)] {
            [Some(one), None] if one == handle => -pair.total_impulse().z,
            [None, Some(other)] if other == handle => pair.total_impulse().z,
            _ => 0.0,
        };
        let impulse: f32 = self.world.narrow_phase.contact_pairs().map(load).sum();
        impulse / self.world.integration_parameters.dt
    }

    /// Height of the lowest point of a body above the ground below its root, metres; negative when it is in the ground.
    /// Exact on flat ground.
    #[must_use]
    pub fn clearance_of(&self, body: BodyId) -> f32 {
        let lowest = self.articulation.lowest_point_of(&self.world.bodies, &self.world.colliders, body);
        let at = self
            .articulation
            .bodies()
            .get(body.index())
            .map(|&handle| self.world.bodies[handle].translation());
        lowest - at.map_or(0.0, |at| self.model().height_at(at.x, at.y))
    }
}

impl std::fmt::Debug for Snapshot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Snapshot").field("tick", &self.tick).finish_non_exhaustive()
    }
}
