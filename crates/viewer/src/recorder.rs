//! Writes pictures and films on a thread of its own, so that the demo does not wait for the disk.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;

use image::imageops::FilterType;
use image::{ImageFormat, RgbaImage};

use crate::files;

/// Frames that may wait for the disk; more are dropped.
const WAITING: usize = 8;
/// Longest time that one picture is shown, in pictures of the film: half a minute.
const LONGEST_SHOWN: u32 = 900;

/// Why nothing can be recorded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecorderError {
    /// The folder or a file can't be made.
    #[error("cannot write {}: {source}", path.display())]
    File {
        /// The path.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A picture can't be encoded or written.
    #[error("{}: {source}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
    /// The animation can't be encoded or written.
    #[error("{}: {source}", path.display())]
    Animation {
        /// The file.
        path: PathBuf,
        /// Why.
        source: png::EncodingError,
    },
    /// ffmpeg ended early.
    #[error("ffmpeg failed on {}", path.display())]
    Ffmpeg {
        /// The film.
        path: PathBuf,
    },
}

/// Kinds of recording, besides single pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// PNG files, numbered.
    Sequence,
    /// MP4 with ffmpeg.
    Mp4,
    /// Animated PNG.
    Apng,
}

impl Kind {
    /// MP4 where ffmpeg is there, else APNG.
    #[must_use]
    pub fn film() -> Self {
        let found =
            Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if found.is_ok_and(|status| status.success()) { Kind::Mp4 } else { Kind::Apng }
    }
}

/// A picture, and when it is shown: so many pictures of the film after the start.
type Frame = (RgbaImage, u32);

/// A recording that runs until it is finished.
#[derive(Debug)]
pub struct Recorder {
    frames: Option<SyncSender<Frame>>,
    thread: Option<JoinHandle<Result<(), RecorderError>>>,
    path: PathBuf,
    size: [u32; 2],
    dropped: usize,
}

impl Recorder {
    /// Starts to record pictures of `size`, `fps` a second, into `path`: a folder for a sequence, else a file.
    #[must_use]
    pub fn start(kind: Kind, path: PathBuf, size: [u32; 2], fps: u32) -> Self {
        let (frames, waiting) = sync_channel(WAITING);
        let target = path.clone();
        let thread = std::thread::spawn(move || match kind {
            Kind::Sequence => sequence(&target, &waiting).map(|_| ()),
            Kind::Mp4 => mp4(&target, size, fps, &waiting),
            Kind::Apng => apng(&target, size, fps, &waiting),
        });
        Self { frames: Some(frames), thread: Some(thread), path, size, dropped: 0 }
    }

    /// Where it goes.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes a picture that is shown `at` so many pictures of the film after the start, later than the one before;
    /// that one is shown until then. False when the recording has failed. A picture too many is dropped, one of
    /// another size, as after the window was resized, is fitted into the film.
    pub fn take(&mut self, picture: RgbaImage, at: u32) -> bool {
        let [width, height] = self.size;
        let picture = match picture.dimensions() == (width, height) {
            true => picture,
            false => image::imageops::resize(&picture, width, height, FilterType::Triangle),
        };
        match self.frames.as_ref().map(|f| f.try_send((picture, at))) {
            Some(Ok(())) => true,
            Some(Err(TrySendError::Full(_))) => {
                self.dropped += 1;
                true
            }
            _ => false,
        }
    }

    /// Takes no more pictures and writes what is left; does not wait for it.
    pub fn close(&mut self) {
        self.frames = None;
    }

    /// True when all is written, after [`Recorder::close`] or a failure.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Ends the recording, waits until all is written and returns how many pictures were dropped.
    ///
    /// # Errors
    /// When anything could not be written.
    pub fn finish(mut self) -> Result<usize, RecorderError> {
        self.close();
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result.map(|()| self.dropped),
            _ => Ok(self.dropped),
        }
    }
}

/// Writes one picture.
///
/// # Errors
/// When its folder can't be made or it can't be written; no part of it is left then.
pub fn save(picture: &RgbaImage, path: &Path) -> Result<(), RecorderError> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|source| RecorderError::Picture { path: path.to_owned(), source })?;
    files::write(path, bytes.get_ref())
        .map_err(|source| RecorderError::File { path: path.to_owned(), source })
}

