//! Writes pictures and films on a thread of its own, so that the demo does not wait for the disk.

mod writers;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;

use image::imageops::FilterType;
use image::{ImageFormat, RgbaImage};

use crate::files;
use writers::{apng, mp4, sequence};

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
    #[error("ffmpeg failed on {}: {message}", path.display())]
    Ffmpeg {
        /// The film.
        path: PathBuf,
        /// What it said.
        message: String,
    },
    /// The thread that writes has panicked.
    #[error("{} was not written: the recorder stopped", path.display())]
    Stopped {
        /// The file.
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
    /// How its file or folder is named at the end.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Kind::Sequence => "frames",
            Kind::Mp4 => "mp4",
            Kind::Apng => "apng",
        }
    }

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
            Some(Err(_)) => Err(RecorderError::Stopped { path: self.path }),
            None => Ok(self.dropped),
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
