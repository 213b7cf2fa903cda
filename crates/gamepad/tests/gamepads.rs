//! Several pads, plugged in and out, through two back ends; what the doctor says about them.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use gamepad::backend::PadBackend;
use gamepad::device::{DeviceEvent, DeviceInfo, DeviceKey, Problem, Source};
use gamepad::doctor::{self, EventPad, SystemFacts};
use gamepad::pads::PadOutput;
use gamepad::{Bus, Button, Buttons, GamepadState, Gamepads, PadId, PadReport, udev};

const USB: PadId = PadId { vendor: 0x054c, product: 0x0ce6, bus: Bus::Usb };

fn device(key: u64, id: PadId, serial: Option<&str>) -> DeviceInfo {
    DeviceInfo {
        key: DeviceKey(key),
        name: format!("Pad {key}"),
        id,
        serial: serial.map(str::to_owned),
        path: format!("/dev/hidraw{key}"),
        source: Source::Hid,
    }
}

fn connected(key: u64) -> DeviceEvent {
    DeviceEvent::Connected { device: device(key, USB, None), descriptor: Some(Vec::new()) }
}

fn report(key: u64, x: u8, south: bool) -> DeviceEvent {
    let mut report = [0; 64];
    report[..5].copy_from_slice(&[0x01, x, 128, 128, 128]);
    report[8] = if south { 0x28 } else { 0x08 };
    DeviceEvent::Report(DeviceKey(key), Box::new(report))
}

fn keys(gamepads: &Gamepads) -> Vec<u64> {
    gamepads.pads().map(|pad| pad.device.key.0).collect()
}

#[test]
fn a_pad_comes_and_goes() {
    let mut gamepads = Gamepads::new(Vec::new());
    assert_eq!(gamepads.report(), PadReport::default());
    gamepads.apply(0.0, connected(1));
    gamepads.apply(0.1, report(1, 255, true));
    assert_eq!(gamepads.report().state.left_stick, [1.0, 0.0]);
    gamepads.apply(0.2, DeviceEvent::Disconnected(DeviceKey(1)));
    assert_eq!(gamepads.report(), PadReport::default(), "neutral at once");
    gamepads.apply(1.0, connected(2));
    gamepads.apply(1.1, report(2, 0, false));
    assert_eq!(gamepads.report().state.left_stick, [-1.0, 0.0], "and back");
    gamepads.apply(1.2, report(1, 255, true));
    assert_eq!(keys(&gamepads), [2], "events of a device that is gone are nothing");
}

#[test]
fn a_silent_pad_is_neutral() {
    let mut gamepads = Gamepads::new(Vec::new());
    gamepads.apply(0.0, connected(1));
    gamepads.apply(0.0, report(1, 255, true));
    gamepads.apply(0.2, DeviceEvent::Feature(DeviceKey(1), Box::new([0x05; 41])));
    assert!(gamepads.report().state.buttons.contains(Button::South));
    gamepads.apply(0.6, DeviceEvent::Feature(DeviceKey(1), Box::new([0x05; 41])));
    assert_eq!(gamepads.report(), PadReport::default());
}

#[test]
fn the_pad_used_last_is_the_active_one() {
    let mut gamepads = Gamepads::new(Vec::new());
    for key in [1, 2] {
        gamepads.apply(0.0, connected(key));
        gamepads.apply(0.0, report(key, 128, false));
    }
    let active = |gamepads: &Gamepads| gamepads.active().map(|pad| pad.device.key.0);
    assert_eq!(active(&gamepads), Some(1), "the first one before any is used");
    gamepads.apply(0.1, report(2, 255, false));
    gamepads.apply(0.1, report(1, 128, false));
    assert_eq!(active(&gamepads), Some(2));
    gamepads.apply(0.2, report(2, 128, false));
    assert_eq!(active(&gamepads), Some(2), "as long as no other is used");
    gamepads.apply(0.3, report(1, 128, true));
    assert_eq!(active(&gamepads), Some(1));
    gamepads.apply(0.4, DeviceEvent::Disconnected(DeviceKey(1)));
    assert_eq!(active(&gamepads), Some(2));
}

