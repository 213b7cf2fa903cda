//! Dead zones, rest calibration, and a pad that falls silent.

mod common;

use common::near;
use gamepad::calibration::{Calibration, DeadZones, NotAtRest, RestCalibrator, Zone};
use gamepad::{Bus, Button, Buttons, GamepadState, PadId, PadReport, PadSession, SILENCE_SECS, Update};
use proptest::prelude::*;

const DUALSENSE: PadId = PadId { vendor: 0x054c, product: 0x0ce6, bus: Bus::Usb };

fn held(left_stick: [f32; 2], left_trigger: f32) -> GamepadState {
    GamepadState { left_stick, left_trigger, ..GamepadState::default() }
}

#[test]
fn zones_are_radial_and_continuous() {
    let zone = Zone::new(0.2, 0.9).unwrap();
    let calibration = Calibration {
        zones: DeadZones { left_stick: zone, ..DeadZones::default() },
        ..Calibration::default()
    };
    let stick = |raw| calibration.state(&held(raw, 0.0)).left_stick;
    assert_eq!(stick([0.2, 0.0]), [0.0, 0.0]);
    assert_eq!(stick([0.14, 0.14]), [0.0, 0.0], "inside by its length");
    near(stick([0.0, 0.21])[1], 0.01 / 0.7, 1e-6);
    near(stick([0.55, 0.0])[0], 0.5, 1e-6);
    assert_eq!(stick([0.0, -0.9]), [0.0, -1.0]);
    let [x, y] = stick([1.0, 1.0]);
    near(x, std::f32::consts::FRAC_1_SQRT_2, 1e-6);
    near(y, x, 0.0);
    assert_eq!(stick([f32::NAN, 0.5]), [0.0, 0.0]);
}

#[test]
fn bad_zones_are_refused() {
    for (inner, outer) in [(-0.1, 1.0), (0.5, 0.5), (0.6, 0.5), (0.0, 1.1), (f32::NAN, 1.0), (0.0, f32::NAN)]
    {
        let error = Zone::new(inner, outer).expect_err("a bad zone");
        assert!(error.to_string().starts_with("dead zone: expected"), "{error}");
    }
    assert_eq!(Zone::new(0.0, 1.0).unwrap().rescaled(0.5), 0.5);
}

/// A pad whose left stick rests off its centre and trembles, and whose trigger rests pulled a little.
fn trembling(step: usize) -> GamepadState {
    let wobble = [-0.02, 0.0, 0.015, 0.02, -0.01][step % 5];
    GamepadState {
        left_stick: [0.18 + wobble, -0.12 - wobble],
        right_stick: [-0.05, wobble],
        left_trigger: 0.1 + wobble / 2.0,
        ..GamepadState::default()
    }
}

#[test]
fn nothing_moves_at_rest_with_a_drifting_stick_after_calibration() {
    let before = Calibration::default().state(&trembling(0));
    assert_ne!(before, GamepadState::default(), "the pad drifts before calibration");
    let mut calibrator = RestCalibrator::default();
    (0..60).for_each(|step| calibrator.observe(&trembling(step)));
    let calibration = calibrator.finish(DeadZones::default()).unwrap();
    for step in 0..1000 {
        assert_eq!(calibration.state(&trembling(step)), GamepadState::default());
    }
    // The full range is still reached.
    for sign in [-1.0, 1.0] {
        assert_eq!(calibration.state(&held([sign, -0.12], 0.0)).left_stick[0], sign);
    }
    assert_eq!(calibration.state(&held([0.0; 2], 1.0)).left_trigger, 1.0);
}

#[test]
fn a_held_pad_is_not_calibrated() {
    let observed = |states: Vec<GamepadState>| {
        let mut calibrator = RestCalibrator::default();
        states.iter().for_each(|state| calibrator.observe(state));
        calibrator.finish(DeadZones::default())
    };
    assert_eq!(observed(vec![held([0.0; 2], 0.0); 5]), Err(NotAtRest::TooFew { found: 5 }));
    let error = observed(vec![held([0.0, 0.8], 0.0); 60]).expect_err("a held stick");
    assert!(matches!(error, NotAtRest::Moved { control: "left stick y", .. }), "{error}");
    let moving = (0..60).map(|i| held([i as f32 / 200.0 - 0.15, 0.0], 0.0)).collect();
    assert!(matches!(observed(moving), Err(NotAtRest::Moved { control: "left stick x", .. })));
    assert!(observed(vec![held([0.0; 2], 0.9); 60]).is_err());
}

proptest! {
    #[test]
    fn states_are_in_range_whatever_the_pad_says(
        raw in proptest::array::uniform6(-2.0f32..2.0),
        rest in proptest::array::uniform6(-0.3f32..0.3),
    ) {
        let state = |v: [f32; 6]| GamepadState {
            left_stick: [v[0], v[1]],
            right_stick: [v[2], v[3]],
            left_trigger: v[4],
            right_trigger: v[5],
            buttons: Buttons::NONE,
        };
        let mut calibrator = RestCalibrator::default();
        (0..30).for_each(|_| calibrator.observe(&state(rest)));
        let calibration = calibrator.finish(DeadZones::default()).unwrap();
        prop_assert_eq!(calibration.state(&state(rest)), GamepadState::default());
        let found = calibration.state(&state(raw));
        prop_assert!(found.left_stick[0].hypot(found.left_stick[1]) <= 1.000_001);
        prop_assert!((0.0..=1.0).contains(&found.left_trigger));
    }
}

