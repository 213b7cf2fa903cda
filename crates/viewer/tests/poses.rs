//! Files of poses: hostile ones are refused by name, good ones are played, and drawn in pictures that move.

mod common;

use std::path::Path;
use std::process::Command;

use common::{gpu, simulation};
use physics::PhysicsCharacter as _;
use physics_bridge::Pose;
use policy_core::{BlendMode, GamepadState, Heading};
use viewer::app::{App, PanelLayout, ViewerCommand};
use viewer::pose_clip::{POSES_FORMAT, PoseClip, PoseClipError};
use viewer::sim::{GhostKind, Playback, Simulation};

/// Numbers of a pose of the humanoid.
const QPOS_LEN: usize = 35;

/// Most poses, and largest file, that are read.
const MOST_POSES: usize = 100_000;
const MOST_BYTES: u64 = 64 << 20;

fn row(numbers: usize) -> String {
    let numbers: Vec<&str> = (0..numbers).map(|i| if i == 3 { "1" } else { "0.0" }).collect();
    format!("[{}]", numbers.join(","))
}

fn file(hz: &str, qpos: &str) -> String {
    format!(r#"{{"format":"{POSES_FORMAT}","clip":"walk","hz":{hz},"qpos":{qpos}}}"#)
}

fn load(bytes: &[u8]) -> Result<PoseClip, PoseClipError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("clip.json");
    std::fs::write(&path, bytes).unwrap();
    PoseClip::load(&path, QPOS_LEN)
}

#[test]
fn poses_are_read_as_they_were_written() {
    let poses = load(file("29.5", &format!("[{0},{0}]", row(35))).as_bytes()).unwrap();
    assert_eq!((poses.clip.as_str(), poses.hz, poses.qpos.len()), ("walk", 29.5, 2));
    let mut expected = vec![0.0; QPOS_LEN];
    expected[3] = 1.0;
    assert_eq!(poses.qpos[1], expected);
}

#[test]
fn bad_files_are_refused_by_file_field_expected_and_found() {
    let good = row(35);
    let with = |number: &str| good.replacen("0.0", number, 1);
    let long = "x".repeat(10_000);
    let cases: Vec<(String, &[&str])> = vec![
        (String::new(), &["EOF"]),
        ("[1]".into(), &["1"]),
        ("{}".into(), &["missing field `format`"]),
        (r#"{"format":"gltf"}"#.into(), &["format to be \"policy-space poses\"", "\"gltf\""]),
        (r#"{"format":7}"#.into(), &["format to be", "integer `7`"]),
        (file("30", "[]").replace("walk", &long), &["clip to be a name of 1 to 200", "xxx"]),
        (file("30", "[]").replace("walk", "\\u001b[2J"), &["clip to be", "u{1b}"]),
        (file("0", &format!("[{good}]")), &["hz to be a number above 0 and at most 1000", "`0.0`"]),
        (file("-30", &format!("[{good}]")), &["hz to be", "`-30.0`"]),
        (file("1e999", &format!("[{good}]")), &["hz", "number out of range"]),
        (file("NaN", &format!("[{good}]")), &["line 1"]),
        (file("\"30\"", &format!("[{good}]")), &["hz to be", "string \"30\""]),
        (file("null", &format!("[{good}]")), &["hz to be", "null"]),
        (file("0.0001", &format!("[{good}]")), &["hz and qpos", "3600 seconds", "10000 seconds"]),
        (file("30", "[]"), &["qpos to be a list of 1 to", "invalid length 0"]),
        (file("30", "{}"), &["qpos to be a list", "map"]),
        (file("30", "[3]"), &["qpos[0] to be a list of 35", "integer `3`"]),
        (file("30", &format!("[{good},{}]", row(34))), &["qpos[1] to be a list of 35", "length 34"]),
        (file("30", &format!("[{}]", row(36))), &["qpos[0] to be a list of 35", "length 36"]),
        (file("30", &format!("[{good},{}]", with("1e999"))), &["qpos[1][0]", "out of range"]),
        (file("30", &format!("[{}]", with("null"))), &["qpos[0][0] to be a number", "null"]),
        (file("30", &format!("[{}]", with("1e300"))), &["qpos[0][0] to be a number", "10000", "1e+300"]),
        (file("30", &format!("[{}]", with("\"a\""))), &["qpos[0][0] to be a number", "string \"a\""]),
        (file("30", &format!("[{}", &good[..20])), &["qpos[0][", "expected `,` or `]`"]),
        (file("30", &format!("[{good}],\"loop\":true")), &["unknown field `loop`"]),
    ];
    for (text, parts) in cases {
        let said = load(text.as_bytes()).expect_err(&text).to_string();
        assert!(said.contains("clip.json") && said.len() < 500, "{said}");
        for part in parts {
            assert!(said.contains(part), "expected {part} in: {said}");
        }
    }
    assert!(load(&[0xff, 0xfe, 0x00]).is_err());
}

#[test]
fn too_many_poses_and_too_large_a_file_are_refused() {
    let shortest = format!("[{}]", vec!["0"; QPOS_LEN].join(","));
    let many = vec![shortest.as_str(); MOST_POSES + 1].join(",");
    let said = load(file("1000", &format!("[{many}]")).as_bytes()).unwrap_err().to_string();
    assert!(said.contains("qpos to be a list of 1 to 100000"), "{said}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.json");
    std::fs::File::create(&path).unwrap().set_len(MOST_BYTES + 1).unwrap();
    let said = PoseClip::load(&path, QPOS_LEN).unwrap_err().to_string();
    assert!(said.contains("expected at most 67108864 bytes, found 67108865"), "{said}");
    assert!(matches!(PoseClip::load(folder.path(), QPOS_LEN), Err(PoseClipError::File { .. })));
}

/// The humanoid as it stands, with the right arm turned aside by so many radians and moved along x.
fn pose(sim: &Simulation, arm: f64, x: f64) -> Vec<f64> {
    let Pose { mut qpos, .. } = sim.character(0).pose();
    // The second hinge of the right shoulder.
    qpos[7 + 7] += arm;
    qpos[0] += x;
    qpos
}

fn write(path: &Path, hz: f64, qpos: &[Vec<f64>]) {
    let rows: Vec<&[f64]> = qpos.iter().map(|row| &row[..]).collect();
    let text = serde_json::json!({ "format": POSES_FORMAT, "clip": "wave", "hz": hz, "qpos": rows });
    std::fs::write(path, text.to_string()).unwrap();
}

#[test]
fn a_clip_is_played_in_its_own_time_round_and_round() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.json");
    let mut sim = simulation();
    let rows = [0.0, 0.3, 0.6].map(|x| pose(&sim, 0.0, x));
    write(&path, 10.0, &rows);
    let playback = Playback::load(&path, sim.model()).unwrap();
    assert!((playback.duration() - 0.3).abs() < 1e-9 && playback.pose_count() == 3);
    sim.play(playback);
    let start = rows[0][0] as f32;
    // Three ticks a pose, two thirds of the way into the last one it rests at the last pose.
    for (tick, x) in (1..).zip([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.6, 0.6, 0.0, 0.1]) {
        assert!(sim.tick(&GamepadState::default(), Heading::FORWARD).is_empty());
        let pelvis = sim.poses(0, 1.0).positions[0];
        assert!((pelvis.x - start - x).abs() < 1e-4, "tick {tick}: {pelvis}, expected {x}");
        assert_eq!(sim.playback().unwrap().has_restarted(), tick == 9, "tick {tick}");
    }
    // Half way from the tick before, and what the character itself was put to: the pose before.
    let between = sim.poses(0, 0.5).positions[0];
    assert!((between.x - start - 0.05).abs() < 1e-4, "{between}");
    assert!((sim.player().position().x - start).abs() < 1e-4);
    sim.reset();
    assert!((sim.poses(0, 1.0).positions[0].x - start).abs() < 1e-6);
}

#[test]
fn a_clip_can_be_paused_but_not_steered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.json");
    let mut sim = simulation();
    write(&path, 30.0, &[pose(&sim, 0.0, 0.0), pose(&sim, 0.5, 0.0)]);
    sim.play(Playback::load(&path, sim.model()).unwrap());
    let mut app = App::new(sim, PanelLayout::default());
    app.apply(ViewerCommand::Ghost(Some(GhostKind::Mode(BlendMode::Switch))));
    assert!(app.toasts.take_text().is_some_and(|n| n.contains("A clip is shown")));
    assert!(app.sim.ghost().is_none());
    app.apply(ViewerCommand::Characters(4));
    assert_eq!((app.sim.characters().len(), app.toasts.take_text().is_some()), (1, true));
    app.apply(ViewerCommand::Pause(true));
    app.advance(0.2);
    assert!(app.clock.paused && app.toasts.is_empty() && app.sim.ticks() == 0);
    app.apply(ViewerCommand::Step);
    app.advance(0.01);
    assert_eq!(app.sim.ticks(), 1);
}

