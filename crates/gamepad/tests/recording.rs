//! Recordings: round trips, replays, hostile files.

use std::path::Path;

use gamepad::calibration::{Calibration, DeadZones, Rest, Zone};
use gamepad::recording::{PadEvent, RecordedPad, Recorder, Recording, RecordingError, VirtualPad};
use gamepad::{Bus, Button, Buttons, GamepadState, PadId, PadReport};
use proptest::prelude::*;

fn pad() -> RecordedPad {
    let id = PadId { vendor: 0x054c, product: 0x0ce6, bus: Bus::Usb };
    RecordedPad { id, name: "DualSense of Łukasz".into(), descriptor: Some(Vec::new()) }
}

fn report(x: u8, south: bool) -> [u8; 64] {
    let mut report = [0; 64];
    report[..5].copy_from_slice(&[0x01, x, 128, 128, 128]);
    report[8] = if south { 0x28 } else { 0x08 };
    report
}

/// One second at rest, one second of stick movement, a disconnect, and a reconnect.
fn recorded() -> Vec<u8> {
    let mut recorder = Recorder::new(Vec::new(), &pad()).unwrap();
    recorder.record(0.0, PadEvent::Feature(&[0x05; 41])).unwrap();
    for step in 0..500u32 {
        let x = if step < 250 { 128 } else { 128 + ((step - 250) / 2).min(127) as u8 };
        recorder.record(f64::from(step) * 0.004, PadEvent::Report(&report(x, step > 400))).unwrap();
    }
    recorder.record(3.0, PadEvent::Disconnected).unwrap();
    recorder.record(4.0, PadEvent::Report(&report(0, false))).unwrap();
    recorder.finish().unwrap()
}

#[test]
fn what_is_recorded_is_read_back() {
    let recording = Recording::from_bytes(recorded()).unwrap();
    assert_eq!(recording.pad(), &pad());
    assert_eq!(recording.duration(), 4.0);
    assert_eq!(recording.event(0), Some((0.0, PadEvent::Feature(&[0x05; 41]))));
    assert_eq!(recording.event(2), Some((0.004, PadEvent::Report(&report(128, false)))));
    assert_eq!(recording.event(recording.len() - 2), Some((3.0, PadEvent::Disconnected)));
    assert_eq!(recording.event(recording.len()), None);
}

#[test]
fn a_virtual_pad_plays_it() {
    let mut pad = VirtualPad::new(Recording::from_bytes(recorded()).unwrap()).unwrap();
    assert_eq!(pad.report_at(0.9).state, GamepadState::default());
    let moving = pad.report_at(1.5).state;
    assert!(moving.left_stick[0] > 0.3 && moving.left_stick[0] < 0.7, "{moving:?}");
    assert!(pad.report_at(1.99).state.buttons.contains(Button::South));
    assert_eq!(pad.report_at(3.5), PadReport::default());
    assert_eq!(pad.report_at(4.0).state.left_stick, [-1.0, 0.0]);
    assert!(pad.is_over());
    assert_eq!(pad.report_at(4.0 + 1.0), PadReport::default(), "silent after its end");
    assert_eq!(pad.counts().1, 0);
}

#[test]
fn the_report_at_a_time_does_not_depend_on_how_it_was_reached() {
    let recording = Recording::from_bytes(recorded()).unwrap();
    let mut steps = VirtualPad::new(recording.clone()).unwrap();
    for tick in 0..150 {
        let time_secs = f64::from(tick) / 30.0;
        let mut jump = VirtualPad::new(recording.clone()).unwrap();
        assert_eq!(steps.report_at(time_secs), jump.report_at(time_secs), "tick {tick}");
    }
}

#[test]
fn states_of_pads_without_hid() {
    let pad = RecordedPad { descriptor: None, ..pad() };
    let mut recorder = Recorder::new(Vec::new(), &pad).unwrap();
    let buttons = Button::ALL.into_iter().step_by(2).fold(Buttons::NONE, Buttons::with);
    let state = GamepadState {
        left_stick: [0.25, -1.0],
        right_stick: [1.0, 0.5],
        right_trigger: 0.75,
        buttons,
        left_trigger: 0.0,
    };
    recorder.record(1.0, PadEvent::State(state)).unwrap();
    let recording = Recording::from_bytes(recorder.finish().unwrap()).unwrap();
    assert_eq!(recording.event(0), Some((1.0, PadEvent::State(state))));
    let played = VirtualPad::new(recording).unwrap().report_at(1.0);
    assert_eq!(played.input.raw, state);
    // A report in such a recording, or a state beyond the range of a pad, is refused.
    let mut recorder = Recorder::new(Vec::new(), &pad).unwrap();
    recorder.record(1.0, PadEvent::Report(&[1])).unwrap();
    assert!(matches!(
        Recording::from_bytes(recorder.finish().unwrap()),
        Err(RecordingError::Event { kind: 0, .. })
    ));
    let mut recorder = Recorder::new(Vec::new(), &pad).unwrap();
    recorder.record(1.0, PadEvent::State(GamepadState { left_trigger: f32::NAN, ..state })).unwrap();
    assert!(matches!(
        Recording::from_bytes(recorder.finish().unwrap()),
        Err(RecordingError::Event { kind: 2, .. })
    ));
}

