//! Scripts of pad input: what they mean, and how bad ones are refused.

use std::path::{Path, PathBuf};

use gamepad::{Button, Buttons, GamepadState, MAX_SCRIPT_BYTES, MAX_SCRIPT_ENTRIES, Script, ScriptError};

fn refused(text: &str, expected: &[&str]) {
    let error = Script::from_ron(text).expect_err(text);
    let message = error.to_string();
    for part in expected {
        assert!(message.contains(part), "{text}\n{message}\nlacks {part:?}");
    }
}

fn scripts_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scripts")
}

#[test]
fn analog_values_ramp_and_hold() {
    let script = Script::from_ron(
        "(entries: [
            (at: 1, ramp: 2, left_stick: (0.5, 1.0), right_trigger: 1.0),
            (at: 5, left_trigger: 0.25, right_stick: (-1.0, 0.0)),
        ])",
    )
    .unwrap();
    assert_eq!(script.state_at(0.0), GamepadState::default());
    let halfway = GamepadState { left_stick: [0.25, 0.5], right_trigger: 0.5, ..Default::default() };
    assert_eq!(script.state_at(2.0), halfway);
    let end = GamepadState {
        left_stick: [0.5, 1.0],
        right_stick: [-1.0, 0.0],
        left_trigger: 0.25,
        right_trigger: 1.0,
        buttons: Buttons::NONE,
    };
    assert_eq!(script.state_at(5.0), end);
    assert_eq!(script.state_at(1e9), end);
    assert_eq!(script.duration(), 5.0);
}

#[test]
fn odd_times_give_an_end_of_the_script() {
    let script =
        Script::from_ron("(entries: [(at: 0, left_trigger: 1.0), (at: 1, left_trigger: 0.5)])").unwrap();
    for time in [-1.0, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(script.state_at(time).left_trigger, 1.0);
    }
    assert_eq!(script.state_at(f64::INFINITY).left_trigger, 0.5);
}

#[test]
fn buttons_go_by_edges() {
    let script = Script::from_ron(
        "(entries: [
            (at: 1, press: [South, LeftShoulder]),
            (at: 2, release: [South], tap: [East]),
            (at: 3, press: [East]),
        ])",
    )
    .unwrap();
    let held = |time| script.state_at(time).buttons;
    let shoulder = Buttons::NONE.with(Button::LeftShoulder);
    assert_eq!(held(0.99), Buttons::NONE);
    assert_eq!(held(1.0), shoulder.with(Button::South));
    assert_eq!(held(2.0), shoulder.with(Button::East));
    assert_eq!(held(2.1), shoulder.with(Button::East));
    assert_eq!(held(2.16), shoulder);
    assert_eq!(held(9.0), shoulder.with(Button::East));
}

#[test]
fn a_tap_does_not_cut_off_what_comes_after_it() {
    let script = Script::from_ron(
        "(entries: [
            (at: 1, tap: [South, East, West]),
            (at: 1.1, press: [South], tap: [East], release: [West]),
            (at: 1.12, press: [West]),
            (at: 2, release: [South, West]),
        ])",
    )
    .unwrap();
    let held = |time| {
        let held = script.state_at(time).buttons;
        [Button::South, Button::East, Button::West].map(|button| held.contains(button))
    };
    assert_eq!(held(1.05), [true; 3]);
    assert_eq!(held(1.11), [true, true, false]);
    assert_eq!(held(1.2), [true; 3], "the second tap and the presses go on");
    assert_eq!(held(1.26), [true, false, true]);
    assert_eq!(held(2.0), [false; 3]);
}

#[test]
fn every_tap_is_seen_by_a_30_hz_clock() {
    for offset in 0..100 {
        let at = 1.0 + f64::from(offset) / 1000.0;
        let script = Script::from_ron(&format!("(entries: [(at: {at}, tap: [East])])")).unwrap();
        let ticks = (0..60).filter(|&tick| !script.state_at(f64::from(tick) / 30.0).buttons.is_empty());
        assert!(ticks.count() >= 4, "tap at {at}");
    }
}

#[test]
fn bad_text_is_refused_with_its_place() {
    refused("", &["line 1"]);
    refused("(entries: [(at: 1.0,\n left_stik: (0.0, 1.0))])", &["line 2", "`left_stik`", "`left_stick`"]);
    refused("(entries: [], durations: 5)", &["line 1", "`durations`", "`duration`"]);
    refused("(duration: 5)", &["`entries`"]);
    refused("(entries: [(ramp: 1.0)])", &["`at`"]);
    refused("(entries: [(at: 1.0, press: [Sauth])])", &["`Sauth`", "`South`"]);
    refused("(entries: [(at: \"one\")])", &["Expected float", "at: \"one\""]);
    refused("(entries: [(at: 1.0, at: 2.0)])", &["at"]);
}