#[test]
fn a_pad_that_lies_on_its_trigger_is_not_active_again_with_every_report() {
    let mut gamepads = Gamepads::new(Vec::new());
    let lying = |key| {
        let DeviceEvent::Report(key, mut bytes) = report(key, 128, false) else { unreachable!() };
        // The left trigger, as a value and as a button.
        (bytes[5], bytes[9]) = (255, 0x04);
        DeviceEvent::Report(key, bytes)
    };
    for key in [1, 2] {
        gamepads.apply(0.0, connected(key));
    }
    gamepads.apply(0.0, lying(1));
    let active = |gamepads: &Gamepads| gamepads.active().map(|pad| pad.device.key.0);
    assert_eq!((active(&gamepads), gamepads.pressed().is_none()), (Some(1), true));
    for step in 0..20 {
        let time_secs = 0.1 + f64::from(step) * 0.004;
        gamepads.apply(time_secs, report(2, 255, step % 2 == 1));
        gamepads.apply(time_secs, lying(1));
        assert_eq!(active(&gamepads), Some(2), "step {step}");
    }
    // It was silent for a while, and still lies there.
    gamepads.apply(2.0, lying(1));
    assert_eq!(active(&gamepads), Some(2));
    assert_eq!(gamepads.pressed().map(|pad| pad.device.key.0), Some(2));
    gamepads.apply(2.1, report(1, 128, true));
    assert_eq!((active(&gamepads), gamepads.pressed().map(|pad| pad.device.key.0)), (Some(1), Some(1)));
}

#[test]
fn the_pad_on_which_a_button_goes_down_is_told_from_the_active_one() {
    let mut gamepads = Gamepads::new(Vec::new());
    for key in [1, 2] {
        gamepads.apply(0.0, connected(key));
        gamepads.apply(0.0, report(key, 128, false));
    }
    gamepads.apply(0.1, report(1, 255, false));
    assert!(gamepads.active().is_some() && gamepads.pressed().is_none(), "a stick is no button");
    gamepads.apply(0.2, report(2, 128, true));
    assert_eq!(gamepads.pressed().map(|pad| pad.device.key.0), Some(2));
    gamepads.apply(0.3, DeviceEvent::Disconnected(DeviceKey(2)));
    assert!(gamepads.pressed().is_none());
}

#[test]
fn no_pad_shows_up_twice() {
    let mut gamepads = Gamepads::new(Vec::new());
    let through = |key, id, serial, source| DeviceEvent::Connected {
        device: DeviceInfo { source, ..device(key, id, serial) },
        descriptor: (source == Source::Hid).then(Vec::new),
    };
    let wireless = PadId { bus: Bus::Bluetooth, ..USB };
    // gilrs sees it first, then HID does.
    gamepads.apply(0.0, through(1, USB, None, Source::Gilrs));
    gamepads.apply(
        0.0,
        DeviceEvent::State(DeviceKey(1), GamepadState { left_trigger: 1.0, ..Default::default() }),
    );
    assert_eq!(keys(&gamepads), [1]);
    gamepads.apply(0.1, through(2, wireless, Some("a4:53:85:00:11:22"), Source::Hid));
    assert_eq!(keys(&gamepads), [2]);
    // The same pad on a cable as well: the cable wins. Another pad of that kind is another pad.
    gamepads.apply(0.2, through(3, USB, Some("A45385001122"), Source::Hid));
    gamepads.apply(0.2, through(4, USB, Some("A45385009999"), Source::Hid));
    assert_eq!(keys(&gamepads), [3, 4]);
    assert_eq!(gamepads.duplicates().map(|pad| pad.device.key.0).collect::<Vec<_>>(), [1, 2]);
    // A pad of another kind through gilrs stays.
    let xbox = PadId { vendor: 0x045e, product: 0x02ea, bus: Bus::Other };
    gamepads.apply(0.3, through(5, xbox, None, Source::Gilrs));
    assert_eq!(keys(&gamepads), [3, 4, 5]);
    for key in [3, 4] {
        gamepads.apply(0.4, DeviceEvent::Disconnected(DeviceKey(key)));
    }
    assert_eq!(keys(&gamepads), [2, 5]);
}

