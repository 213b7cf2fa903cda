//! Sounds of the demo, made from what happens: no files, the same samples for the same events.
//!
//! An [`Ear`] hears a world tick by tick and tells [`Sound`]s, a [`Synth`] makes samples of them, and [`Speaker`] plays those on a
//! device, if there is one.

mod ear;
mod memory;
mod speaker;
mod synth;
mod timbre;
mod voice;

pub use ear::{Ear, Listener};
pub use speaker::{Speaker, SpeakerState};
pub use synth::Synth;
pub use timbre::Timbre;

/// Something to be heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sound {
    /// What it is made of.
    pub timbre: Timbre,
    /// 0 is silence, 1 the loudest.
    pub strength: f32,
    /// Factor on every frequency; large things sound low.
    pub pitch: f32,
    /// -1 is left, 1 right.
    pub pan: f32,
    /// It begins so many seconds from now.
    pub delay_secs: f32,
}

impl Sound {
    /// A sound in the middle, at once.
    #[must_use]
    pub const fn new(timbre: Timbre, strength: f32) -> Self {
        Self { timbre, strength, pitch: 1.0, pan: 0.0, delay_secs: 0.0 }
    }

    /// Bells, one after another: their pitches, and the seconds between two.
    pub fn bells(pitches: &[f32], apart_secs: f32) -> impl Iterator<Item = Self> {
        let bell = move |(index, &pitch): (usize, &f32)| Self {
            pitch,
            delay_secs: index as f32 * apart_secs,
            ..Self::new(Timbre::Bell, 0.4)
        };
        pitches.iter().enumerate().map(bell)
    }
}
