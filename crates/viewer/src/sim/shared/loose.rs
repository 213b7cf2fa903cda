//! Balls that are thrown and props that are put there: a bounded number of each; the oldest makes room.

use glam::Vec3;
use physics_bridge::{Motion, WorldEdit, WorldError};
use playground::LooseKind;

use super::{Piece, SharedWorld};

/// Most balls at a time.
pub const MOST_BALLS: usize = LooseKind::Ball.most();

/// Keeps all of them ready: a throw must not build the simulation anew.
pub(super) fn reserve(edit: &mut WorldEdit<'_>) -> Result<(), WorldError> {
    LooseKind::ALL.into_iter().try_for_each(|kind| edit.reserve_props(&kind.prop().0, kind.most()))
}

impl SharedWorld {
    /// Adds a loose prop that moves as `motion` says. The oldest of its kind makes room.
    ///
    /// # Errors
    /// When a number of the motion is out of its range; nothing is changed then.
    pub fn add_loose(&mut self, kind: LooseKind, motion: Motion) -> Result<(), WorldError> {
        let is_kind = |piece: &&Piece| piece.loose == Some(kind);
        let full = self.state.pieces.iter().filter(is_kind).count() >= kind.most();
        let oldest = full.then(|| self.state.pieces.iter().find(is_kind).map(|piece| piece.handle)).flatten();
        let (prop, paint) = kind.prop();
        let described = prop.clone();
        let handle = self.world.edit(|edit| {
            if let Some(oldest) = oldest {
                edit.remove_prop(oldest)?;
            }
            edit.add_prop(prop, motion)
        })?;
        self.state.pieces.retain(|piece| Some(piece.handle) != oldest);
        let mut piece = Piece::new(handle, &described, paint, &motion);
        piece.loose = Some(kind);
        self.state.pieces.push(piece);
        Ok(())
    }

    /// Puts the next kind of prop at a point, metres, world space.
    ///
    /// # Errors
    /// As [`SharedWorld::add_loose`].
    pub fn spawn(&mut self, at: Vec3) -> Result<(), WorldError> {
        let kind = LooseKind::PUT[self.state.spawned as usize % LooseKind::PUT.len()];
        self.state.spawned += 1;
        self.add_loose(kind, Motion::at(at))
    }

    /// Throws a ball from a point so that it comes to where a line from there meets something first, or along the line.
    /// `speed_mps` is that along the line.
    ///
    /// # Errors
    /// As [`SharedWorld::add_loose`].
    pub fn throw_at(&mut self, from: Vec3, along: Vec3, speed_mps: f32) -> Result<(), WorldError> {
        const FARTHEST_M: f32 = 30.0;
        let hit = self.world.ray(from, along, FARTHEST_M, None)?;
        let secs = hit.map_or(0.0, |hit| hit.distance) / speed_mps;
        // What it falls on its way.
        let lift = 0.5 * 9.81 * self.world.ground().settings().gravity * secs;
        let velocity = along.normalize_or(Vec3::X) * speed_mps + Vec3::Z * lift;
        self.add_loose(LooseKind::Ball, Motion::at(from).moving(velocity))
    }

    /// Puts the next kind of prop on what a line from a point meets first, within 12 m.
    ///
    /// # Errors
    /// As [`SharedWorld::add_loose`].
    pub fn spawn_at(&mut self, from: Vec3, along: Vec3) -> Result<(), WorldError> {
        const FARTHEST_M: f32 = 12.0;
        // Above what it is put on, so that it is not in it.
        const ABOVE_M: f32 = 0.7;
        let hit = self.world.ray(from, along, FARTHEST_M, None)?;
        let distance = hit.map_or(FARTHEST_M, |hit| hit.distance);
        self.spawn(from + along.normalize_or(Vec3::X) * distance + Vec3::Z * ABOVE_M)
    }

    /// Balls in the world.
    #[must_use]
    pub fn balls(&self) -> usize {
        self.state.pieces.iter().filter(|piece| piece.loose == Some(LooseKind::Ball)).count()
    }
}
