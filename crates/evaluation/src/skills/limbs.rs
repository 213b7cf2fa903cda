//! What the limbs do while a skill runs.

use glam::Vec2;
use policy_core::{BodyId, CharacterState, Heading, Skeleton};

use crate::trial::{OFF_GROUND_METRES, TICK_SECS};

/// What the limbs do while a skill runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Limbs {
    /// Greatest heights of the lowest point of the higher and of the lower foot above the ground, metres.
    pub(super) highest: f32,
    pub(super) lower: f32,
    /// Time in which both are off the ground, seconds.
    pub(super) air_secs: f32,
    /// When the flight that lasts began, and how long it has lasted, seconds.
    flight: Option<[f32; 2]>,
    /// The longest one.
    pub(super) longest: Option<[f32; 2]>,
    /// Greatest horizontal distance of a hand ahead of the root, metres.
    pub(super) hand: Option<f32>,
    /// Where the root headed as the skill began.
    heading: Option<Vec2>,
    /// Greatest angle off that, radians.
    pub(super) turned: f32,
}

impl Limbs {
    /// With the hands where they are now.
    pub(super) fn reaching(mut self, state: &CharacterState, hands: &[BodyId]) -> Self {
        let root = state.root();
        let ahead = Heading::from_rotation(root.rotation).direction();
        for hand in hands {
            let from_root = (state.body(*hand).position - root.position).truncate().dot(ahead);
            self.hand = Some(self.hand.map_or(from_root, |most| most.max(from_root)));
        }
        self
    }

    /// With the heading where it is now.
    pub(super) fn turning(self, state: &CharacterState) -> Self {
        let now = Heading::from_rotation(state.root().rotation).direction();
        let first = self.heading.unwrap_or(now);
        Self { heading: Some(first), turned: self.turned.max(first.angle_to(now).abs()), ..self }
    }

    /// So many seconds after the press, with the lowest points of the feet so high above the ground.
    pub(super) fn after(self, secs: f32, heights: impl Iterator<Item = f32>) -> Self {
        let [low, high] = heights.fold([f32::INFINITY, 0.0], |[low, high], h| [h.min(low), h.max(high)]);
        let low = if low.is_finite() { low } else { 0.0 };
        let flight = (low > OFF_GROUND_METRES).then(|| {
            let [begun, lasted] = self.flight.unwrap_or([secs, 0.0]);
            [begun, lasted + TICK_SECS]
        });
        let longer = flight.filter(|[_, lasts]| self.longest.is_none_or(|[_, longest]| *lasts > longest));
        Self {
            highest: self.highest.max(high),
            lower: self.lower.max(low),
            air_secs: self.air_secs + if flight.is_some() { TICK_SECS } else { 0.0 },
            flight,
            longest: longer.or(self.longest),
            ..self
        }
    }
}

/// Bodies whose names end in `hand`.
pub(super) fn hands(skeleton: &Skeleton) -> Vec<BodyId> {
    let bodies = skeleton.bodies().iter().enumerate();
    bodies.filter(|(_, body)| body.name.ends_with("hand")).map(|(i, _)| BodyId::new(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kick_lifts_one_foot_and_a_jump_both() {
        let kick = [[0.0, 0.0], [0.0, 0.9], [0.02, 0.5], [0.0, 0.0]];
        let after =
            |limbs: Limbs, (secs, heights): (f32, &[f32; 2])| limbs.after(secs, heights.iter().copied());
        let feet = [0.1, 0.2, 0.3, 0.4].into_iter().zip(&kick).fold(Limbs::default(), after);
        let longest = Some([0.3, TICK_SECS]);
        let kicked = Limbs { highest: 0.9, lower: 0.02, air_secs: TICK_SECS, longest, ..Limbs::default() };
        assert_eq!(feet, kicked, "the last tick is on the ground");
        // A short flight, and a longer one.
        let heights = [0.02, 0.0, 0.03, 0.1, 0.03, 0.0, 0.02].map(|height| [height; 2]);
        let times = (0..).map(|tick| tick as f32 * TICK_SECS);
        let jump = times.zip(&heights).fold(Limbs::default(), after);
        assert_eq!(jump.longest.map(|[begins, _]| begins), Some(2.0 * TICK_SECS));
        assert!((jump.longest.unwrap()[1] - 3.0 * TICK_SECS).abs() < 1e-6 && jump.lower == 0.1);
        let without_feet = Limbs::default().after(0.1, std::iter::empty());
        assert_eq!(without_feet, Limbs::default(), "a character without feet");
    }

    #[test]
    fn a_twist_counts_where_it_is_greatest() {
        let mut state = CharacterState::new(&Skeleton::humanoid());
        let turns = [1.0_f32, 1.2, 0.4, 0.9].map(|radians| {
            state.bodies[0].rotation = glam::Quat::from_rotation_z(radians);
            state.clone()
        });
        let limbs = turns.iter().fold(Limbs::default(), |limbs, state| limbs.turning(state));
        assert!((limbs.turned - 0.6).abs() < 1e-5, "{}", limbs.turned);
    }
}
