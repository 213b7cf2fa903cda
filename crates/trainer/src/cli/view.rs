//! `trainer view`: a clip fitted to the humanoid, told in numbers, written as poses, or drawn by the demo, which is
//! a program of its own: the trainer itself draws nothing.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use clap::Args;
use clips::{ClipFolder, Fitted, Leap, fit, load_file};
use files::write_atomically;
use physics_bridge::Model;
use serde::Serialize;
use trainer::recipe::ClipShare;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Name of a clip in the folder of clips, or a clip file.
    clip: String,
    /// Make its cycle alike to both sides.
    #[arg(long)]
    symmetric: bool,
    /// Play it backwards.
    #[arg(long)]
    reversed: bool,
    /// Play it faster or slower by this factor.
    #[arg(long, default_value_t = 1.0, value_name = "FACTOR", value_parser = pace)]
    pace: f32,
    /// Make steps to the left at this speed, metres per second, of its first pose.
    #[arg(long, value_name = "MPS", value_parser = side_steps)]
    side_steps: Option<f32>,
    /// Make a punch of its first pose.
    #[arg(long, conflicts_with = "side_steps")]
    punch: bool,
    /// Make a leap of a run: a flight between these seconds lasts so long, as `0.27,0.43,0.35`.
    #[arg(long, value_name = "FROM,TO,SECONDS", value_parser = leap)]
    leap: Option<Leap>,
    /// File to write the poses to: JSON, one list of `qpos` a control tick.
    #[arg(long)]
    poses: Option<PathBuf>,
    /// Folder to draw the clip into as pictures, by the demo without a window.
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// The demo's program, instead of the `policy-space` beside this one.
    #[arg(long, value_name = "PATH", requires = "pictures")]
    viewer: Option<PathBuf>,
}

fn pace(text: &str) -> Result<f32, String> {
    number(text, 0.1..=10.0)
}

fn side_steps(text: &str) -> Result<f32, String> {
    number(text, 0.1..=1.5)
}

fn leap(text: &str) -> Result<Leap, String> {
    let numbers: Vec<f32> = text.split(',').map_while(|number| number.parse().ok()).collect();
    match numbers[..] {
        [from, to, seconds] => Ok(Leap { flight: [from, to], seconds }),
        _ => Err("expected three numbers, as 0.27,0.43,0.35".into()),
    }
}

/// A number within the range that a recipe allows too.
fn number(text: &str, range: RangeInclusive<f32>) -> Result<f32, String> {
    let within = text.parse().ok().filter(|number| range.contains(number));
    within.ok_or_else(|| format!("expected a number from {} to {}", range.start(), range.end()))
}

/// Poses at the control rate, for a renderer to play.
#[derive(Serialize)]
struct Poses<'a> {
    format: &'static str,
    clip: &'a str,
    hz: f64,
    qpos: Vec<&'a [f64]>,
}

/// Fits, tells, writes and draws.
pub(crate) fn run(model: &Model, folder: impl Fn() -> Result<ClipFolder>, a: &Arguments) -> Result<()> {
    let file = PathBuf::from(&a.clip);
    let clip = if file.is_file() { load_file(&file)? } else { folder()?.load(&a.clip)? };
    let made = ClipShare {
        symmetric: a.symmetric,
        reversed: a.reversed,
        pace: a.pace,
        side_steps_mps: a.side_steps,
        punch: a.punch,
        leap: a.leap,
        ..ClipShare::whole(&clip.name)
    };
    let clip = made.made_of(clip)?;
    let fitted = fit(&clip, model)?;
    let (radians, joint) = &fitted.motion.outside_limits;
    let lowest = fitted.clearances.iter().copied().fold(f32::INFINITY, f32::min);
    say(format_args!(
        "{}: {:.2} s, {}, {:.2} m/s, lifted by {:.3} m, then {:.3} m in the ground at worst; \
         leaves its joint limits by at most {:.1} degrees ({joint})",
        clip.name,
        clip.duration(),
        if clip.looping { "loops" } else { "ends" },
        fitted.motion.mean_speed(),
        fitted.lift,
        (-lowest).max(0.0),
        radians.to_degrees(),
    ))?;
    if let Some(path) = &a.poses {
        write(&fitted, &clip.name, path)?;
        say(format_args!("wrote {}", path.display()))?;
    }
    let Some(pictures) = &a.pictures else { return Ok(()) };
    let viewer = viewer_program(a.viewer.as_deref())?;
    let scratch = Scratch::new()?;
    let poses = scratch.0.join("poses.json");
    write(&fitted, &clip.name, &poses)?;
    let status = Command::new(&viewer)
        .args(["--headless", "--poses"])
        .arg(&poses)
        .arg("--frames")
        .arg(pictures)
        .status()
        .with_context(|| format!("cannot run {}", viewer.display()))?;
    drop(scratch);
    match status.code() {
        Some(0) => Ok(()),
        // The demo has said what is wrong.
        Some(code) => std::process::exit(code),
        None => bail!("{} was ended: {status}", viewer.display()),
    }
}

/// A folder that goes with its owner.
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Result<Self> {
        let path = std::env::temp_dir().join(format!("policy-space-view-{}", std::process::id()));
        std::fs::create_dir(&path).with_context(|| format!("cannot make the folder {}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What can't be removed is left in the system's temporary folder.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Writes the poses of the control ticks.
fn write(fitted: &Fitted, clip: &str, path: &Path) -> Result<()> {
    let stride = clips::TICK_STRIDE;
    let qpos = fitted.motion.poses.iter().step_by(stride).map(|p| &p.qpos[..]).collect();
    let hz = 1.0 / (fitted.motion.dt_secs * stride as f64);
    let poses = Poses { format: "policy-space poses", clip, hz, qpos };
    let text = serde_json::to_string(&poses)?;
    write_atomically(path, text.as_bytes()).with_context(|| format!("cannot write {}", path.display()))
}

/// The demo's program: the named one, or the one that was built beside this.
fn viewer_program(named: Option<&Path>) -> Result<PathBuf> {
    let program = match named {
        Some(path) => path.to_owned(),
        None => {
            let own = std::env::current_exe().context("cannot tell where this program lies")?;
            own.with_file_name(format!("policy-space{}", std::env::consts::EXE_SUFFIX))
        }
    };
    if !program.is_file() {
        bail!(
            "expected the demo's program at {}, found none: build it with `cargo build --release -p viewer`, \
             or name it with --viewer PATH",
            program.display()
        );
    }
    Ok(program)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_viewer_is_named_with_the_way_to_build_it() {
        let said = viewer_program(Some(Path::new("no/such/policy-space"))).unwrap_err().to_string();
        assert!(
            said.contains("no/such/policy-space") && said.contains("cargo build --release -p viewer"),
            "{said}"
        );
        let own = std::env::current_exe().unwrap();
        assert_eq!(viewer_program(Some(&own)).unwrap(), own);
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert_eq!((pace("0.5"), side_steps("0.4")), (Ok(0.5), Ok(0.4)));
        for text in ["0", "-1", "NaN", "inf", "fast", "11"] {
            assert_eq!(pace(text), Err("expected a number from 0.1 to 10".to_owned()), "{text}");
        }
        assert!(side_steps("1.6").is_err());
    }

    #[test]
    fn a_scratch_folder_goes_with_its_owner() {
        let scratch = Scratch::new().unwrap();
        let path = scratch.0.clone();
        std::fs::write(path.join("poses.json"), "x").unwrap();
        drop(scratch);
        assert!(!path.exists());
    }
}
