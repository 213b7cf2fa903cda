//! Recordings of pads while they are played: when they begin, their calibration, how they end.

use std::sync::{Arc, Mutex};

use gamepad::device::{DeviceEvent, DeviceInfo, DeviceKey, Source};
use gamepad::recording::{PadEvent, Recording, VirtualPad};
use gamepad::{Bus, Button, Gamepads, PadId, PadReport};

const USB: PadId = PadId { vendor: 0x054c, product: 0x0ce6, bus: Bus::Usb };

fn device(key: u64) -> DeviceInfo {
    DeviceInfo {
        key: DeviceKey(key),
        name: format!("Pad {key}"),
        id: USB,
        serial: None,
        path: format!("/dev/hidraw{key}"),
        source: Source::Hid,
    }
}

fn connected(key: u64) -> DeviceEvent {
    DeviceEvent::Connected { device: device(key), descriptor: Some(Vec::new()) }
}

fn report(key: u64, x: u8, south: bool) -> DeviceEvent {
    let mut report = [0; 64];
    report[..5].copy_from_slice(&[0x01, x, 128, 128, 128]);
    report[8] = if south { 0x28 } else { 0x08 };
    DeviceEvent::Report(DeviceKey(key), Box::new(report))
}

/// A file in memory that can be read while it is written.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl std::io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_recording_that_starts_late_replays_what_was_live() {
    let mut gamepads = Gamepads::new(Vec::new());
    gamepads.apply(0.0, connected(1));
    // A drifting pad: at rest for a second, then recorded.
    for step in 0..250 {
        gamepads.apply(f64::from(step) * 0.004, report(1, 150, false));
    }
    let file = Shared::default();
    assert!(gamepads.record(DeviceKey(1), Box::new(file.clone())).unwrap());
    let start_secs = gamepads.now_secs();
    let mut live = Vec::new();
    for step in 0..250u8 {
        let time_secs = 1.0 + f64::from(step) * 0.004;
        gamepads.apply(time_secs, report(1, step, step > 200));
        live.push((time_secs, gamepads.report()));
    }
    gamepads.pad_mut(DeviceKey(1)).unwrap().stop_recording().unwrap();
    let mut played = VirtualPad::new(Recording::from_bytes(file.0.lock().unwrap().clone()).unwrap()).unwrap();
    for (time_secs, report) in live {
        assert_eq!(played.report_at(time_secs - start_secs + 1e-6), report);
    }
    assert!(!gamepads.record(DeviceKey(9), Box::new(file)).unwrap(), "no such pad");
}

/// A drifting pad that is recorded while its rest positions are measured, from 0.05 s on. `held` says when its stick is out.
fn recorded_early(held: impl Fn(f64) -> bool) {
    let mut gamepads = Gamepads::new(Vec::new());
    gamepads.apply(0.0, connected(1));
    let (file, mut start_secs, mut live) = (Shared::default(), None, Vec::new());
    for step in 0..500 {
        let time_secs = f64::from(step) * 0.004;
        if time_secs > 0.05 && start_secs.is_none() {
            assert!(gamepads.record(DeviceKey(1), Box::new(file.clone())).unwrap());
            start_secs = Some(gamepads.now_secs());
        }
        gamepads.apply(time_secs, report(1, if held(time_secs) { 255 } else { 150 }, false));
        if let Some(start_secs) = start_secs {
            live.push((time_secs - start_secs, gamepads.report()));
        }
    }
    assert!(gamepads.stop_recording(DeviceKey(1)).unwrap());
    let mut played = VirtualPad::new(Recording::from_bytes(file.0.lock().unwrap().clone()).unwrap()).unwrap();
    for (time_secs, report) in live {
        assert_eq!(played.report_at(time_secs + 1e-6), report, "after {time_secs} s");
    }
}

#[test]
fn a_recording_that_starts_while_the_pad_is_measured_replays_what_was_live() {
    recorded_early(|_| false);
    recorded_early(|time_secs| time_secs > 0.3);
    // Held until the measurement of the pad has failed; one that began with the recording would not.
    recorded_early(|time_secs| !(0.052..=1.0).contains(&time_secs));
}

#[test]
fn a_recording_ends_with_the_disconnect_of_its_pad() {
    let mut gamepads = Gamepads::new(Vec::new());
    gamepads.apply(0.0, connected(1));
    gamepads.apply(0.0, report(1, 128, false));
    let file = Shared::default();
    assert!(gamepads.record(DeviceKey(1), Box::new(std::io::BufWriter::new(file.clone()))).unwrap());
    gamepads.apply(0.5, report(1, 255, true));
    gamepads.apply(0.7, DeviceEvent::Disconnected(DeviceKey(1)));
    assert!(matches!(gamepads.stop_recording(DeviceKey(1)), Ok(true)), "how it ended is kept");
    assert!(matches!(gamepads.stop_recording(DeviceKey(1)), Ok(false)), "once");
    let recording = Recording::from_bytes(file.0.lock().unwrap().clone()).unwrap();
    let last = recording.event(recording.len() - 1);
    assert_eq!(last, Some((0.7, PadEvent::Disconnected)));
    let mut played = VirtualPad::new(recording).unwrap();
    assert!(played.report_at(0.6).state.buttons.contains(Button::South));
    assert_eq!(played.report_at(0.7), PadReport::default());
}

#[test]
fn an_output_that_fails_at_the_disconnect_is_told_when_the_recording_is_stopped() {
    struct Full(usize);
    impl std::io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut gamepads = Gamepads::new(Vec::new());
    gamepads.apply(0.0, connected(1));
    assert!(gamepads.record(DeviceKey(1), Box::new(Full(150))).unwrap());
    gamepads.apply(0.1, report(1, 128, false));
    gamepads.apply(0.2, DeviceEvent::Disconnected(DeviceKey(1)));
    assert!(gamepads.stop_recording(DeviceKey(1)).is_err());
}
