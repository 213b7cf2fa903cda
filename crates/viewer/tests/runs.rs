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

#[test]
fn a_run_in_rapier_walks_as_far_and_repeats_itself() {
    let folder = tempfile::tempdir().unwrap();
    let mujoco = report(folder.path(), "m.json", &[]);
    let [rapier, again] =
        ["r.json", "s.json"].map(|name| report(folder.path(), name, &["--physics", "rapier", "--ghost"]));
    assert_eq!((&rapier["physics"], &mujoco["physics"]), (&"rapier".into(), &"mujoco".into()));
    assert_eq!(rapier["state_hash"], again["state_hash"]);
    let metres = |report: &serde_json::Value| report["distance_m"].as_f64().unwrap();
    assert!(metres(&rapier) > 0.6 * metres(&mujoco) && rapier["falls"] == 0, "{rapier} {mujoco}");
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

/// Starts a run of an hour that draws pictures, sends it `signal` once it has drawn some, and returns its end.
#[cfg(unix)]
fn interrupted(folder: &Path, signal: &str) -> Output {
    let line = ["--headless", "--seconds", "3600", "--report", "r.json", "--trace"];
    let mut demo = Command::new(env!("CARGO_BIN_EXE_policy-space"))
        .current_dir(folder)
        .args(line)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The first line of the trace says that it runs.
    let mut first = [0];
    std::io::Read::read_exact(demo.stderr.as_mut().unwrap(), &mut first).unwrap();
    let sent = Command::new("kill").args([signal, &demo.id().to_string()]).status().unwrap();
    assert!(sent.success());
    demo.wait_with_output().unwrap()
}

#[cfg(unix)]
#[test]
fn a_signal_ends_a_run_with_its_report_and_its_own_exit_status() {
    for (signal, name, status) in
        [("-INT", "SIGINT", 130), ("-TERM", "SIGTERM", 143), ("-HUP", "SIGHUP", 129)]
    {
        let folder = tempfile::tempdir().unwrap();
        let output = interrupted(folder.path(), signal);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{said}");
        assert!(said.contains(&format!("ended by {name}")), "{said}");
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.path().join("r.json")).unwrap()).unwrap();
        assert_eq!(report["ended_by"], name);
        assert!(report["seconds"].as_f64().is_some_and(|s| s < 3600.0), "{report}");
    }
}

#[test]
fn a_script_of_more_than_an_hour_is_refused_unless_a_part_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("long.ron"), "(duration: 4000.0, entries: [(at: 0.0)])").unwrap();
    let output = run(folder.path(), &["--headless", "--script", "long.ron"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("at most 3600 s, found 4000 s"), "{said}");
    let output = run(folder.path(), &["--headless", "--script", "long.ron", "--seconds", "0.1"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn one_character_is_not_several() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["--headless", "--seconds", "0.1"]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("1 character:") && told.contains("0 falls"), "{told}");
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    for argument in ["--script", "--recording", "--pack", "--mesh", "--poses"] {
        for file in ["pipe", "/dev/zero"] {
            let output = run(folder.path(), &["--headless", "--seconds", "0.1", argument, file]);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(1), "{argument} {file}: {said}");
            assert!(said.contains(file) && said.contains("expected a regular file"), "{argument}: {said}");
        }
    }
}

