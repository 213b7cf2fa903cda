//! Plays in the browser and natively, and compares the states.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};

use super::WebArgs;
use super::browser::Browser;
use super::graphics::Graphics;
use super::manners;
use super::server::Server;
use crate::workspace::{Workspace, output_of};

/// Most bytes of a first load, compressed, and most milliseconds to the first picture.
const MOST_BYTES: u64 = 6 << 20;
const MOST_FIRST_FRAME_MS: f64 = 3000.0;
/// Ticks of the script.
const SCRIPT_TICKS: u64 = 600;
/// Fewer colours on the canvas are no picture of the world.
const LEAST_COLOURS: u64 = 200;
/// The page may be slower than the clock by this much.
const PATIENCE: Duration = Duration::from_secs(180);
/// A browser that was just started is busy with itself for this long.
const SETTLES: Duration = Duration::from_secs(3);
/// Shift in the WebDriver protocol.
const SHIFT: &str = "\u{e008}";

/// Checks the page of a folder.
///
/// # Errors
/// When a state differs from the native one, the page complains, or a bound is broken.
pub fn run(workspace: &Workspace, folder: PathBuf, arguments: &WebArgs) -> Result<()> {
    let out = workspace.root().join("out");
    // What may have to be compiled comes before the browser, which would be slow beside it.
    let native = native(workspace, "determinism", &["--players", "1"])?;
    let server = Server::start(folder, 0)?;
    let browser = Browser::start(Graphics::WebGpu)?;
    let page = format!("http://{}/", server.address());

    // A stranger's browser runs already when the link is clicked.
    browser.open("about:blank")?;
    thread::sleep(SETTLES);
    // The fixed input, which has everything in it.
    browser.open(&format!("{page}?input=script"))?;
    let start = wait_for(&browser, |state| state["firstFrameMs"].as_f64() > Some(0.0))?;
    let first_load_bytes = server.sent();
    let done = wait_for(&browser, |state| state["mode"] == "over")?;
    ensure!(done["ticks"] == json!(SCRIPT_TICKS), "expected {SCRIPT_TICKS} ticks, found {}", done["ticks"]);
    let script_colours = browser.canvas(&out.join("web-script.png"))?;

    // Keys, as a player presses them.
    browser.open(&page)?;
    wait_for(&browser, |state| state["ticks"].as_u64() > Some(15))?;
    for (secs, down, keys) in [
        (3.0, true, &["w"][..]),
        (3.0, true, &[SHIFT]),
        (1.0, false, &[SHIFT]),
        (2.5, true, &["e"]),
        (0.3, false, &["e"]),
        (0.3, true, &["q"]),
        (5.0, false, &["q", "w"]),
        (2.0, true, &["d", "c"]),
        (1.0, true, &["t"]),
        (1.0, true, &["y"]),
    ] {
        browser.keys(down, keys)?;
        thread::sleep(Duration::from_secs_f64(secs));
    }
    browser.keys(false, &["d", "c", "t", "y"])?;
    wait_for(&browser, |state| state["ticks"].as_u64() >= Some(SCRIPT_TICKS))?;
    browser.picture(&out.join("web-page.png"))?;
    let key_colours = browser.canvas(&out.join("web-keys.png"))?;
    let link = browser.run("return window.policySpaceLink()")?;
    let link = link.as_str().context("expected a link, found none")?;
    let file = out.join("web-keys.link");
    std::fs::write(&file, link).with_context(|| format!("write {}", file.display()))?;
    let played = native_replay(workspace, &file)?;
    let state = state_of(&browser)?;

    let soak =
        if arguments.soak_minutes > 0.0 { soak(&browser, arguments.soak_minutes)? } else { Value::Null };
    let mut manners = manners::of_playing(&browser)?;
    let mut complaints = browser.complaints()?;
    drop(browser);
    manners.extend(manners::without(&page)?);
    let webgl2 = without_webgpu(&page, &out.join("web-webgl2.png"), &mut complaints)?;
    let report = json!({
        "native_hash": native["hash"],
        "web_hash": done["hash"],
        "keys_ticks": played["ticks"],
        "keys_equal_natively": played["equal"],
        "first_load_bytes": first_load_bytes,
        "first_frame_ms": start["firstFrameMs"],
        "first_frame_steps_ms": start["steps"],
        "web_fps": state["fps"],
        "web_physics_ms_per_tick": state["physicsMs"],
        "web_draw_ms_per_frame": state["drawMs"],
        "native_physics_ms_per_tick": native["seconds"].as_f64().map(|secs| secs * 1e3 / SCRIPT_TICKS as f64),
        "native_fps": if arguments.skip_native_fps { Value::Null } else { native_fps(workspace)? },
        "adapter": state["adapter"],
        "colours": script_colours.min(key_colours),
        "webgl2": webgl2,
        "manners": manners,
        "soak": soak,
        "complaints": complaints,
    });
    if arguments.json {
        println!("{report}");
    } else {
        println!("{report:#}");
    }
    verdict(&report)
}

/// The fixed input again, in a browser that has WebGL2 alone.
fn without_webgpu(page: &str, picture: &Path, complaints: &mut Vec<String>) -> Result<Value> {
    let browser = Browser::start(Graphics::WebGl2)?;
    browser.open("about:blank")?;
    thread::sleep(SETTLES);
    browser.open(&format!("{page}?input=script"))?;
    let done = wait_for(&browser, |state| state["mode"] == "over")?;
    let colours = browser.canvas(picture)?;
    complaints.extend(browser.complaints()?);
    Ok(json!({
        "hash": done["hash"],
        "first_frame_ms": done["firstFrameMs"],
        "first_frame_steps_ms": done["steps"],
        "fps": done["fps"],
        "adapter": done["adapter"],
        "colours": colours,
    }))
}

