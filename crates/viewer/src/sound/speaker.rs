//! Plays sounds on the machine's device, on a thread of its own. Without a device, or without the feature `sound`, it is silent: that
//! is no error and takes no time.

#[cfg(feature = "sound")]
mod device;

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::Sound;

/// Sounds on their way to the device. What comes while it is full is lost.
const WAITING: usize = 64;

/// Whether there is something to hear with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpeakerState {
    /// This program was built without sound, or it is a run without a window.
    #[default]
    NotBuilt,
    /// A device is being looked for.
    Looking,
    /// There is none, or it is gone.
    NoDevice,
    /// Sounds are played.
    Playing,
}

/// What the thread of the device and the demo share.
#[derive(Debug, Default)]
struct Status {
    state: AtomicU8,
    /// Bits of an `f32`.
    volume: AtomicU32,
}

impl Status {
    fn set(&self, state: SpeakerState) {
        self.state.store(state as u8, Ordering::Relaxed);
    }

    fn state(&self) -> SpeakerState {
        use SpeakerState::{Looking, NoDevice, NotBuilt, Playing};
        let states = [NotBuilt, Looking, NoDevice, Playing];
        states[usize::from(self.state.load(Ordering::Relaxed)).min(states.len() - 1)]
    }

    #[cfg_attr(not(feature = "sound"), expect(dead_code, reason = "only a device reads it"))]
    fn volume(&self) -> f32 {
        f32::from_bits(self.volume.load(Ordering::Relaxed))
    }
}

/// The way to the device.
#[derive(Debug)]
pub struct Speaker {
    sounds: SyncSender<Sound>,
    status: Arc<Status>,
}

impl Speaker {
    /// Looks for a device, on a thread of its own.
    #[must_use]
    pub fn start() -> Self {
        let (sounds, heard) = sync_channel(WAITING);
        let status = Arc::new(Status::default());
        open(heard, &status);
        Self { sounds, status }
    }

    /// Hands sounds on to the device at a volume from 0 to 1.
    pub fn play(&self, sounds: impl IntoIterator<Item = Sound>, volume: f32) {
        self.status.volume.store(volume.to_bits(), Ordering::Relaxed);
        for sound in sounds {
            // Without a device there is no receiver, and a device that is late has enough to play.
            let _ = self.sounds.try_send(sound);
        }
    }

    /// What became of the device.
    #[must_use]
    pub fn state(&self) -> SpeakerState {
        self.status.state()
    }
}

#[cfg(not(feature = "sound"))]
fn open(_: Receiver<Sound>, status: &Status) {
    status.set(SpeakerState::NotBuilt);
}

#[cfg(feature = "sound")]
fn open(sounds: Receiver<Sound>, status: &Arc<Status>) {
    status.set(SpeakerState::Looking);
    let of_thread = Arc::clone(status);
    let thread = std::thread::Builder::new().name("sound".into());
    if thread.spawn(move || device::run(sounds, &of_thread)).is_err() {
        status.set(SpeakerState::NoDevice);
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::sound::Timbre;

    #[test]
    fn a_speaker_never_waits_whether_there_is_a_device_or_not() {
        let start = Instant::now();
        let speaker = Speaker::start();
        for _ in 0..10 * WAITING {
            speaker.play([Sound::new(Timbre::Step, 0.5)], 0.0);
        }
        assert!(start.elapsed() < Duration::from_millis(500), "{:?}", start.elapsed());
        if cfg!(not(feature = "sound")) {
            assert_eq!(speaker.state(), SpeakerState::NotBuilt);
        }
        let deadline = Instant::now() + Duration::from_secs(20);
        while speaker.state() == SpeakerState::Looking {
            assert!(Instant::now() < deadline, "it looks for a device without end");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
