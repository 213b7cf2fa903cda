//! What hides the player from a camera.

use glam::Vec3;
use physics_bridge::Part;

use super::SharedWorld;

/// Things that are looked through on one line, at most.
const MOST_SEEN_THROUGH: usize = 8;
/// Behind what was looked through, metres.
const STEP_M: f32 = 0.02;

impl SharedWorld {
    /// Metres from a point in the player to the fixture, the ground or the other character that a line of `most` metres along
    /// `direction` meets first; `None` when nothing hides it. Props are small and move on: they do not count.
    pub fn hidden_at(&mut self, from: Vec3, direction: Vec3, most: f32) -> Option<f32> {
        let along = direction.try_normalize()?;
        let mut gone = 0.0;
        for _ in 0..MOST_SEEN_THROUGH {
            let hit = self.world.ray(from + along * gone, along, most - gone, None).ok()??;
            let player = matches!(hit.part, Part::Body(handle, _) if handle == self.characters[0]);
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
