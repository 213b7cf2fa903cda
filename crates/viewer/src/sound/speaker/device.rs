//! The device: asks the synthesiser for samples when it needs some.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};

use cpal::traits::{DeviceTrait as _, HostTrait as _, StreamTrait as _};
use cpal::{Error, ErrorKind, FromSample, OutputCallbackInfo, SampleFormat, SizedSample, Stream};

use super::{SpeakerState, Status};
use crate::sound::{Sound, Synth};

/// Plays until the device is gone or the demo needs no more sound.
pub(super) fn run(sounds: Receiver<Sound>, status: &Arc<Status>) {
    let (end, ended) = sync_channel(1);
    let stream = is_expected().then(|| open(sounds, status, end)).flatten();
    let Some(stream) = stream.filter(|stream| stream.play().is_ok()) else {
        return status.set(SpeakerState::NoDevice);
    };
    status.set(SpeakerState::Playing);
    // Both ends say the same: there is nothing more to play, or nothing to play it on.
    let _ = ended.recv();
    status.set(SpeakerState::NoDevice);
    drop(stream);
}

/// ALSA complains on standard error when it is asked for a device where none is. It is asked only where a card, a sound server or a
/// configuration of the user is to be seen.
#[cfg(target_os = "linux")]
fn is_expected() -> bool {
    use std::path::Path;

    let entries = std::fs::read_dir("/dev/snd").into_iter().flatten().flatten();
    let plays = |name: &std::ffi::OsStr| {
        name.to_str().is_some_and(|name| name.starts_with("pcm") && name.ends_with('p'))
    };
    let named = |variable: &str| std::env::var_os(variable).filter(|value| !value.is_empty());
    let serves = || {
        let folder = named("XDG_RUNTIME_DIR")?;
        let socket = |name| Path::new(&folder).join(name).exists();
        Some(socket("pulse/native") || socket("pipewire-0"))
    };
    let configured = || Some(Path::new(&named("HOME")?).join(".asoundrc").exists());
    entries.map(|entry| entry.file_name()).any(|name| plays(&name))
        || named("PULSE_SERVER").is_some()
        || named("ALSA_CONFIG_PATH").is_some()
        || serves().unwrap_or(false)
        || configured().unwrap_or(false)
}

#[cfg(not(target_os = "linux"))]
const fn is_expected() -> bool {
    true
}

/// A stream that is not running yet; `None` where there is no device or one of another kind.
fn open(sounds: Receiver<Sound>, status: &Arc<Status>, end: SyncSender<()>) -> Option<Stream> {
    let device = cpal::default_host().default_output_device()?;
    let config = device.default_output_config().ok()?;
    let feed = Feed { sounds, synth: Synth::new(config.sample_rate()), status: Arc::clone(status), end };
    let opened = match config.sample_format() {
        SampleFormat::F32 => stream::<f32>(&device, &config.into(), feed),
        SampleFormat::I16 => stream::<i16>(&device, &config.into(), feed),
        SampleFormat::U16 => stream::<u16>(&device, &config.into(), feed),
        SampleFormat::I32 => stream::<i32>(&device, &config.into(), feed),
        _ => return None,
    };
    opened.ok()
}

/// What the stream takes its samples from.
struct Feed {
    sounds: Receiver<Sound>,
    synth: Synth,
    status: Arc<Status>,
    end: SyncSender<()>,
}

impl Feed {
    /// Takes what has come since the last call.
    fn follow(&mut self) {
        self.synth.set_volume(self.status.volume());
        loop {
            match self.sounds.try_recv() {
                Ok(sound) => self.synth.play(&sound),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    let _ = self.end.try_send(());
                    break;
                }
            }
        }
    }
}

fn stream<T: SizedSample + FromSample<f32>>(
    device: &cpal::Device,
    config: &cpal::StreamConfig,
    mut feed: Feed,
) -> Result<Stream, Error> {
    let channels = usize::from(config.channels).max(1);
    let end = feed.end.clone();
    let fill = move |out: &mut [T], _: &OutputCallbackInfo| {
        feed.follow();
        for frame in out.chunks_mut(channels) {
            let [left, right] = feed.synth.sample();
            match frame {
                [only] => *only = T::from_sample(0.5 * (left + right)),
                [first, second, others @ ..] => {
                    (*first, *second) = (T::from_sample(left), T::from_sample(right));
                    others.fill(T::EQUILIBRIUM);
                }
                [] => {}
            }
        }
    };
    let stopped = move |error: Error| {
        // A gap is no end.
        if !matches!(error.kind(), ErrorKind::Xrun | ErrorKind::RealtimeDenied | ErrorKind::DeviceChanged) {
            let _ = end.try_send(());
        }
    };
    device.build_output_stream(*config, fill, stopped, None)
}