/// What a shell prefix does to the run: a full disk is a limit on the size of files.
#[cfg(unix)]
fn run_after(folder: &Path, prefix: &str, arguments: &[&str]) -> Output {
    let line = format!("{prefix} exec \"$0\" \"$@\"");
    let program = env!("CARGO_BIN_EXE_policy-space");
    Command::new("sh").current_dir(folder).args(["-c", &line, program]).args(arguments).output().unwrap()
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_no_part_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let full = "trap '' XFSZ; ulimit -f 0;";
    let output = run_after(folder.path(), full, &["--headless", "--seconds", "0.1", "--report", "r.json"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot write r.json") && !said.contains("panicked"), "{said}");
    if gpu().is_some() {
        let line = ["--headless", "--seconds", "0.1", "--frames", ".", "--size", "160x120"];
        let output = run_after(folder.path(), "trap '' XFSZ; ulimit -f 1;", &line);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains("cannot write ./frame_00000.png"), "{said}");
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert!(left.is_empty(), "{left:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error_and_no_panic() {
    let folder = tempfile::tempdir().unwrap();
    let output = run_after(folder.path(), "exec >/dev/full;", &["--headless", "--seconds", "0.1"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot write to standard output") && !said.contains("panicked"), "{said}");
}

#[test]
fn control_characters_of_a_file_do_not_reach_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let name = "evil\u{1b}[2J.ron";
    std::fs::write(
        folder.path().join(name),
        format!("(entries: [(at: 0.0, \u{1b}[31m{}: 1)])", "x".repeat(9000)),
    )
    .unwrap();
    let output = run(folder.path(), &["--headless", "--script", name]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(!said.contains('\u{1b}') && said.contains("evil\\u{1b}[2J") && said.len() < 3000, "{said}");
}

/// The driver's own messages are not the demo's: none is printed where there is no session.
#[test]
fn a_run_that_draws_prints_nothing_to_standard_error() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_policy-space"))
        .current_dir(folder.path())
        .args(["--headless", "--seconds", "0.1", "--frames", "out", "--size", "64x64"])
        .env_remove("XDG_RUNTIME_DIR")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap();
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn a_replay_repeats_the_run_and_stops_where_it_differs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.replay");
    let recorded =
        report(folder.path(), "a.json", &["--physics", "rapier", "--record-replay", "walk.replay"]);
    let play =
        |name: &str, report: &str| run(folder.path(), &["--headless", "--replay", name, "--report", report]);
    let played = play("walk.replay", "b.json");
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let of = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(folder.path().join(name)).unwrap()).unwrap()
    };
    let again = of("b.json");
    assert_eq!(again["state_hash"], recorded["state_hash"]);
    assert_eq!(again["physics"], "rapier");
    assert!((again["seconds"].as_f64().unwrap() - 4.0).abs() < 1e-5, "as long as it was: {again}");

    // Other presses with the recorded hashes.
    let bytes = std::fs::read(&path).unwrap();
    let replay = replay::Replay::from_bytes(&bytes).unwrap();
    let mut altered = replay::Recorder::new(replay.header().clone()).unwrap();
    let mut playback = replay::Playback::new(&replay);
    let hashes = replay.hashes().to_vec();
    while let Some(pads) = playback.next_pads() {
        let mut pad = pads[0];
        pad.triggers[1] = 255;
        let second = (playback.tick() / 30).max(1) as usize - 1;
        altered.push(&[pad], hashes[second]).unwrap();
    }
    std::fs::write(folder.path().join("altered.replay"), altered.finish().to_bytes()).unwrap();
    let stopped = play("altered.replay", "c.json");
    let said = String::from_utf8_lossy(&stopped.stderr).into_owned();
    assert!(!stopped.status.success() && said.contains("expected the state"), "{said}");

    // What is no replay, and one that goes with other choices.
    std::fs::write(folder.path().join("cut.replay"), &bytes[..bytes.len() / 2]).unwrap();
    let cut = play("cut.replay", "d.json");
    let said = String::from_utf8_lossy(&cut.stderr).into_owned();
    assert!(!cut.status.success() && said.contains("cut.replay") && said.contains("damaged"), "{said}");
    let both = run(folder.path(), &["--headless", "--replay", "walk.replay", "--physics", "mujoco"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn a_second_script_brings_the_playground_and_is_refused_where_nobody_can_join() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("b.ron"), "(entries: [(at: 0.1, left_stick: (0.0, 1.0))])").unwrap();
    let start = ["--headless", "--second-script", "b.ron", "--seconds", "0.2"];
    let joined = run(folder.path(), &[&start[..], &["--report", "a.json"]].concat());
    assert!(joined.status.success(), "{}", String::from_utf8_lossy(&joined.stderr));
    let report = std::fs::read_to_string(folder.path().join("a.json")).unwrap();
    assert!(report.contains("\"scene\": \"playground\""), "{report}");
    // What the window would have shown is on standard error.
    let said = String::from_utf8_lossy(&joined.stderr).into_owned();
    assert!(said.contains("A second player has joined"), "{said}");
    for elsewhere in [["--scene", "empty"], ["--characters", "1"]] {
        let refused = run(folder.path(), &[&start[..], &elsewhere].concat());
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(!refused.status.success() && said.contains("--second-script needs"), "{said}");
    }
}