/// A DualSense report over USB with this left stick and the south button held or not.
fn report(x: u8, y: u8, south: bool) -> [u8; 64] {
    let mut report = [0; 64];
    report[..5].copy_from_slice(&[0x01, x, y, 128, 128]);
    report[8] = if south { 0x28 } else { 0x08 };
    report
}

#[test]
fn a_silent_pad_is_neutral_and_comes_back() {
    let mut session = PadSession::new(DUALSENSE, &[]).unwrap();
    assert_eq!(session.report_at(0.0), PadReport::default(), "neutral before the first report");
    session.accept(&report(255, 128, true), 1.0).unwrap();
    assert_eq!(session.report_at(1.0).state.left_stick, [1.0, 0.0]);
    assert!(session.report_at(1.0 + SILENCE_SECS).state.buttons.contains(Button::South));
    assert_eq!(session.report_at(1.01 + SILENCE_SECS), PadReport::default());
    session.accept(&report(255, 128, false), 5.0).unwrap();
    assert_eq!(session.report_at(5.0).state.left_stick, [1.0, 0.0]);
}

#[test]
fn a_pulled_pad_is_neutral_at_once() {
    let mut session = PadSession::new(DUALSENSE, &[]).unwrap();
    session.accept(&report(255, 128, true), 1.0).unwrap();
    session.disconnect();
    assert_eq!(session.report_at(1.0), PadReport::default());
    session.accept(&report(0, 128, false), 2.0).unwrap();
    assert_eq!(session.report_at(2.0).state.left_stick, [-1.0, 0.0]);
}

#[test]
fn bad_reports_keep_no_pad_alive() {
    let mut session = PadSession::new(DUALSENSE, &[]).unwrap();
    session.accept(&report(255, 128, true), 1.0).unwrap();
    assert!(session.accept(&[0x01; 5], 1.2).is_err());
    assert!(!session.is_present_at(1.0 + SILENCE_SECS + 0.1));
    assert_eq!(session.counts(), (1, 1));
}

#[test]
fn a_pad_that_reports_changes_only_may_be_silent() {
    let xbox = PadId { vendor: 0x045e, product: 0x0b13, bus: Bus::Bluetooth };
    let mut session = PadSession::new(xbox, &[]).unwrap();
    let mut held = [0; 17];
    (held[0], held[2], held[4], held[6], held[8]) = (1, 0xff, 0x80, 0x80, 0x80);
    assert_eq!(session.accept(&held, 1.0), Ok(Update::Controls));
    assert!(session.report_at(60.0).state.left_stick[0] > 0.9);
    // Unless it is observed to report continuously.
    for step in 0..60 {
        session.accept(&held, 61.0 + f64::from(step) * 0.01).unwrap();
    }
    assert_eq!(session.report_at(63.0), PadReport::default());
}

#[test]
fn simple_reports_come_on_change_only() {
    let switch = PadId { vendor: 0x057e, product: 0x2009, bus: Bus::Bluetooth };
    let mut session = PadSession::new(switch, &[]).unwrap();
    session.accept(&[0x3f, 1, 0, 8, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80], 1.0).unwrap();
    assert!(session.report_at(60.0).state.buttons.contains(Button::South));
    // It sends full reports continuously.
    let mut full = [0; 49];
    (full[0], full[3]) = (0x30, 0x04);
    session.accept(&full, 61.0).unwrap();
    assert!(session.report_at(61.1).state.buttons.contains(Button::South));
    assert_eq!(session.report_at(62.0), PadReport::default());
}

#[test]
fn a_session_calibrates_itself_after_connecting() {
    let mut session = PadSession::new(DUALSENSE, &[]).unwrap();
    for step in 0..300 {
        // Rests at 152 of 255: 0.19 off the centre.
        session.accept(&report(152, 128, false), f64::from(step) * 0.004).unwrap();
    }
    assert_eq!(session.calibration_outcome(), Some(Ok(())));
    assert_eq!(session.report_at(1.2).state, GamepadState::default());
    near(session.report_at(1.2).input.raw.left_stick[0], 24.0 / 127.0, 1e-6);
    session.accept(&report(255, 128, false), 1.2).unwrap();
    assert_eq!(session.report_at(1.2).state.left_stick, [1.0, 0.0]);
    // A held stick can't be measured.
    let mut held = PadSession::new(DUALSENSE, &[]).unwrap();
    for step in 0..300 {
        held.accept(&report(255, 128, false), f64::from(step) * 0.004).unwrap();
    }
    assert!(matches!(held.calibration_outcome(), Some(Err(NotAtRest::Moved { .. }))));
    assert_eq!(held.report_at(1.2).state.left_stick, [1.0, 0.0]);
}

#[test]
fn dead_zones_can_be_changed_without_losing_the_rest_position() {
    let mut session = PadSession::new(DUALSENSE, &[]).unwrap();
    for step in 0..300 {
        session.accept(&report(152 + (step % 3) as u8, 128, false), f64::from(step) * 0.004).unwrap();
    }
    let rest = session.calibration().rest;
    near(rest.left_stick[0], 25.0 / 127.0, 1e-6);
    let narrow = Zone::new(0.0, 1.0).unwrap();
    session.set_dead_zones(DeadZones { left_stick: narrow, ..DeadZones::default() });
    assert_eq!(session.calibration().rest, rest);
    assert!(
        session.calibration().zones.left_stick.inner() > 0.01,
        "wide enough for what the stick does at rest"
    );
    assert_eq!(session.report_at(1.2).state, GamepadState::default());
    let wide = Zone::new(0.5, 0.9).unwrap();
    session.set_dead_zones(DeadZones { left_stick: wide, ..DeadZones::default() });
    assert_eq!(session.calibration().zones.left_stick, wide);
}
