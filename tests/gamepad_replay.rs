//! A recorded pad session gives the same states at the same ticks every time, and so the same demo.
//!
//! The recording is read from a file and played at the control rate: one `GamepadState` for each control tick. The
//! demo is deterministic given those states (its `state_hash`), so a recording drives it to the same hash every time.

use std::sync::Arc;

use gamepad::recording::{PadEvent, RecordedPad, Recorder, Recording, VirtualPad};
use gamepad::{Bus, Button, GamepadState, PadId};
use integration_tests::{CONTROL_HZ, DT_SECS, HUMANOID_MJCF, reference_pack};
use physics_bridge::{Character, Model, StateHash};
use policy_core::{Bindings, CommandMapper, Controller, Heading};

const SECONDS: f64 = 8.0;

/// A pad session as it comes from hardware: reports every 4 ms with jitter, a stick that rests off its centre and
/// trembles, a walk, a turn, a roll, a pull of the cable and a return, and some broken reports.
fn recorded(id: PadId) -> Vec<u8> {
    let pad = RecordedPad { id, name: "a worn pad".into(), descriptor: Some(Vec::new()) };
    let mut recorder = Recorder::new(Vec::new(), &pad).unwrap();
    let mut noise = 0x2545_f491_u32;
    for step in 0..2000 {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let time_secs = f64::from(step) * 0.004 + f64::from(noise >> 24) * 4e-6;
        if step == 1200 {
            recorder.record(time_secs, PadEvent::Disconnected).unwrap();
        }
        if (1200..1400).contains(&step) {
            continue;
        }
        let tremble = ((noise >> 16) % 5) as i32 - 2;
        let (x, y) = match step {
            0..500 => (140 + tremble, 120 + tremble),
            500..900 => (140 + tremble, 0),
            _ => (255, 60 + tremble),
        };
        let mut report = [0; 64];
        report[..5].copy_from_slice(&[0x01, x as u8, y as u8, 128, 128]);
        report[6] = if step > 700 { (step % 256) as u8 } else { 0 };
        report[8] = if (1000..1050).contains(&step) { 0x48 } else { 0x08 };
        let len = if step % 97 == 0 { 30 } else { 64 };
        recorder.record(time_secs, PadEvent::Report(&report[..len])).unwrap();
    }
    recorder.finish().unwrap()
}

/// One state for each control tick.
fn drive(recording: Recording) -> Vec<GamepadState> {
    let mut pad = VirtualPad::new(recording).unwrap();
    let ticks = (SECONDS * CONTROL_HZ) as u32;
    (0..ticks).map(|tick| pad.report_at(f64::from(tick) / CONTROL_HZ).state).collect()
}

/// The bits of every value, hashed.
fn hash(states: &[GamepadState]) -> u64 {
    let mut hash = StateHash::default();
    for state in states {
        let sticks = state.left_stick.into_iter().chain(state.right_stick);
        let values = sticks.chain([state.left_trigger, state.right_trigger]);
        values.for_each(|value| hash.absorb_bits(value.to_bits().into()));
        hash.absorb_bits(state.buttons.bits().into());
    }
    hash.value()
}

/// What the recording makes of a character in the physics: every pose at every tick, hashed, and how far it got, metres.
fn walked(states: &[GamepadState]) -> (u64, f64) {
    let pack = reference_pack();
    let mut mapper = CommandMapper::new(&pack, &Bindings::default());
    let mut controller = Controller::new(Arc::clone(&pack));
    let mut character = Character::new(&Model::from_mjcf(HUMANOID_MJCF).unwrap());
    let mut state = character.sensed().clone();
    let mut hash = StateHash::default();
    for pad in states {
        character.sense_into(&mut state);
        let command = mapper.map(pad, Heading::FORWARD, &state);
        character.control_tick(&mut controller, &command, DT_SECS).unwrap();
        hash.absorb(&character.pose());
    }
    let end = character.pose().qpos;
    (hash.value(), end[0].hypot(end[1]))
}

const DUALSENSE: PadId = PadId { vendor: 0x054c, product: 0x0ce6, bus: Bus::Usb };

#[test]
fn a_recording_gives_the_same_states_every_time() {
    let folder = std::env::temp_dir().join(format!("gamepad-replay-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("session.pad");
    std::fs::write(&path, recorded(DUALSENSE)).unwrap();
    let first = drive(Recording::load(&path).unwrap());
    let second = drive(Recording::load(&path).unwrap());
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(hash(&first), hash(&second));
    assert_eq!(first, second);
}

#[test]
fn the_states_are_those_of_the_session() {
    let states = drive(Recording::from_bytes(recorded(DUALSENSE)).unwrap());
    let at = |seconds: f64| states[(seconds * CONTROL_HZ) as usize];
    assert_eq!(at(1.5), GamepadState::default(), "at rest a worn stick is neutral");
    let walk = at(3.0).left_stick;
    assert!(walk[1] > 0.99 && walk[0].abs() < 0.1, "forward: {walk:?}");
    assert!(at(4.1).buttons.contains(Button::East) && at(4.1).right_trigger > 0.0);
    assert_eq!(at(5.0), GamepadState::default(), "neutral while the cable is out");
    assert!(at(6.0).left_stick[0] > 0.8, "and back");
}

#[test]
fn another_session_gives_another_hash() {
    let states = drive(Recording::from_bytes(recorded(DUALSENSE)).unwrap());
    let mut other = states.clone();
    other[100].left_stick[0] += 1e-6;
    assert_ne!(hash(&states), hash(&other));
    let edge = PadId { product: 0x0df2, ..DUALSENSE };
    assert_eq!(hash(&drive(Recording::from_bytes(recorded(edge)).unwrap())), hash(&states));
}

#[test]
fn a_recording_drives_a_character_to_the_same_end_every_time() {
    let states = drive(Recording::from_bytes(recorded(DUALSENSE)).unwrap());
    let ((first, distance), (second, _)) = (walked(&states), walked(&states));
    assert_eq!(first, second);
    let (idle, drift) = walked(&vec![GamepadState::default(); states.len()]);
    assert_ne!(first, idle, "the recording is what moves the character");
    assert!(distance > drift, "it walked {distance} m, and {drift} m without a pad");
}