/// A back end whose events are given, and whose output is kept.
#[derive(Clone, Default)]
struct Scripted(Arc<Mutex<Script>>);

#[derive(Default)]
struct Script {
    events: Vec<DeviceEvent>,
    sent: Vec<Vec<u8>>,
}

impl PadBackend for Scripted {
    fn poll_into(&mut self, events: &mut Vec<(Instant, DeviceEvent)>) {
        events.extend(self.0.lock().unwrap().events.drain(..).map(|event| (Instant::now(), event)));
    }
    fn send(&mut self, _: DeviceKey, report: &[u8]) -> bool {
        self.0.lock().unwrap().sent.push(report.to_vec());
        true
    }
}

#[test]
fn polling_and_output_go_through_the_back_ends() {
    let backend = Scripted::default();
    let mut gamepads = Gamepads::new(vec![Box::new(backend.clone())]);
    backend.0.lock().unwrap().events.extend([connected(1), report(1, 255, false)]);
    gamepads.poll();
    assert_eq!(gamepads.report().state.left_stick, [1.0, 0.0]);
    let output = PadOutput { low_rumble: 1.0, ..PadOutput::default() };
    assert!(gamepads.set_output(DeviceKey(1), &output));
    assert!(!gamepads.set_output(DeviceKey(2), &output), "no such pad");
    let sent = backend.0.lock().unwrap().sent.clone();
    assert_eq!((sent.len(), sent[0][0], sent[0][4]), (1, 0x02, 255));
}

fn linux() -> SystemFacts {
    SystemFacts { is_linux: true, has_hidapi: true, hidraw_nodes: 3, ..SystemFacts::default() }
}

#[test]
fn the_doctor_shows_a_pad_with_its_values() {
    let mut gamepads = Gamepads::new(Vec::new());
    gamepads.apply(0.0, connected(1));
    let (text, _) = doctor::report(&gamepads, &linux());
    assert!(text.contains("none yet: press a button"), "{text}");
    gamepads.apply(0.1, report(1, 255, true));
    let (text, sound) = doctor::report(&gamepads, &linux());
    for part in [
        "Pad 1: Pad 1",
        "054c:0ce6 over USB at /dev/hidraw1, through hidapi, read as DualSense",
        "left +1.00 +0.00",
        "buttons South",
        "battery  5 %, on battery",
        "1 read, 0 refused",
        "output   rumble, light bar",
        "No problem found.",
    ] {
        assert!(text.contains(part), "{text}\nlacks {part:?}");
    }
    assert!(sound);
}