fn folder_at(path: &Path) -> Result<(), RecorderError> {
    std::fs::create_dir_all(path).map_err(|source| RecorderError::File { path: path.to_owned(), source })
}

/// Writes numbered pictures; returns when each of them is shown.
fn sequence(folder: &Path, frames: &Receiver<Frame>) -> Result<Vec<u32>, RecorderError> {
    let mut shown_at = Vec::new();
    for (picture, at) in frames {
        save(&picture, &part(folder, shown_at.len()))?;
        shown_at.push(at);
    }
    Ok(shown_at)
}

fn part(folder: &Path, number: usize) -> PathBuf {
    folder.join(format!("frame_{number:05}.png"))
}

fn mp4(
    path: &Path,
    [width, height]: [u32; 2],
    fps: u32,
    frames: &Receiver<Frame>,
) -> Result<(), RecorderError> {
    let file = |source| RecorderError::File { path: path.to_owned(), source };
    folder_at(path.parent().unwrap_or(Path::new(".")))?;
    let mut ffmpeg: Child = Command::new("ffmpeg")
        .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba"])
        .args(["-s", &format!("{width}x{height}"), "-r", &fps.to_string(), "-i", "-"])
        // H.264 wants even sizes.
        .args(["-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2", "-pix_fmt", "yuv420p"])
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(file)?;
    if let Some(mut pipe) = ffmpeg.stdin.take() {
        let mut shown: Option<Frame> = None;
        for next in frames {
            if let Some((picture, since)) = shown.take() {
                for _ in 0..next.1.saturating_sub(since).clamp(1, LONGEST_SHOWN) {
                    pipe.write_all(picture.as_raw()).map_err(file)?;
                }
            }
            shown = Some(next);
        }
        if let Some((picture, _)) = shown {
            pipe.write_all(picture.as_raw()).map_err(file)?;
        }
    }
    match ffmpeg.wait() {
        Ok(status) if status.success() => Ok(()),
        _ => Err(RecorderError::Ffmpeg { path: path.to_owned() }),
    }
}

/// An animation must say beforehand how many pictures it has, so they are kept, compressed, until the end.
fn apng(path: &Path, size: [u32; 2], fps: u32, frames: &Receiver<Frame>) -> Result<(), RecorderError> {
    let scratch = path.with_extension("parts");
    let written = sequence(&scratch, frames).and_then(|shown_at| match shown_at.len() {
        0 => Ok(()),
        _ => animation(path, size, fps, &scratch, &shown_at),
    });
    let removed = match scratch.exists() {
        true => std::fs::remove_dir_all(&scratch),
        false => Ok(()),
    };
    written.and(removed.map_err(|source| RecorderError::File { path: scratch, source }))
}

fn animation(
    path: &Path,
    [width, height]: [u32; 2],
    fps: u32,
    parts: &Path,
    shown_at: &[u32],
) -> Result<(), RecorderError> {
    let encoding = |source| RecorderError::Animation { path: path.to_owned(), source };
    let file = |source| RecorderError::File { path: path.to_owned(), source };
    // Under the folder of the parts until it is whole: what fails goes with them.
    let whole = parts.join("whole");
    let out = std::fs::File::create(&whole).map_err(file)?;
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(out), width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(shown_at.len() as u32, 0).map_err(encoding)?;
    encoder.set_frame_delay(1, fps.min(1000) as u16).map_err(encoding)?;
    let mut writer = encoder.write_header().map_err(encoding)?;
    for (number, at) in shown_at.iter().enumerate() {
        let part = part(parts, number);
        let picture =
            image::open(&part).map_err(|source| RecorderError::Picture { path: part.clone(), source })?;
        let until = shown_at.get(number + 1).copied().unwrap_or(at + 1);
        let shown = until.saturating_sub(*at).clamp(1, LONGEST_SHOWN);
        writer.set_frame_delay(shown as u16, fps.min(1000) as u16).map_err(encoding)?;
        writer.write_image_data(&picture.to_rgba8()).map_err(encoding)?;
    }
    writer.finish().map_err(encoding)?;
    std::fs::rename(&whole, path).map_err(file)
}
