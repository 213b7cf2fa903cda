//! How far behind its character a camera may stand before something hides it.

/// Seconds in which the camera comes two thirds closer when something gets in the way, and in which it goes back.
const CLOSER_SECS: f32 = 0.05;
const BACK_SECS: f32 = 0.5;
/// It stays so far before what is in the way, metres.
const BEFORE_M: f32 = 0.25;
/// Nearest that it comes to the character, metres.
const LEAST_M: f32 = 0.6;

/// Free way behind the character, smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Room {
    /// Metres; infinite while nothing is in the way.
    metres: f32,
}

impl Default for Room {
    fn default() -> Self {
        Self { metres: f32::INFINITY }
    }
}

impl Room {
    /// Takes `dt` seconds in which something is `hit` metres behind the character; `None` for nothing within `wanted` metres.
    pub(super) fn advance(&mut self, dt: f32, hit: Option<f32>, wanted: f32) {
        let goal = hit.map_or(wanted, |hit| (hit - BEFORE_M).clamp(LEAST_M, wanted.max(LEAST_M)));
        let now = self.metres.min(wanted);
        let secs = if goal < now { CLOSER_SECS } else { BACK_SECS };
        self.metres = now + (goal - now) * (1.0 - (-dt.max(0.0) / secs).exp());
        if hit.is_none() && wanted - self.metres < 0.01 {
            self.metres = f32::INFINITY;
        }
    }

    /// The distance at which the camera stands, of the one that is wanted.
    pub(super) fn limit(self, wanted: f32) -> f32 {
        wanted.min(self.metres)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_comes_closer_at_once_and_goes_back_slowly() {
        let mut room = Room::default();
        assert_eq!(room.limit(3.6), 3.6);
        (0..12).for_each(|_| room.advance(1.0 / 60.0, Some(1.5), 3.6));
        assert!((room.limit(3.6) - 1.25).abs() < 0.1, "{room:?}");
        room.advance(1.0 / 60.0, None, 3.6);
        assert!((1.2..1.5).contains(&room.limit(3.6)), "{room:?}");
        (0..240).for_each(|_| room.advance(1.0 / 60.0, None, 3.6));
        assert_eq!(room, Room::default());
        (0..60).for_each(|_| room.advance(1.0 / 60.0, Some(0.1), 3.6));
        assert!((room.limit(3.6) - LEAST_M).abs() < 0.01, "{room:?}");
        assert!(room.limit(0.3) <= 0.3, "one that is closer stays");
    }
}
