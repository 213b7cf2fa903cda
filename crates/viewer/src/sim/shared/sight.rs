//! What hides the player from a camera.

use glam::Vec3;
use physics_bridge::Part;

use super::SharedWorld;

/// Things that are looked through on one line, at most.
const MOST_SEEN_THROUGH: usize = 8;
/// Behind what was looked through, metres.
const STEP_M: f32 = 0.02;

impl SharedWorld {
    /// Metres from a point to the fixture, the ground or the character that a line of `most` metres along `direction` meets first;
    /// `None` when nothing hides the point. The first `players` characters do not count, and neither do props: they are small and
    /// move on.
    pub fn hidden_at(&mut self, from: Vec3, direction: Vec3, most: f32, players: usize) -> Option<f32> {
        let along = direction.try_normalize()?;
        let mut gone = 0.0;
        for _ in 0..MOST_SEEN_THROUGH {
            let hit = self.world.ray(from + along * gone, along, most - gone, None).ok()??;
            let steered = &self.characters[..players.min(self.characters.len())];
            let player = matches!(hit.part, Part::Body(handle, _) if steered.contains(&handle));
            if !player && !matches!(hit.part, Part::Prop(_)) {
                return Some(gone + hit.distance);
            }
            gone += hit.distance + STEP_M;
            if gone >= most {
                return None;
            }
        }
        None
    }
}