#[test]
fn bad_values_are_refused_with_their_place() {
    refused("(entries: [\n(at: -1.0)])", &["line 2", "time", "-1"]);
    refused("(entries: [(at: NaN)])", &["time", "NaN"]);
    refused("(entries: [(at: inf)])", &["time", "inf"]);
    refused("(entries: [(at: 86401)])", &["time", "86401"]);
    refused("(entries: [(at: 1, ramp: -0.5)])", &["time", "-0.5"]);
    refused("(entries: [(at: 2),\n(at: 2)])", &["line 2", "entry 2", "`at`", "after 2", "found 2"]);
    refused("(entries: [(at: 2),\n\n(at: 1.5)])", &["line 3", "entry 2", "found 1.5"]);
    refused("(entries: [(at: 1, left_stick: (0.0, 1.01))])", &["stick", "[-1, 1]", "1.01"]);
    refused("(entries: [(at: 1, left_stick: (NaN, 0.0))])", &["stick", "NaN"]);
    refused("(entries: [(at: 1, right_trigger: -0.1)])", &["trigger", "[0, 1]", "-0.1"]);
    refused("(entries: [(at: 1, press: [South, South])])", &["`South`", "once"]);
    refused("(entries: [(at: 1, press: [South], release: [South])])", &["`South`", "entry 1"]);
    refused("(duration: 2, entries: [(at: 1, ramp: 1.5)])", &["`duration`", "2.5", "found 2"]);
}

#[test]
fn absurd_sizes_are_refused() {
    let entries: String = (0..=MAX_SCRIPT_ENTRIES).map(|i| format!("(at:{i}),")).collect();
    refused(&format!("(entries:[{entries}])"), &["entries", "10000"]);
    let long = " ".repeat(MAX_SCRIPT_BYTES + 1);
    assert!(matches!(Script::from_ron(&long), Err(ScriptError::TooLong { found }) if found == long.len()));
    let deep = format!("(entries: {}", "[".repeat(100_000));
    refused(&deep, &["line 1"]);
}

#[test]
fn a_file_is_named_in_its_errors() {
    let missing = Script::load(Path::new("no/such/script.ron")).expect_err("no such file");
    assert!(missing.to_string().starts_with("no/such/script.ron: cannot be read"), "{missing}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.ron");
    std::fs::write(&path, "(entries: [\n(at: 1, jump: 2)])").unwrap();
    let message = Script::load(&path).expect_err("unknown field").to_string();
    assert!(message.contains("bad.ron: line 2") && message.contains("`jump`"), "{message}");
    std::fs::write(&path, b"(entries: [])\xff").unwrap();
    let message = Script::load(&path).expect_err("not UTF-8").to_string();
    assert!(message.contains("offset 13"), "{message}");
    std::fs::write(&path, vec![b' '; MAX_SCRIPT_BYTES + 2]).unwrap();
    let message = Script::load(&path).expect_err("too long").to_string();
    assert!(message.contains("expected at most 1048576 bytes"), "{message}");
}

#[test]
fn messages_are_short_and_can_not_control_a_terminal() {
    let field = "\u{1b}[2Jx".repeat(1000);
    for text in
        [format!("(entries: [(at: 1, \"{field}\": 2)])"), format!("(entries: [(at: 1, press: [r#{field}])])")]
    {
        let message = Script::from_ron(&text).expect_err("an unknown field").to_string();
        assert!(message.chars().count() < 400, "{}", message.len());
        assert!(!message.chars().any(char::is_control), "{message:?}");
    }
}

#[test]
fn the_scripts_of_the_assets_are_sound() {
    let mut seen = 0;
    for entry in std::fs::read_dir(scripts_folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "ron") {
            let script = Script::load(&path).unwrap();
            assert!((10.0..=120.0).contains(&script.duration()), "{}", path.display());
            assert_eq!(script.state_at(0.0), GamepadState::default(), "{} starts neutral", path.display());
            seen += 1;
        }
    }
    assert!(seen >= 4);
}

#[test]
fn the_tour_shows_every_skill() {
    let tour = Script::load(&scripts_folder().join("tour.ron")).unwrap();
    let ticks = (tour.duration() * 30.0) as u32;
    let states: Vec<_> = (0..ticks).map(|tick| tour.state_at(f64::from(tick) / 30.0)).collect();
    assert!(states.iter().any(|s| s.right_trigger == 1.0) && states.iter().any(|s| s.left_trigger == 1.0));
    let skills = [Button::East, Button::North, Button::West];
    for button in [Button::LeftShoulder, Button::RightShoulder, Button::RightStick].into_iter().chain(skills)
    {
        assert!(states.iter().any(|s| s.buttons.contains(button)), "{button:?}");
    }
    assert!(states.last().is_some_and(|s| s.left_stick[1] > 0.5), "walks off at the end");
}

#[test]
fn the_figure_of_eight_keeps_the_stick_out() {
    let script = Script::load(&scripts_folder().join("figure_eight.ron")).unwrap();
    for tick in 60..1020 {
        let [x, y] = script.state_at(f64::from(tick) / 30.0).left_stick;
        assert!(x.hypot(y) > 0.92, "tick {tick}: ({x}, {y})");
    }
}