fn verdict(report: &Value) -> Result<()> {
    let (native, web) = (&report["native_hash"], &report["web_hash"]);
    ensure!(
        native.is_string() && native == web,
        "expected the state {native} of the native run, found {web}"
    );
    ensure!(
        report["webgl2"]["hash"] == *web,
        "expected the state {web} with WebGL2, found {}",
        report["webgl2"]["hash"]
    );
    for colours in [&report["colours"], &report["webgl2"]["colours"]] {
        ensure!(
            colours.as_u64() >= Some(LEAST_COLOURS),
            "expected a picture of at least {LEAST_COLOURS} colours, found {colours}"
        );
    }
    ensure!(report["keys_equal_natively"] == true, "the keys of the page give another state natively");
    ensure!(
        report["complaints"].as_array().is_some_and(Vec::is_empty),
        "complaints: {}",
        report["complaints"]
    );
    let manners = report["manners"].as_object();
    for (name, held) in manners.into_iter().flatten() {
        ensure!(*held == true, "the page fails at {name}");
    }
    let bytes = report["first_load_bytes"].as_u64().unwrap_or(u64::MAX);
    ensure!(bytes <= MOST_BYTES, "expected a first load of at most {MOST_BYTES} bytes, found {bytes}");
    let first = report["first_frame_ms"].as_f64().unwrap_or(f64::INFINITY);
    ensure!(
        first <= MOST_FIRST_FRAME_MS,
        "expected a first picture within {MOST_FIRST_FRAME_MS} ms, found {first:.0}"
    );
    Ok(())
}

fn state_of(browser: &Browser) -> Result<Value> {
    let state = browser.run("return window.policySpace ? window.policySpace() : {}")?;
    ensure!(state["error"].is_null(), "the page says: {}", state["error"]);
    Ok(state)
}

fn wait_for(browser: &Browser, there: impl Fn(&Value) -> bool) -> Result<Value> {
    let start = Instant::now();
    loop {
        let state = state_of(browser)?;
        if there(&state) {
            return Ok(state);
        }
        ensure!(start.elapsed() < PATIENCE, "the page takes longer than {PATIENCE:?}: {state}");
        thread::sleep(Duration::from_millis(200));
    }
}

/// Plays on and reports the memory of the page, once a minute.
fn soak(browser: &Browser, minutes: f64) -> Result<Value> {
    let mut memory = Vec::new();
    let start = Instant::now();
    loop {
        memory.push(state_of(browser)?["memory"].clone());
        if start.elapsed().as_secs_f64() >= 60.0 * minutes {
            return Ok(json!({"minutes": minutes, "memory_bytes": memory}));
        }
        thread::sleep(Duration::from_secs_f64(60.0_f64.min(60.0 * minutes)));
    }
}

/// What an example of `lockstep` prints of the shipped pack.
fn native(workspace: &Workspace, example: &str, more: &[&str]) -> Result<Value> {
    let mut cargo = workspace.cargo();
    cargo.args([
        "run",
        "--quiet",
        "--release",
        "-p",
        "lockstep",
        "--features",
        "deterministic",
        "--example",
        example,
    ]);
    cargo.args(["--", "assets/humanoid.pack.safetensors"]).args(more);
    serde_json::from_str(&output_of(&mut cargo)?).with_context(|| format!("{example}: expected JSON"))
}

fn native_replay(workspace: &Workspace, file: &Path) -> Result<Value> {
    native(workspace, "play", &[file.to_str().context("a path of UTF-8")?])
}

/// Pictures a second that the native demo draws of one character.
fn native_fps(workspace: &Workspace) -> Result<Value> {
    let mut cargo = workspace.cargo();
    cargo.args(["run", "--quiet", "--release", "-p", "viewer", "--", "bench-frame", "--json"]);
    let told: Value = serde_json::from_str(&output_of(&mut cargo)?).context("bench-frame: expected JSON")?;
    Ok(told)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_or_a_complaint_fails() {
        let sound = json!({
            "native_hash": "a", "web_hash": "a", "keys_equal_natively": true, "complaints": [],
            "first_load_bytes": 1000, "first_frame_ms": 900.0, "colours": 5000,
            "webgl2": {"hash": "a", "colours": 5000}, "manners": {"touch": true},
        });
        verdict(&sound).unwrap();
        for (key, value, said) in [
            ("web_hash", json!("b"), "expected the state"),
            ("keys_equal_natively", json!(false), "keys"),
            ("complaints", json!(["x"]), "complaints"),
            ("first_load_bytes", json!(MOST_BYTES + 1), "first load"),
            ("first_frame_ms", json!(3001.0), "first picture"),
            ("native_hash", Value::Null, "expected the state"),
            ("colours", json!(1), "colours"),
            ("manners", json!({"touch": false}), "fails at touch"),
            ("webgl2", json!({"hash": "b", "colours": 5000}), "WebGL2"),
            ("webgl2", json!({"hash": "a", "colours": 1}), "colours"),
        ] {
            let mut broken = sound.clone();
            broken[key] = value;
            assert!(verdict(&broken).unwrap_err().to_string().contains(said), "{key}");
        }
    }
}