#[test]
fn a_recorded_calibration_is_used_instead_of_a_new_one() {
    let zone = Zone::new(0.3, 0.8).unwrap();
    let calibration = Calibration {
        rest: Rest { left_stick: [0.1, -0.1], left_trigger: 0.05, ..Rest::default() },
        zones: DeadZones { left_stick: zone, ..DeadZones::default() },
    };
    let mut recorder = Recorder::new(Vec::new(), &pad()).unwrap();
    recorder.record(0.0, PadEvent::Calibration(calibration)).unwrap();
    for step in 0..300 {
        recorder.record(f64::from(step) * 0.004, PadEvent::Report(&report(160, false))).unwrap();
    }
    let bytes = recorder.finish().unwrap();
    let recording = Recording::from_bytes(bytes).unwrap();
    assert_eq!(recording.event(0), Some((0.0, PadEvent::Calibration(calibration))));
    let played = VirtualPad::new(recording).unwrap().report_at(1.1);
    assert_eq!(played.state, calibration.state(&played.input.raw));
    let mut recorder = Recorder::new(Vec::new(), &pad()).unwrap();
    let bad = Calibration { rest: Rest { left_trigger: f32::NAN, ..Rest::default() }, ..calibration };
    recorder.record(0.0, PadEvent::Calibration(bad)).unwrap();
    assert!(matches!(
        Recording::from_bytes(recorder.finish().unwrap()),
        Err(RecordingError::Event { kind: 4, .. })
    ));
}

#[test]
fn every_cut_and_every_flipped_bit_is_noticed() {
    let mut recorder = Recorder::new(Vec::new(), &pad()).unwrap();
    let header = Recorder::new(Vec::new(), &pad()).unwrap().finish().unwrap().len();
    for step in 0..3u8 {
        recorder.record(f64::from(step), PadEvent::Report(&[step; 10])).unwrap();
    }
    let bytes = recorder.finish().unwrap();
    for len in 0..bytes.len() {
        let whole = len >= header && (len - header) % (12 + 10 + 4) == 0;
        let found = Recording::from_bytes(bytes[..len].to_vec());
        assert_eq!(found.is_ok(), whole, "{len} bytes");
        assert!(whole || matches!(found, Err(RecordingError::Truncated { .. })), "{len} bytes");
    }
    for bit in 0..bytes.len() * 8 {
        let mut broken = bytes.clone();
        broken[bit / 8] ^= 1 << (bit % 8);
        assert!(Recording::from_bytes(broken).is_err(), "bit {bit}");
    }
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.pad");
    std::fs::write(&path, b"not a recording at all").unwrap();
    let message = Recording::load(&path).expect_err("no recording").to_string();
    assert!(message.contains("walk.pad: expected a pad recording"), "{message}");
    let message = Recording::load(Path::new("no/such.pad")).expect_err("no file").to_string();
    assert!(message.starts_with("no/such.pad: cannot be read"), "{message}");
    std::fs::write(&path, recorded()).unwrap();
    assert!(Recording::load(&path).is_ok());
}

#[test]
fn times_never_go_back_and_long_names_are_cut() {
    let long = RecordedPad { name: "ł".repeat(200), ..pad() };
    let mut recorder = Recorder::new(Vec::new(), &long).unwrap();
    recorder.record(2.0, PadEvent::Disconnected).unwrap();
    recorder.record(1.0, PadEvent::Disconnected).unwrap();
    recorder.record(f64::NAN, PadEvent::Disconnected).unwrap();
    assert!(recorder.record(3.0, PadEvent::Report(&[0; 5000])).is_err());
    let recording = Recording::from_bytes(recorder.finish().unwrap()).unwrap();
    assert_eq!(recording.pad().name, "ł".repeat(128));
    assert_eq!(recording.event(2), Some((2.0, PadEvent::Disconnected)));
}

proptest! {
    #[test]
    fn random_bytes_after_a_sound_start_never_panic(tail in proptest::collection::vec(any::<u8>(), 0..200)) {
        let mut bytes = Recorder::new(Vec::new(), &pad()).unwrap().finish().unwrap();
        bytes.extend(&tail);
        prop_assert_eq!(Recording::from_bytes(bytes).is_ok(), tail.is_empty());
    }
}