#[test]
fn a_pose_that_is_no_pose_is_refused_by_its_index() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wave.json");
    let sim = simulation();
    let mut bad = pose(&sim, 0.0, 0.0);
    bad[3..7].copy_from_slice(&[2.0, 0.0, 0.0, 0.0]);
    write(&path, 30.0, &[pose(&sim, 0.0, 0.0), bad]);
    let said = Playback::load(&path, sim.model()).unwrap_err().to_string();
    for part in ["wave.json", "qpos[1]", "unit quaternion", "length 2"] {
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn pictures_of_a_clip_show_the_figure_moving() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let program = env!("CARGO_BIN_EXE_policy-space");
        Command::new(program).current_dir(folder.path()).args(arguments).output().unwrap()
    };
    std::fs::write(folder.path().join("bad.json"), r#"{"format":"gltf"}"#).unwrap();
    let refused = run(&["--headless", "--poses", "bad.json"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(said.contains("bad.json") && said.contains(POSES_FORMAT) && !said.contains("panicked"), "{said}");
    if gpu().is_none() {
        return;
    }
    let sim = simulation();
    let rows = [0.0, 0.0, 1.2, 1.2].map(|arm| pose(&sim, arm, 0.0));
    write(&folder.path().join("wave.json"), 10.0, &rows);
    let line = ["--headless", "--poses", "wave.json", "--frames", "out", "--fps", "10", "--size", "160x120"];
    let output = run(&line);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(told.contains("wave: 0.40 s of 4 poses at 10.00 Hz, 4 pictures"), "{told}");
    let pictures: Vec<_> = (0..4)
        .map(|n| image::open(folder.path().join(format!("out/frame_{n:05}.png"))).unwrap().to_rgba8())
        .collect();
    assert!(!folder.path().join("out/frame_00004.png").exists());
    let differing = |a: usize, b: usize| {
        let pairs = pictures[a].pixels().zip(pictures[b].pixels());
        pairs.filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 16)).count()
    };
    // Camera and ground stand still: only an arm, and its shadow, can differ.
    let (held, moved) = (differing(0, 1), differing(0, 3));
    assert!(held < 5 && moved > 60, "{held} pixels differ while it holds still, {moved} when the arm is up");
}