#[test]
fn the_doctor_lists_problems_and_remedies() {
    let mut gamepads = Gamepads::new(Vec::new());
    let said = |gamepads: &Gamepads, facts: &SystemFacts, parts: &[&str]| {
        let (text, sound) = doctor::report(gamepads, facts);
        assert!(!sound);
        for part in parts {
            assert!(text.contains(part), "{text}\nlacks {part:?}");
        }
    };
    said(&gamepads, &SystemFacts { hidraw_nodes: 0, ..linux() }, &["has no HID device", "container"]);
    said(&gamepads, &linux(), &["no pad found among 3 HID devices", udev::RULES_PATH]);
    let xpad =
        EventPad { name: "Xbox pad".into(), vendor: 0x045e, product: 0x02ea, handler: "event7".into() };
    let facts = SystemFacts { event_pads: vec![xpad], ..linux() };
    said(&gamepads, &facts, &["Xbox pad (045e:02ea, event7)", "--features gilrs", "libudev-dev"]);
    let facts = SystemFacts { has_gilrs: true, ..facts };
    said(&gamepads, &facts, &["/dev/input/event7"]);
    let problem = Problem::Permission { path: "/dev/hidraw4".into(), id: USB };
    gamepads.apply(0.0, DeviceEvent::Unusable { device: device(4, USB, None), problem });
    said(
        &gamepads,
        &linux(),
        &[
            "/dev/hidraw4: expected permission",
            "idVendor}==\"054c\"",
            "TAG+=\"uaccess\"",
            "udevadm control --reload",
        ],
    );
    gamepads.apply(0.1, DeviceEvent::Disconnected(DeviceKey(4)));
    assert!(gamepads.problems().is_empty());
    let unknown = PadId { vendor: 1, product: 2, bus: Bus::Usb };
    let device = device(5, unknown, None);
    gamepads.apply(0.2, DeviceEvent::Connected { device, descriptor: Some(vec![0xc0]) });
    said(&gamepads, &linux(), &["Pad 5 (0001:0002)", "report descriptor"]);
}

#[test]
fn the_doctor_notices_refused_reports() {
    let mut gamepads = Gamepads::new(Vec::new());
    gamepads.apply(0.0, connected(1));
    for _ in 0..5 {
        gamepads.apply(0.1, DeviceEvent::Report(DeviceKey(1), Box::new([0x01; 9])));
    }
    let (text, sound) = doctor::report(&gamepads, &linux());
    assert!(
        text.contains("most reports are refused") && text.contains("expected at least 64 bytes"),
        "{text}"
    );
    assert!(!sound);
}

#[test]
fn the_kernels_list_of_pads() {
    let text = "I: Bus=0003 Vendor=045e Product=02ea Version=0301\nN: Name=\"Xbox One S pad\"\n\
                H: Handlers=event7 js0 \nB: PROP=0\n\n\
                I: Bus=0003 Vendor=046d Product=c077 Version=0111\nN: Name=\"Mouse\"\nH: Handlers=mouse0 event3 \n\n\
                I: broken\nH: Handlers=js1 event9\n\ngarbage";
    let expected =
        EventPad { name: "Xbox One S pad".into(), vendor: 0x045e, product: 0x02ea, handler: "event7".into() };
    assert_eq!(EventPad::list(text), [expected]);
}

#[test]
fn the_udev_rules_name_every_known_pad_on_both_buses() {
    let rules = udev::rules();
    for id in ["054c\", ATTRS{idProduct}==\"05c4", "057e\", ATTRS{idProduct}==\"2009", "*:045E:0B13.*"] {
        assert!(rules.contains(id), "{id}");
    }
    assert!(
        rules
            .lines()
            .all(|line| line.is_empty() || line.starts_with('#') || line.ends_with("TAG+=\"uaccess\""))
    );
}

#[test]
fn buttons_of_a_state_pad_are_kept() {
    let mut gamepads = Gamepads::new(Vec::new());
    let gilrs = DeviceInfo { source: Source::Gilrs, ..device(1, USB, None) };
    gamepads.apply(0.0, DeviceEvent::Connected { device: gilrs, descriptor: None });
    let state = GamepadState { buttons: Buttons::NONE.with(Button::Guide), ..GamepadState::default() };
    gamepads.apply(0.1, DeviceEvent::State(DeviceKey(1), state));
    gamepads.apply(60.0, DeviceEvent::Disconnected(DeviceKey(99)));
    assert_eq!(gamepads.report().state, state, "such a pad reports changes only");
}

#[test]
fn the_back_ends_of_this_build_start_and_stop_on_any_machine() {
    let (mut gamepads, errors) = Gamepads::with_all_backends();
    for error in errors {
        eprintln!("skipped: {error}");
    }
    gamepads.poll();
    let (text, _) = doctor::report(&gamepads, &SystemFacts::of_this_system(Vec::new()));
    assert!(text.starts_with("Back ends: "), "{text}");
}
