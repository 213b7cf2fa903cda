//! Writes the pictures of a recording: numbered files, a film through ffmpeg, an animation.

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::Receiver;

use super::{Frame, RecorderError, folder_at, save};

/// Longest time that one picture is shown, in pictures of the film: half a minute.
const LONGEST_SHOWN: u32 = 900;

/// Lines of a program's last words that are told.
const SAID_LINES: usize = 3;

/// Writes numbered pictures; returns when each of them is shown.
pub(super) fn sequence(folder: &Path, frames: &Receiver<Frame>) -> Result<Vec<u32>, RecorderError> {
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

pub(super) fn mp4(
    path: &Path,
    [width, height]: [u32; 2],
    fps: u32,
    frames: &Receiver<Frame>,
) -> Result<(), RecorderError> {
    let file = |source| RecorderError::File { path: path.to_owned(), source };
    folder_at(path.parent().unwrap_or(Path::new(".")))?;
    let unfinished = Unfinished(path.with_extension(format!("{}.partial", std::process::id())));
    let mut ffmpeg = Command::new("ffmpeg")
        .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba"])
        .args(["-s", &format!("{width}x{height}"), "-r", &fps.to_string(), "-i", "-"])
        // H.264 wants even sizes.
        .args(["-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2", "-pix_fmt", "yuv420p", "-f", "mp4"])
        .arg(&unfinished.0)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(file)?;
    // What it says is read while it runs: a full pipe would stop it.
    let (pipe, said) = (ffmpeg.stdin.take(), ffmpeg.stderr.take());
    let said = std::thread::spawn(move || said.map(said_by).unwrap_or_default());
    let fed = pipe.map_or(Ok(()), |pipe| feed(pipe, frames));
    let ended = ffmpeg.wait().map_err(file)?;
    let message = said.join().unwrap_or_default();
    if !ended.success() {
        let message = if message.is_empty() { ended.to_string() } else { message };
        return Err(RecorderError::Ffmpeg { path: path.to_owned(), message });
    }
    fed.and_then(|()| std::fs::rename(&unfinished.0, path)).map_err(file)
}

/// Writes every picture as often as it is shown; the pipe is closed at the end.
fn feed(mut pipe: impl Write, frames: &Receiver<Frame>) -> io::Result<()> {
    let mut shown: Option<Frame> = None;
    for next in frames {
        if let Some((picture, since)) = shown.take() {
            for _ in 0..next.1.saturating_sub(since).clamp(1, LONGEST_SHOWN) {
                pipe.write_all(picture.as_raw())?;
            }
        }
        shown = Some(next);
    }
    shown.map_or(Ok(()), |(picture, _)| pipe.write_all(picture.as_raw()))
}

/// The end of what a program says, in one line.
fn said_by(mut from: impl Read) -> String {
    let mut bytes = Vec::new();
    // What was read before an error is worth as much.
    let _ = from.read_to_end(&mut bytes);
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    lines[lines.len().saturating_sub(SAID_LINES)..].join("; ")
}

/// A film on its way, beside its file; removed when it does not get there.
struct Unfinished(PathBuf);

impl Drop for Unfinished {
    fn drop(&mut self) {
        // The error that led here is returned; after a rename there is nothing to remove.
        let _ = std::fs::remove_file(&self.0);
    }
}

/// An animation must say beforehand how many pictures it has, so they are kept, compressed, until the end.
pub(super) fn apng(
    path: &Path,
    size: [u32; 2],
    fps: u32,
    frames: &Receiver<Frame>,
) -> Result<(), RecorderError> {
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
