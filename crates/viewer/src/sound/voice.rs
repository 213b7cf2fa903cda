//! One sound that rings: its modes as turning pairs of numbers, its noise through a filter of one pole.

use std::f32::consts::{FRAC_PI_4, TAU};

use super::Sound;

/// Most modes of a material.
const MOST_MODES: usize = 4;
/// It ends when its level has fallen to this share.
const INAUDIBLE: f32 = 1e-4;
/// Frequencies are kept below this share of the sample rate.
const HIGHEST: f32 = 0.45;

/// A mode: a pair of numbers that turns and shrinks.
#[derive(Clone, Copy, Debug, Default)]
struct Ringing {
    sine: f32,
    cosine: f32,
    /// By what the pair is multiplied for each sample, a complex number.
    turn: [f32; 2],
}

impl Ringing {
    fn new(hz: f32, secs: f32, gain: f32, rate: f32) -> Self {
        let (sine, cosine) = (TAU * hz.min(HIGHEST * rate) / rate).sin_cos();
        let decay = (-1.0 / (secs * rate)).exp();
        Self { sine: 0.0, cosine: gain, turn: [decay * cosine, decay * sine] }
    }

    fn next(&mut self) -> f32 {
        let [cosine, sine] = self.turn;
        (self.cosine, self.sine) =
            (self.cosine * cosine - self.sine * sine, self.cosine * sine + self.sine * cosine);
        self.sine
    }
}

/// A sound on its way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Voice {
    modes: [Ringing; MOST_MODES],
    /// Samples until it begins.
    wait: u32,
    /// Level of the attack, and what is added for each sample until it is 1.
    attack: [f32; 2],
    /// Level of the noise, and the factor on it for each sample.
    noise: [f32; 2],
    /// Share of the new sample in the filtered noise, and the filtered noise.
    filter: [f32; 2],
    random: u32,
    /// An upper bound on what it can still reach, and the factor on that for each sample. 0 is a free voice.
    level: [f32; 2],
    /// Left and right.
    sides: [f32; 2],
}

impl Voice {
    /// `seed` tells its noise from that of others.
    pub(super) fn new(sound: &Sound, rate: f32, seed: u32) -> Self {
        let recipe = sound.timbre.recipe();
        let pitch = within(sound.pitch, 0.25, 4.0, 1.0);
        let strength = within(sound.strength, 0.0, 1.0, 0.0);
        // Equal power on both sides together.
        let (right, left) = ((1.0 + within(sound.pan, -1.0, 1.0, 0.0)) * FRAC_PI_4).sin_cos();
        let mut modes = [Ringing::default(); MOST_MODES];
        let (mut whole, mut longest) = (recipe.noise.gain, recipe.noise.secs);
        for (ringing, mode) in modes.iter_mut().zip(recipe.modes) {
            *ringing = Ringing::new(mode.hz * pitch, mode.secs, mode.gain, rate);
            (whole, longest) = (whole + mode.gain, longest.max(mode.secs));
        }
        // What is struck harder is brighter too.
        let cutoff = recipe.noise.cutoff_hz * pitch * (0.5 + strength);
        let fade = |secs: f32| (-1.0 / (secs * rate)).exp();
        Self {
            modes,
            wait: (within(sound.delay_secs, 0.0, 10.0, 0.0) * rate) as u32,
            attack: [0.0, 1.0 / (recipe.attack_secs * rate).max(1.0)],
            noise: [recipe.noise.gain, fade(recipe.noise.secs)],
            filter: [1.0 - (-TAU * cutoff.min(HIGHEST * rate) / rate).exp(), 0.0],
            random: seed.wrapping_mul(0x9e37_79b9) | 1,
            level: [strength * whole, fade(longest)],
            sides: [left, right].map(|side| side * strength),
        }
    }

    /// What it can still reach: 0 once it has ended.
    pub(super) fn level(&self) -> f32 {
        self.level[0]
    }

    /// Adds its next sample to both sides.
    pub(super) fn add_to(&mut self, out: &mut [f32; 2]) {
        if self.wait > 0 {
            self.wait -= 1;
            return;
        }
        let mut sample: f32 = self.modes.iter_mut().map(Ringing::next).sum();
        self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let white = (self.random >> 8) as f32 / 8_388_608.0 - 1.0;
        self.filter[1] += self.filter[0] * (white - self.filter[1]);
        sample += self.noise[0] * self.filter[1];
        self.noise[0] *= self.noise[1];
        self.attack[0] = (self.attack[0] + self.attack[1]).min(1.0);
        sample *= self.attack[0];
        out[0] += sample * self.sides[0];
        out[1] += sample * self.sides[1];
        self.level[0] *= self.level[1];
        if self.level[0] < INAUDIBLE {
            *self = Self::default();
        }
    }
}

/// A number in its range; `instead` when it is not finite.
fn within(value: f32, least: f32, most: f32, instead: f32) -> f32 {
    if value.is_finite() { value.clamp(least, most) } else { instead }
}
