//! When an episode fails. Stricter than a game's fall detector, which looks at the root alone.

use std::collections::BTreeMap;

use policy_core::{BodyId, CharacterState, Skeleton};
use serde::{Deserialize, Serialize};

/// What counts as a failure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// A body is lower than its least height.
    #[default]
    Upright,
    /// The character lies: for gaits on the ground.
    Lying,
    /// The character goes down again after having stood.
    Again,
    /// Nothing.
    Never,
}

/// When an episode fails.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TerminationConfig {
    /// What counts as a failure.
    pub rule: Termination,
    /// Factor on the least heights of the bodies; less than 1 for low gaits.
    pub height_factor: f32,
    /// Least heights of an upright character's bodies above the ground by their names, metres: of body frames, not of lowest
    /// points.
    pub min_heights: BTreeMap<String, f32>,
    /// A root lower than this above the ground has fallen in a game, metres; of upright gaits.
    pub fall_metres: f32,
    /// A root lower than this above the ground lies, metres.
    pub lying_metres: f32,
    /// A root higher than this above the ground stands, metres.
    pub standing_metres: f32,
    /// A root that stood and is lower than this has gone down again, metres.
    pub down_metres: f32,
    /// Early-termination threshold of clip tracking: root mean square distance of the bodies from the clip's, seen from the
    /// root, metres. A slow gait needs a small one, or a character that rests in one pose never exceeds it.
    pub max_tracking_error_metres: f32,
}

impl Default for TerminationConfig {
    fn default() -> Self {
        Self {
            rule: Termination::Upright,
            height_factor: 1.0,
            min_heights: BTreeMap::new(),
            fall_metres: 0.5,
            lying_metres: 0.2,
            standing_metres: 0.75,
            down_metres: 0.5,
            max_tracking_error_metres: 0.35,
        }
    }
}

/// Heights that tell standing from lying, for one character.
#[derive(Clone, Debug, PartialEq)]
pub struct TerminationHeights {
    upright: Vec<(BodyId, f32)>,
    lying_metres: f32,
    standing_metres: f32,
    down_metres: f32,
}

impl TerminationHeights {
    /// The heights of a recipe.
    ///
    /// # Errors
    /// The name of a body that the character does not have.
    pub fn new(config: &TerminationConfig, skeleton: &Skeleton) -> Result<Self, String> {
        let body = |name: &String| skeleton.body_named(name).ok_or_else(|| name.clone());
        let upright = config.min_heights.iter().map(|(name, metres)| Ok((body(name)?, *metres)));
        Ok(Self {
            upright: upright.collect::<Result<_, String>>()?,
            lying_metres: config.lying_metres,
            standing_metres: config.standing_metres,
            down_metres: config.down_metres,
        })
    }

    /// True when the root is as high as that of a standing character.
    #[must_use]
    pub fn stands(&self, state: &CharacterState) -> bool {
        state.root_height() > self.standing_metres
    }
}

/// What counts as a failure at a position on the graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TerminationRule {
    /// See [`Termination::Never`].
    Never,
    /// See [`Termination::Again`].
    Again,
    /// See [`Termination::Lying`].
    Lying,
    /// See [`Termination::Upright`]; with the factor on the heights.
    Upright(f32),
}

impl TerminationRule {
    /// The rule of a skill.
    #[must_use]
    pub fn of(config: &TerminationConfig) -> Self {
        match config.rule {
            Termination::Upright => Self::Upright(config.height_factor),
            Termination::Lying => Self::Lying,
            Termination::Again => Self::Again,
            Termination::Never => Self::Never,
        }
    }

    /// The rule between two nodes, with the weight of the second: upright only where both ends are.
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

    /// True where a character should be upright.
    #[must_use]
    pub fn is_upright(self) -> bool {
        matches!(self, Self::Upright(_))
    }

    /// True when the character has failed. `stood` tells whether it has [stood](TerminationHeights::stands) in this episode.
    #[must_use]
    pub fn is_broken_by(self, heights: &TerminationHeights, state: &CharacterState, stood: bool) -> bool {
        let root = state.root_height();
        match self {
            Self::Never => false,
            Self::Again => stood && root < heights.down_metres,
            Self::Lying => root < heights.lying_metres,
            Self::Upright(factor) => {
                heights.upright.iter().any(|(body, metres)| state.height_of(*body) < metres * factor)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_an_upright_and_a_low_node_only_lying_fails() {
        let [upright, low] = [TerminationRule::Upright(0.8), TerminationRule::Lying];
        let never = TerminationRule::Never;
        assert_eq!(TerminationRule::between([upright, low], 0.0), upright);
        assert_eq!(TerminationRule::between([upright, low], 0.1), low);
        assert_eq!(TerminationRule::between([never, low], 0.5), never);
        let both = TerminationRule::between([upright, TerminationRule::Upright(1.0)], 0.5);
        assert_eq!(both, TerminationRule::Upright(0.9));
    }

    #[test]
    fn on_hands_and_knees_a_character_is_neither_upright_nor_lying() {
        let config = TerminationConfig {
            min_heights: [("pelvis".to_owned(), 0.45)].into(),
            ..TerminationConfig::default()
        };
        let heights = TerminationHeights::new(&config, &Skeleton::humanoid()).unwrap();
        let mut state = CharacterState::new(&Skeleton::humanoid());
        for metres in [0.3, 0.1] {
            state.bodies.iter_mut().for_each(|body| body.position.z = metres);
            let broken = |rule: TerminationRule, stood| rule.is_broken_by(&heights, &state, stood);
            assert!(broken(TerminationRule::Upright(1.0), true) && !broken(TerminationRule::Never, true));
            assert!(!broken(TerminationRule::Upright(0.2), true));
            assert_eq!(broken(TerminationRule::Lying, true), metres < 0.2);
            assert!(broken(TerminationRule::Again, true) && !broken(TerminationRule::Again, false));
        }
    }

    #[test]
    fn a_body_that_the_character_lacks_is_named() {
        let min_heights = [("tail".to_owned(), 0.4)].into();
        let config = TerminationConfig { min_heights, ..TerminationConfig::default() };
        assert_eq!(TerminationHeights::new(&config, &Skeleton::humanoid()), Err("tail".to_owned()));
    }
}
