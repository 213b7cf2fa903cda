//! What each material sounds like when it is struck: a few modes that ring and a burst of noise.

use playground::Paint;
use policy_core::contract::Solid;

/// What a sound is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Timbre {
    /// A foot that is put down.
    Step,
    /// Any other part of a character.
    Body,
    /// Concrete and the ground.
    Stone,
    /// Crates, planks, the door.
    Wood,
    /// Barrels, poles, the pendulum.
    Steel,
    /// Balls.
    Rubber,
    /// A hinge that turns.
    Creak,
    /// Something that is thrown past.
    Air,
    /// A checkpoint, a best time.
    Bell,
}

/// A frequency that rings.
pub(super) struct Mode {
    /// Hertz.
    pub(super) hz: f32,
    /// Seconds until it is at 37 %.
    pub(super) secs: f32,
    /// Share of the whole.
    pub(super) gain: f32,
}

/// Noise that fades.
pub(super) struct Noise {
    /// Above this frequency it is weaker, hertz.
    pub(super) cutoff_hz: f32,
    /// Seconds until it is at 37 %.
    pub(super) secs: f32,
    /// Share of the whole.
    pub(super) gain: f32,
}

/// How a material sounds.
pub(super) struct Recipe {
    pub(super) modes: &'static [Mode],
    pub(super) noise: Noise,
    /// Seconds until it is at its full level.
    pub(super) attack_secs: f32,
}

const fn mode(hz: f32, secs: f32, gain: f32) -> Mode {
    Mode { hz, secs, gain }
}

const fn noise(cutoff_hz: f32, secs: f32, gain: f32) -> Noise {
    Noise { cutoff_hz, secs, gain }
}

/// A strike is at its full level after this time, seconds: fast enough for a click, slow enough not to crackle.
const STRIKE_SECS: f32 = 0.0008;

const fn strike_of(modes: &'static [Mode], noise: Noise) -> Recipe {
    Recipe { modes, noise, attack_secs: STRIKE_SECS }
}

impl Timbre {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Step,
        Self::Body,
        Self::Stone,
        Self::Wood,
        Self::Steel,
        Self::Rubber,
        Self::Creak,
        Self::Air,
        Self::Bell,
    ];

    /// What a thing of a shape and colour is made of: balls of rubber and drums of steel, whatever their colour.
    #[must_use]
    pub const fn of(solid: Option<&Solid>, paint: Paint) -> Self {
        match (solid, paint) {
            (_, Paint::Steel) | (Some(Solid::Cylinder { .. }), _) => Self::Steel,
            (Some(Solid::Sphere { .. }), _) => Self::Rubber,
            (_, Paint::Concrete) => Self::Stone,
            _ => Self::Wood,
        }
    }

    pub(super) const fn recipe(self) -> Recipe {
        match self {
            Self::Step => {
                const MODES: &[Mode] = &[mode(82.0, 0.03, 0.9), mode(155.0, 0.018, 0.35)];
                strike_of(MODES, noise(1500.0, 0.012, 0.9))
            }
            Self::Body => {
                const MODES: &[Mode] = &[mode(62.0, 0.07, 1.0), mode(118.0, 0.04, 0.4)];
                strike_of(MODES, noise(600.0, 0.03, 0.8))
            }
            Self::Stone => {
                const MODES: &[Mode] = &[mode(240.0, 0.012, 0.4), mode(910.0, 0.007, 0.25)];
                strike_of(MODES, noise(3500.0, 0.009, 0.8))
            }
            Self::Wood => {
                const MODES: &[Mode] =
                    &[mode(178.0, 0.055, 0.7), mode(431.0, 0.035, 0.45), mode(760.0, 0.02, 0.25)];
                strike_of(MODES, noise(2200.0, 0.01, 0.6))
            }
            Self::Steel => {
                const MODES: &[Mode] = &[
                    mode(311.0, 0.35, 0.45),
                    mode(817.0, 0.25, 0.3),
                    mode(1490.0, 0.16, 0.2),
                    mode(2630.0, 0.09, 0.12),
                ];
                strike_of(MODES, noise(5000.0, 0.006, 0.5))
            }
            Self::Rubber => {
                const MODES: &[Mode] = &[mode(132.0, 0.06, 1.0), mode(296.0, 0.025, 0.3)];
                strike_of(MODES, noise(900.0, 0.012, 0.4))
            }
            Self::Creak => {
                const MODES: &[Mode] =
                    &[mode(392.0, 0.1, 0.25), mode(415.0, 0.12, 0.25), mode(1204.0, 0.05, 0.1)];
                Recipe { modes: MODES, noise: noise(2500.0, 0.05, 0.1), attack_secs: 0.03 }
            }
            Self::Air => Recipe { modes: &[], noise: noise(900.0, 0.09, 1.2), attack_secs: 0.05 },
            Self::Bell => {
                const MODES: &[Mode] =
                    &[mode(660.0, 0.35, 0.5), mode(1320.0, 0.22, 0.2), mode(1986.0, 0.12, 0.1)];
                Recipe { modes: MODES, noise: noise(1000.0, 0.01, 0.0), attack_secs: 0.003 }
            }
        }
    }
}
