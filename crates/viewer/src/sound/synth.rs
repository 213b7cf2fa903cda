//! Makes samples of sounds. The same sounds at the same samples give the same samples; it allocates nothing and waits for nothing.

use super::Sound;
use super::voice::Voice;

/// Sounds at a time. The weakest makes room.
const VOICES: usize = 32;
/// Seconds in which the volume follows.
const VOLUME_SECS: f32 = 0.02;

/// The sounds that ring, for one sample rate.
#[derive(Clone, Debug)]
pub struct Synth {
    rate: f32,
    voices: [Voice; VOICES],
    begun: u32,
    /// Now, and where it goes.
    volume: [f32; 2],
}

impl Synth {
    /// Silent, for `rate` samples a second, at full volume.
    #[must_use]
    pub fn new(rate: u32) -> Self {
        let rate = rate.max(1) as f32;
        Self { rate, voices: [Voice::default(); VOICES], begun: 0, volume: [1.0; 2] }
    }

    /// The volume, from 0 to 1, that it goes to within some milliseconds.
    pub fn set_volume(&mut self, volume: f32) {
        self.volume[1] = if volume.is_finite() { volume.clamp(0.0, 1.0) } else { 0.0 };
    }

    /// Begins a sound. One without strength is none.
    pub fn play(&mut self, sound: &Sound) {
        self.begun = self.begun.wrapping_add(1);
        let voice = Voice::new(sound, self.rate, self.begun);
        if voice.level() <= 0.0 {
            return;
        }
        let weakest = self.voices.iter_mut().min_by(|a, b| a.level().total_cmp(&b.level()));
        let weakest = weakest.expect("there are voices");
        if weakest.level() < voice.level() {
            *weakest = voice;
        }
    }

    /// The next sample, left and right, each within the volume: what adds up to more is bent, not cut.
    pub fn sample(&mut self) -> [f32; 2] {
        let mut sides = [0.0; 2];
        for voice in self.voices.iter_mut().filter(|voice| voice.level() > 0.0) {
            voice.add_to(&mut sides);
        }
        self.volume[0] += (self.volume[1] - self.volume[0]) / (VOLUME_SECS * self.rate).max(1.0);
        sides.map(|side| side.tanh() * self.volume[0])
    }

    /// True while something rings.
    #[must_use]
    pub fn is_ringing(&self) -> bool {
        self.voices.iter().any(|voice| voice.level() > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sound::Timbre;

    const RATE: u32 = 48_000;

    /// Samples of `secs` seconds of these sounds, all begun at once.
    fn samples(sounds: &[Sound], secs: f32) -> Vec<[f32; 2]> {
        let mut synth = Synth::new(RATE);
        sounds.iter().for_each(|sound| synth.play(sound));
        (0..(secs * RATE as f32) as usize).map(|_| synth.sample()).collect()
    }

    fn energy(samples: &[[f32; 2]]) -> f32 {
        samples.iter().flatten().map(|side| side * side).sum()
    }

    #[test]
    fn without_sounds_it_is_silent_and_every_sound_ends() {
        assert_eq!(energy(&samples(&[], 0.5)), 0.0);
        for timbre in Timbre::ALL {
            let none = [Sound::new(timbre, 0.0), Sound::new(timbre, f32::NAN)];
            assert_eq!(energy(&samples(&none, 0.5)), 0.0, "{timbre:?} without strength");
            let mut synth = Synth::new(RATE);
            synth.play(&Sound::new(timbre, 1.0));
            assert!(synth.is_ringing());
            let heard: Vec<_> = (0..4 * RATE).map(|_| synth.sample()).collect();
            assert!(energy(&heard) > 1.0, "{timbre:?} is heard");
            assert!(!synth.is_ringing() && synth.sample() == [0.0; 2], "{timbre:?} ends");
        }
    }

    #[test]
    fn a_harder_strike_is_louder_for_every_material() {
        for timbre in Timbre::ALL {
            let levels =
                [0.1, 0.3, 0.6, 1.0].map(|strength| energy(&samples(&[Sound::new(timbre, strength)], 1.0)));
            assert!(levels.windows(2).all(|pair| pair[1] > 1.5 * pair[0]), "{timbre:?}: {levels:?}");
        }
    }

    #[test]
    fn the_level_is_bounded_however_much_rings() {
        let crowd: Vec<Sound> = Timbre::ALL
            .into_iter()
            .cycle()
            .take(200)
            .map(|timbre| Sound { pitch: f32::INFINITY, pan: 9.0, ..Sound::new(timbre, 1e9) })
            .collect();
        let heard = samples(&crowd, 1.0);
        let loudest = heard.iter().flatten().fold(0.0_f32, |most, side| most.max(side.abs()));
        assert!(loudest > 0.9 && loudest <= 1.0, "{loudest}");
    }

    #[test]
    fn equal_sounds_are_equal_samples_and_steps_differ_from_each_other() {
        let sounds = [Sound::new(Timbre::Step, 0.5), Sound::new(Timbre::Wood, 0.8)];
        assert_eq!(samples(&sounds, 0.2), samples(&sounds, 0.2));
        let mut synth = Synth::new(RATE);
        let mut step = || {
            synth.play(&Sound::new(Timbre::Step, 0.5));
            (0..RATE).map(|_| synth.sample()).collect::<Vec<_>>()
        };
        assert_ne!(step(), step(), "the noise is another");
    }

    #[test]
    fn volume_scales_and_zero_is_silent() {
        let at = |volume: f32| {
            let mut synth = Synth::new(RATE);
            synth.set_volume(volume);
            // It has followed before the sound begins.
            (0..RATE).for_each(|_| assert_eq!(synth.sample(), [0.0; 2]));
            synth.play(&Sound::new(Timbre::Steel, 0.7));
            energy(&(0..RATE).map(|_| synth.sample()).collect::<Vec<_>>())
        };
        assert!((at(0.5) / at(1.0) - 0.25).abs() < 1e-3);
        assert!(at(0.0) < 1e-12 * at(1.0));
    }

    #[test]
    fn pan_and_delay_place_a_sound() {
        let sound = Sound { pan: 1.0, delay_secs: 0.1, ..Sound::new(Timbre::Bell, 0.5) };
        let heard = samples(&[sound], 0.3);
        let before = (0.1 * RATE as f32) as usize;
        assert_eq!(energy(&heard[..before]), 0.0);
        assert!(heard.iter().all(|[left, _]| left.abs() < 1e-6));
        assert!(heard.iter().any(|[_, right]| right.abs() > 0.1));
    }
}
