//! A real window under Xvfb, driven by the keys that xdotool sends and by scripted pads: characters walk where they are told,
//! settings are kept, first steps are ticked off, balls fly.
//! Skipped with a message where Xvfb, xdotool or an adapter is missing; with `POLICY_SPACE_NEED_WINDOW=1` that is a failure.

mod common;

use std::io::{BufRead as _, BufReader, Write as _};
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

/// Says that a test is skipped; panics where that must not happen.
fn skip(why: &str) {
    assert!(std::env::var_os("POLICY_SPACE_NEED_WINDOW").is_none(), "a window is needed: {why}");
    // Past the capture of the harness: who reads the log of a whole run sees it.
    let _ = writeln!(std::io::stderr(), "skipped, no test in a real window: {why}");
}

fn is_there(program: &str) -> bool {
    let found = Command::new("which").arg(program).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let found = found.is_ok_and(|status| status.success());
    if !found {
        skip(&format!("{program} is not installed"));
    }
    found
}

/// A display with a pointer and an adapter to draw with; `None` where the machine has none.
fn window() -> Option<(Running, String)> {
    if !is_there("Xvfb") || !is_there("xdotool") {
        return None;
    }
    if gpu().is_none() {
        skip("nothing can draw");
        return None;
    }
    display()
}

/// Starts Xvfb on a display that it chooses itself, and returns the display's name.
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
        skip("Xvfb gives no display");
        return None;
    }
    Some((xvfb, format!(":{number}")))
}

/// The demo's trace, line by line.
struct Trace(BufReader<ChildStderr>);

/// The three numbers after a word of a line.
fn numbers_after(line: &str, word: &str) -> Option<[f32; 3]> {
    let rest = line.split_whitespace().skip_while(|other| *other != word).skip(1);
    let numbers: Vec<f32> = rest.take(3).filter_map(|number| number.parse().ok()).collect();
    numbers.try_into().ok()
}

impl Trace {
    /// The next line of the trace.
    fn line(&mut self) -> String {
        let mut line = String::new();
        loop {
            line.clear();
            assert_ne!(self.0.read_line(&mut line).unwrap(), 0, "the demo has ended");
            if line.starts_with("tick ") {
                return line;
            }
        }
    }

    /// Place of the pelvis, from the next line.
    fn next(&mut self) -> [f32; 3] {
        numbers_after(&self.line(), "at").expect("every line says where the player is")
    }

    /// The first line that `wanted` accepts.
    fn wait_for(&mut self, what: &str, wanted: impl Fn(&str) -> bool) -> String {
        let start = Instant::now();
        loop {
            let line = self.line();
            if wanted(&line) {
                return line;
            }
            assert!(start.elapsed() < Duration::from_secs(120), "{what}: {line}");
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
    let Some((_xvfb, display)) = window() else { return };
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
    let Some((_xvfb, display)) = window() else { return };
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

#[test]
fn a_newcomers_first_minute_is_ticked_off_step_by_step() {
    let Some((_xvfb, display)) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    // With nothing in the way.
    let (_demo, mut trace) = start_demo(&display, &["--scene", "empty", "--size", "320x240"], folder.path());
    trace.line();
    let keys = |arguments: &[&str]| xdotool(&display, arguments);
    keys(&["search", "--sync", "--name", "Policy Space", "windowfocus"]);
    let did = |step: &'static str| {
        move |line: &str| line.split(" did").nth(1).is_some_and(|d| d.split_whitespace().any(|s| s == step))
    };
    keys(&["keydown", "w"]);
    trace.wait_for("it walks", did("Move"));
    keys(&["keydown", "e"]);
    trace.wait_for("it runs", did("Run"));
    keys(&["keyup", "e", "keyup", "w", "keydown", "q"]);
    trace.wait_for("it crouches", did("Crouch"));
    keys(&["keyup", "q"]);
    let line = trace.line();
    assert!(!did("Pull_me")(&line), "nobody pulled it: {line}");
}

#[test]
fn two_scripted_pads_steer_two_characters() {
    let Some((_xvfb, display)) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let script = |name: &str, stick: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("(entries: [(at: 0.5, left_stick: {stick})])")).unwrap();
        path.display().to_string()
    };
    let (first, second) = (script("first.ron", "(0.0, -1.0)"), script("second.ron", "(0.0, 1.0)"));
    let arguments = ["--characters", "2", "--scene", "playground", "--size", "320x240"];
    let pads = ["--script", first.as_str(), "--second-script", second.as_str()];
    let (_demo, mut trace) = start_demo(&display, &[&arguments[..], &pads].concat(), folder.path());
    let line = trace.wait_for("a second player joins", |line| numbers_after(line, "second").is_some());
    let both = |line: &str| [numbers_after(line, "at").unwrap(), numbers_after(line, "second").unwrap()];
    let [one, other] = both(&line);
    // One goes back along x, the other ahead.
    trace.wait_for("they go where their pads say", |line| {
        let [now, then] = both(line);
        now[0] < one[0] - 0.8 && then[0] > other[0] + 0.8
    });
}

#[test]
fn keys_throw_balls_and_put_props_down() {
    let Some((_xvfb, display)) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--scene", "playground", "--characters", "1", "--size", "320x240"];
    let (_demo, mut trace) = start_demo(&display, &arguments, folder.path());
    let props = |line: &str| {
        let rest = line.split(" props ").nth(1).unwrap();
        rest.split_whitespace().next().unwrap().parse::<usize>().unwrap()
    };
    let before = props(&trace.line());
    xdotool(&display, &["search", "--sync", "--name", "Policy Space", "windowfocus"]);
    for (key, there) in [("t", before + 1), ("y", before + 2)] {
        xdotool(&display, &["mousemove", "160", "150", "key", key]);
        trace.wait_for(key, |line| props(line) == there);
    }
}
