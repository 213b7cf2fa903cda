//! Report of `pad doctor`: connected pads, back ends, live values, problems and their remedies.
//!
//! Pure text from [`Gamepads`] and [`SystemFacts`]; the program prints it.

mod facts;

use std::fmt::Write as _;

pub use facts::{EventPad, SystemFacts};

use crate::device::Problem;
use crate::pads::Model;
use crate::{Button, GamepadState, Gamepads, Pad, PadReport, Power, udev};

/// The whole report as text, and true when there is a usable pad and no problem.
#[must_use]
pub fn report(gamepads: &Gamepads, facts: &SystemFacts) -> (String, bool) {
    let mut text = String::new();
    // Writing to a string can't fail, here and below.
    let _ = writeln!(text, "Back ends: {}", facts.backends());
    let mut usable = 0;
    for pad in gamepads.pads() {
        usable += 1;
        pad_text(&mut text, usable, pad, &gamepads.report_of(pad), gamepads.now_secs());
    }
    for pad in gamepads.duplicates() {
        let device = &pad.device;
        let _ = writeln!(
            text,
            "Ignored: {} at {} through {}: the same pad is connected in another way.",
            device.name, device.path, device.source
        );
    }
    let advice = advice(gamepads, facts, usable);
    if advice.is_empty() {
        text.push_str("No problem found.\n");
    }
    for (number, line) in (1..).zip(&advice) {
        let _ = writeln!(text, "Problem {number}: {line}");
    }
    (text, usable > 0 && advice.is_empty())
}

fn pad_text(text: &mut String, number: usize, pad: &Pad, report: &PadReport, now_secs: f64) {
    let (device, input) = (&pad.device, &report.input);
    let kind = Model::of(device.id).map_or("generic HID pad".into(), |model| format!("{model:?}"));
    let kind = if device.source == crate::device::Source::Hid { kind } else { "SDL mapping".into() };
    let id = device.id;
    let _ = writeln!(text, "\nPad {number}: {}", device.name);
    let _ = writeln!(
        text,
        "  {:04x}:{:04x} over {} at {}, through {}, read as {kind}",
        id.vendor, id.product, id.bus, device.path, device.source
    );
    let _ = writeln!(text, "  now      {}", values(&report.state));
    let _ = writeln!(text, "  raw      {}", values(&input.raw));
    if let Some(motion) = input.motion {
        let [gx, gy, gz] = motion.angular_velocity;
        let [ax, ay, az] = motion.acceleration;
        let _ = writeln!(
            text,
            "  motion   rotation {gx:+.2} {gy:+.2} {gz:+.2} rad/s, acceleration {ax:+.2} {ay:+.2} {az:+.2} m/s^2"
        );
    }
    if let Some(battery) = input.battery {
        let percent = battery.percent.map_or("unknown".into(), |percent| format!("{percent} %"));
        let power = match battery.power {
            Power::Discharging => "on battery",
            Power::Charging => "charging",
            Power::Full => "full",
            Power::Unknown => "fault",
        };
        let _ = writeln!(text, "  battery  {percent}, {power}");
    }
    let (accepted, refused) = pad.session.counts();
    let _ = writeln!(text, "  reports  {accepted} read, {refused} refused{}", presence(pad, now_secs));
    if pad.has_output() {
        let light = if pad.has_light() { ", light bar" } else { "" };
        let _ = writeln!(text, "  output   rumble{light}");
    }
}

fn presence(pad: &Pad, now_secs: f64) -> &'static str {
    let (accepted, _) = pad.session.counts();
    match (accepted, pad.session.is_present_at(now_secs)) {
        (0, _) => ", none yet: press a button",
        (_, true) => "",
        (_, false) => ", silent: read as neutral",
    }
}

/// One line of sticks, triggers, buttons.
#[must_use]
pub fn values(state: &GamepadState) -> String {
    let [lx, ly] = state.left_stick;
    let [rx, ry] = state.right_stick;
    let (lt, rt) = (state.left_trigger, state.right_trigger);
    let mut text =
        format!("left {lx:+.2} {ly:+.2}  right {rx:+.2} {ry:+.2}  triggers {lt:.2} {rt:.2}  buttons");
    for button in Button::ALL {
        if state.buttons.contains(button) {
            let _ = write!(text, " {button:?}");
        }
    }
    if state.buttons.is_empty() {
        text.push_str(" none");
    }
    text
}

/// One text for each problem.
fn advice(gamepads: &Gamepads, facts: &SystemFacts, usable: usize) -> Vec<String> {
    let mut advice: Vec<String> = facts.backend_errors.clone();
    for (device, problem) in gamepads.problems() {
        advice
            .push(format!("{} ({:04x}:{:04x}): {problem}", device.name, device.id.vendor, device.id.product));
    }
    for pad in gamepads.pads() {
        advice.extend(pad_advice(pad));
    }
    let reached = |event: &EventPad| {
        let same = |vendor, product| (vendor, product) == (event.vendor, event.product);
        gamepads.pads().any(|pad| same(pad.device.id.vendor, pad.device.id.product))
            || gamepads.problems().iter().any(|(device, _)| same(device.id.vendor, device.id.product))
    };
    for event in facts.event_pads.iter().filter(|event| !reached(event)) {
        advice.push(unreached(event, facts));
    }
    if usable == 0 && advice.is_empty() {
        advice.push(nothing_found(facts));
    }
    advice
}

fn pad_advice(pad: &Pad) -> Option<String> {
    let (accepted, refused) = pad.session.counts();
    let name = &pad.device.name;
    if let (true, Some(error)) = (refused > accepted, pad.last_error()) {
        return Some(format!(
            "{name}: most reports are refused; the last error is: {error}. If this is a copy of a known pad, switch it \
             to another mode, or record it with `pad record` and report it"
        ));
    }
    match pad.session.calibration_outcome() {
        Some(Err(error)) => Some(format!(
            "{name}: rest positions could not be measured ({error}). Put the pad down, release all controls, and start \
             again"
        )),
        _ => None,
    }
}

fn unreached(event: &EventPad, facts: &SystemFacts) -> String {
    let what = format!("{} ({:04x}:{:04x}, {})", event.name, event.vendor, event.product, event.handler);
    if facts.has_gilrs {
        format!(
            "{what}: the system has this pad, but neither back end reads it. Check that you may read /dev/input/{}",
            event.handler
        )
    } else {
        format!(
            "{what}: not an HID device (an Xbox pad on USB, for example). Install libudev-dev and pkg-config, and \
             build with `--features gilrs`"
        )
    }
}

fn nothing_found(facts: &SystemFacts) -> String {
    if !facts.is_linux {
        return "no pad found. Connect or pair one, and press a button on it".into();
    }
    if facts.hidraw_nodes == 0 {
        return "no pad found: this system has no HID device (no /dev/hidraw*). Connect or pair a pad. In a container \
                or virtual machine, pass the device through"
            .into();
    }
    format!(
        "no pad found among {} HID devices. Connect or pair one, and press a button on it. If it is still not found, \
         install the udev rules (`pad udev | sudo tee {}`) and reconnect it",
        facts.hidraw_nodes,
        udev::RULES_PATH
    )
}

/// True for a problem that a udev rule solves.
#[must_use]
pub fn needs_rules(problem: &Problem) -> bool {
    matches!(problem, Problem::Permission { .. })
}
