//! Writes pictures and films on a thread of its own, so that the demo goes on.

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

/// Kinds of recording that go on.
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

/// A recording that goes on until it is finished.
#[derive(Debug)]
pub struct Recorder {
    frames: Option<SyncSender<RgbaImage>>,
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
            Kind::Sequence => sequence(&target, &waiting),
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

    /// Takes a picture; false when the recording has failed. A picture too many is dropped, one of another
    /// size, as after the window was resized, is fitted into the film.
    pub fn take(&mut self, picture: RgbaImage) -> bool {
        let [width, height] = self.size;
        let picture = match picture.dimensions() == (width, height) {
            true => picture,
            false => image::imageops::resize(&picture, width, height, FilterType::Triangle),
        };
        match self.frames.as_ref().map(|f| f.try_send(picture)) {
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

    /// Ends the recording, waits until all is written and answers how many pictures were dropped.
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
    files::write(path, bytes.get_ref()).map_err(|source| RecorderError::File { path: path.to_owned(), source })
}

fn folder_at(path: &Path) -> Result<(), RecorderError> {
    std::fs::create_dir_all(path).map_err(|source| RecorderError::File { path: path.to_owned(), source })
}

fn sequence(folder: &Path, frames: &Receiver<RgbaImage>) -> Result<(), RecorderError> {
    for (number, picture) in frames.iter().enumerate() {
        save(&picture, &folder.join(format!("frame_{number:05}.png")))?;
    }
    Ok(())
}

fn mp4(
    path: &Path,
    [width, height]: [u32; 2],
    fps: u32,
    frames: &Receiver<RgbaImage>,
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
        for picture in frames {
            pipe.write_all(picture.as_raw()).map_err(file)?;
        }
    }
    match ffmpeg.wait() {
        Ok(status) if status.success() => Ok(()),
        _ => Err(RecorderError::Ffmpeg { path: path.to_owned() }),
    }
}

/// An animation must say beforehand how many pictures it has, so they are kept, compressed, until the end.
fn apng(
    path: &Path,
    [width, height]: [u32; 2],
    fps: u32,
    frames: &Receiver<RgbaImage>,
) -> Result<(), RecorderError> {
    let encoding = |source| RecorderError::Animation { path: path.to_owned(), source };
    let scratch = path.with_extension("parts");
    sequence(&scratch, frames)?;
    let mut count = 0;
    while scratch.join(format!("frame_{count:05}.png")).exists() {
        count += 1;
    }
    if count > 0 {
        let file = std::fs::File::create(path)
            .map_err(|source| RecorderError::File { path: path.to_owned(), source })?;
        let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_animated(count, 0).map_err(encoding)?;
        encoder.set_frame_delay(1, fps.min(1000) as u16).map_err(encoding)?;
        let mut writer = encoder.write_header().map_err(encoding)?;
        for number in 0..count {
            let part = scratch.join(format!("frame_{number:05}.png"));
            let picture =
                image::open(&part).map_err(|source| RecorderError::Picture { path: part.clone(), source })?;
            writer.write_image_data(&picture.to_rgba8()).map_err(encoding)?;
        }
        writer.finish().map_err(encoding)?;
    }
    if !scratch.exists() {
        return Ok(());
    }
    std::fs::remove_dir_all(&scratch).map_err(|source| RecorderError::File { path: scratch.clone(), source })
}
