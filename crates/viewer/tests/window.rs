//! A real window under Xvfb, driven by the keys that xdotool sends: the character walks where it is told.
//! Skipped with a message where Xvfb, xdotool or an adapter is missing.

mod common;

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::{Duration, Instant};

use common::gpu;
use viewer::app::PanelLayout;

/// Ends its process when it goes out of scope.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn is_there(program: &str) -> bool {
    let found = Command::new("which").arg(program).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let found = found.is_ok_and(|status| status.success());
    if !found {
        eprintln!("skipped: {program} is not installed");
    }
    found
}

/// Starts Xvfb on a display that it chooses itself, and answers the display's name.
fn display() -> Option<(Running, String)> {
    let mut xvfb = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .ok()?;
    let mut line = String::new();
    let out = xvfb.stdout.take()?;
    let xvfb = Running(xvfb);
    BufReader::new(out).read_line(&mut line).ok()?;
    let number = line.trim();
    if number.is_empty() {
        eprintln!("skipped: Xvfb gives no display");
        return None;
    }
    Some((xvfb, format!(":{number}")))
}

/// The demo's trace, line by line.
struct Trace(BufReader<ChildStderr>);

impl Trace {
    /// Place of the pelvis and whether it lies, from the next line that says so.
    fn next(&mut self) -> [f32; 3] {
        let mut line = String::new();
        loop {
            line.clear();
            assert_ne!(self.0.read_line(&mut line).unwrap(), 0, "the demo has ended");
            if let Some(at) = line.strip_prefix("tick ").and_then(|l| l.split(" at ").nth(1)) {
                let numbers: Vec<f32> =
                    at.split_whitespace().take(3).filter_map(|n| n.parse().ok()).collect();
                return [numbers[0], numbers[1], numbers[2]];
            }
        }
    }

    /// Waits until `reached` says so of a place; the last place at the latest after 40 seconds, or once it lies.
    fn until(&mut self, reached: impl Fn([f32; 3]) -> bool) -> [f32; 3] {
        let start = Instant::now();
        loop {
            let at = self.next();
            if reached(at) || at[2] < STANDS || start.elapsed() > Duration::from_secs(40) {
                return at;
            }
        }
    }
}

/// A pelvis lower than this has fallen.
const STANDS: f32 = 0.6;
/// Within this way it may still be turning.
const TURNING_METRES: f32 = 1.5;
/// From there on it has to keep to its direction for this way.
const STRAIGHT_METRES: f32 = 1.5;
/// A policy may stumble where frames come irregularly; it must not do so every time.
const ATTEMPTS: usize = 12;

/// Starts the demo in a window, with its settings in a folder.
fn start_demo(display: &str, arguments: &[&str], settings: &Path) -> (Running, Trace) {
    let mut demo = Command::new(env!("CARGO_BIN_EXE_policy-space"))
        .args(["--no-pad", "--trace"])
        .args(arguments)
        .env("DISPLAY", display)
        .env("XDG_CONFIG_HOME", settings)
        .env_remove("WAYLAND_DISPLAY")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let trace = Trace(BufReader::new(demo.stderr.take().unwrap()));
    (Running(demo), trace)
}

fn xdotool(display: &str, arguments: &[&str]) {
    let sent = Command::new("xdotool").args(arguments).env("DISPLAY", display).status().unwrap();
    assert!(sent.success(), "{arguments:?}");
}

#[test]
fn settings_are_kept_at_once_and_outlive_a_kill() {
    if !is_there("Xvfb") || !is_there("xdotool") || gpu().is_none() {
        return;
    }
    let Some((_xvfb, display)) = display() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (demo, mut trace) = start_demo(&display, &["--size", "640x480"], folder.path());
    trace.next();
    xdotool(&display, &["search", "--sync", "--name", "Policy Space", "windowfocus"]);
    let path = folder.path().join("policy-space/layout.ron");
    let kept = || PanelLayout::load(&path).unwrap();
    assert_eq!(kept(), PanelLayout::default());
    // The switch to the advanced panels, then the next camera.
    xdotool(&display, &["mousemove", "190", "18", "click", "1"]);
    let start = Instant::now();
    while !kept().preferences.advanced {
        trace.next();
        assert!(start.elapsed() < Duration::from_secs(40), "the click changed nothing: {:?}", kept());
    }
    xdotool(&display, &["key", "c"]);
    while kept().camera == PanelLayout::default().camera {
        trace.next();
        assert!(start.elapsed() < Duration::from_secs(80), "the key changed nothing: {:?}", kept());
    }
    let before = kept();
    drop(demo);
    let (_demo, mut trace) = start_demo(&display, &["--size", "640x480"], folder.path());
    trace.next();
    assert_eq!(kept(), before);
}

#[test]
fn the_character_walks_where_the_keys_tell_it() {
    if !is_there("Xvfb") || !is_there("xdotool") || gpu().is_none() {
        return;
    }
    let Some((_xvfb, display)) = display() else { return };
    let (_demo, mut trace) = start_demo(&display, &["--no-layout", "--size", "320x240"], Path::new("."));
    let start = trace.next();
    let keys = |arguments: &[&str]| xdotool(&display, arguments);
    keys(&["search", "--sync", "--name", "Policy Space", "windowfocus"]);
    // Ahead is x, and the left of the screen is y.
    for (key, along, across) in [("w", 0, 1), ("a", 1, 0)] {
        let mut ends = Vec::new();
        let walked = (0..ATTEMPTS).any(|_| {
            keys(&["keydown", key]);
            let turned = trace.until(|at| at[along] > start[along] + TURNING_METRES);
            let end = trace.until(|at| at[along] > turned[along] + STRAIGHT_METRES);
            keys(&["keyup", key, "key", "BackSpace"]);
            ends.push([turned, end]);
            trace.until(|at| at[0].hypot(at[1]) < 0.2);
            let far = end[along] > start[along] + TURNING_METRES + STRAIGHT_METRES;
            far && end[2] > STANDS && (end[across] - turned[across]).abs() < 0.5 * STRAIGHT_METRES
        });
        assert!(walked, "{key}: it should have walked from {start:?}, and came to {ends:?}");
    }
}
