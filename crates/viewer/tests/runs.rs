//! The binary as users run it: runs that repeat, reports, pictures, and command lines that are wrong.

mod common;

use std::path::Path;
use std::process::{Command, Output};

use common::gpu;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_policy-space")).current_dir(folder).args(arguments).output().unwrap()
}

fn report(folder: &Path, name: &str, more: &[&str]) -> serde_json::Value {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scripts/walk.ron");
    let mut arguments = vec!["--headless", "--script", script, "--seconds", "4", "--report", name];
    arguments.extend(more);
    let output = run(folder, &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

#[test]
fn two_runs_have_the_same_state_and_a_whole_report() {
    let folder = tempfile::tempdir().unwrap();
    let first = report(folder.path(), "a.json", &[]);
    let second = report(folder.path(), "b/b.json", &[]);
    assert_eq!(first["state_hash"], second["state_hash"]);
    for key in [
        "upright_fraction",
        "distance_m",
        "mean_speed_mps",
        "control_ticks_per_second",
        "policy_microseconds_per_tick",
    ] {
        assert!(first[key].as_f64().is_some_and(|v| v > 0.0), "{key}: {first}");
    }
    assert!(first["falls"].is_u64() && first["after_a_fall"].is_string());
    // Another terrain is another run, and a crowd of one script differs from one alone.
    let hills = report(folder.path(), "c.json", &["--terrain", "wavy", "--characters", "3"]);
    assert_ne!(first["state_hash"], hills["state_hash"]);
    assert_eq!(hills["characters"], 3);
    let left: Vec<String> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(left.iter().all(|name| ["a.json", "b", "c.json"].contains(&name.as_str())), "{left:?}");
}

/// Five seconds of a DualShock 4 on its cable: at rest until it is calibrated, then the left stick forward.
fn recording() -> Vec<u8> {
    use gamepad::recording::{PadEvent, RecordedPad, Recorder};
    use gamepad::{Bus, PadId};
    let id = PadId { vendor: 0x054c, product: 0x09cc, bus: Bus::Usb };
    let pad = RecordedPad { id, name: "a pad".into(), descriptor: Some(Vec::new()) };
    let mut recorder = Recorder::new(Vec::new(), &pad).unwrap();
    for step in 0..1250u16 {
        let mut report = [0; 64];
        let forward = if step < 250 { 128 } else { 0 };
        report[..5].copy_from_slice(&[0x01, 128, forward, 128, 128]);
        report[5] = 0x08;
        recorder.record(f64::from(step) * 0.004, PadEvent::Report(&report)).unwrap();
    }
    recorder.finish().unwrap()
}

#[test]
fn a_recorded_pad_drives_the_demo_to_the_same_state() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pad.rec"), recording()).unwrap();
    let report = |recorded: bool| {
        let mut arguments = vec!["--headless", "--seconds", "5", "--report", "r.json"];
        if recorded {
            arguments.extend(["--recording", "pad.rec"]);
        }
        let output = run(folder.path(), &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let bytes = std::fs::read(folder.path().join("r.json")).unwrap();
        serde_json::from_slice::<serde_json::Value>(&bytes).unwrap()
    };
    let (first, second, neutral) = (report(true), report(true), report(false));
    assert_eq!(first["state_hash"], second["state_hash"]);
    assert_ne!(first["state_hash"], neutral["state_hash"]);
    let distance = |r: &serde_json::Value| r["distance_m"].as_f64().unwrap();
    assert!(distance(&first) > distance(&neutral) + 1.0, "the stick walks: {first}, {neutral}");
    let output = run(folder.path(), &["--headless", "--recording", "r.json"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && said.contains("r.json"), "{said}");
}

#[test]
fn pictures_are_written_at_the_rate_asked_for() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let drawn =
        ["--headless", "--seconds", "1", "--frames", "out/x", "--fps", "5", "--size", "160x120", "--panels"];
    let output = run(folder.path(), &drawn);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for number in 0..5 {
        let picture = image::open(folder.path().join(format!("out/x/frame_{number:05}.png"))).unwrap();
        assert_eq!((picture.width(), picture.height()), (160, 120));
    }
    assert!(!folder.path().join("out/x/frame_00005.png").exists());
}

#[test]
fn help_teaches_and_wrong_lines_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let help = run(folder.path(), &["--help"]);
    let text = String::from_utf8_lossy(&help.stdout).into_owned();
    assert!(help.status.success() && text.contains("--headless") && text.contains("Examples"), "{text}");
    let wrong = run(folder.path(), &["--headless", "--terrain", "lava"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("flat, wavy, steps"));
}

#[test]
fn files_that_are_no_good_are_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.pack"), b"nonsense").unwrap();
    std::fs::write(folder.path().join("bad.ron"), "(entries: [(at: 0.0, stick: 3)])").unwrap();
    std::fs::write(folder.path().join("bad.glb"), b"nonsense").unwrap();
    let cases: [(&[&str], &str); 4] = [
        (&["--pack", "bad.pack"], "bad.pack"),
        (&["--pack", "missing.pack"], "missing.pack"),
        (&["--script", "bad.ron"], "bad.ron"),
        (&["--mesh", "bad.glb"], "bad.glb"),
    ];
    for (arguments, named) in cases {
        let line: Vec<&str> = ["--headless", "--seconds", "1"].iter().chain(arguments).copied().collect();
        let output = run(folder.path(), &line);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{line:?}: {said}");
        assert!(said.contains(named) && !said.contains("panicked"), "{said}");
    }
}
