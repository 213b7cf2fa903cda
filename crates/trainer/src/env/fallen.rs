//! The fall rule of training: stricter than a game's, which looks at the pelvis alone.

use policy_core::{Body, CharacterState};

/// Least heights of an upright body above the ground, metres: body frames, not lowest points.
const LEAST_HEIGHTS: [(Body, f32); 9] = [
    (Body::Pelvis, 0.45),
    (Body::Torso, 0.6),
    (Body::Head, 0.75),
    (Body::RightHand, 0.15),
    (Body::LeftHand, 0.15),
    (Body::RightLowerArm, 0.3),
    (Body::LeftLowerArm, 0.3),
    (Body::RightThigh, 0.4),
    (Body::LeftThigh, 0.4),
];

/// A pelvis lower than this above the ground lies, metres.
const LYING_METRES: f32 = 0.2;

/// A pelvis higher than this above the ground stands, and lower than the other has gone down again, metres.
const STANDING_METRES: f32 = 0.75;
const DOWN_METRES: f32 = 0.5;

/// True when the pelvis is as high as that of one who stands.
#[must_use]
pub fn stands(state: &CharacterState) -> bool {
    state.height_of(Body::Pelvis) > STANDING_METRES
}

/// What counts as a fall at a place on a course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FallRule {
    /// Nothing.
    Never,
    /// To go down again after having stood.
    Again,
    /// To lie: where low is right, but not that low.
    Lying,
    /// Any body that should be up coming low, with a factor on the heights.
    Upright(f32),
}

impl FallRule {
    /// The rule between two places: that of an upright body only where both ends have it, with the weight of the second.
    #[must_use]
    pub fn between(ends: [Self; 2], t: f32) -> Self {
        match ends {
            _ if t == 0.0 => ends[0],
            _ if t == 1.0 => ends[1],
            [Self::Upright(from), Self::Upright(to)] => Self::Upright(from + t * (to - from)),
            [Self::Never, _] | [_, Self::Never] => Self::Never,
            [Self::Again, _] | [_, Self::Again] => Self::Again,
            _ => Self::Lying,
        }
    }

    /// True when a step from a place with this rule to one with the other has to wait for a rise.
    #[must_use]
    pub fn rises_to(self, to: Self) -> bool {
        !self.is_upright() && to.is_upright()
    }

    /// True where only an upright body is right.
    #[must_use]
    pub fn is_upright(self) -> bool {
        matches!(self, Self::Upright(_))
    }

    /// True when the character has fallen; `stood` tells whether it has [stood](stands) in this episode.
    #[must_use]
    pub fn is_broken_by(self, state: &CharacterState, stood: bool) -> bool {
        match self {
            Self::Never => false,
            Self::Again => stood && state.height_of(Body::Pelvis) < DOWN_METRES,
            Self::Lying => state.height_of(Body::Pelvis) < LYING_METRES,
            Self::Upright(factor) => {
                LEAST_HEIGHTS.iter().any(|(body, height)| state.height_of(*body) < height * factor)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_an_upright_and_a_low_place_only_lying_is_a_fall() {
        let [upright, low] = [FallRule::Upright(0.8), FallRule::Lying];
        assert_eq!(FallRule::between([upright, low], 0.0), upright);
        assert_eq!(FallRule::between([upright, low], 0.1), low);
        assert_eq!(FallRule::between([FallRule::Never, low], 0.5), FallRule::Never);
        assert_eq!(FallRule::between([upright, FallRule::Upright(1.0)], 0.5), FallRule::Upright(0.9));
        assert!(low.rises_to(upright) && !upright.rises_to(low) && !upright.rises_to(upright));
    }

    #[test]
    fn on_hands_and_knees_nobody_lies_but_nobody_is_upright() {
        let mut state = CharacterState::default();
        for metres in [0.3, 0.1] {
            state.bodies.iter_mut().for_each(|body| body.position.z = metres);
            assert!(
                FallRule::Upright(1.0).is_broken_by(&state, true)
                    && !FallRule::Never.is_broken_by(&state, true)
            );
            assert_eq!(FallRule::Lying.is_broken_by(&state, true), metres < 0.2);
            assert!(
                FallRule::Again.is_broken_by(&state, true) && !FallRule::Again.is_broken_by(&state, false)
            );
        }
    }
}
