//! A virtual DualSense in the kernel, end to end: /dev/uhid, hidraw, hidapi, state. Skipped where there is no uhid.
//!
//! Source of the events: Linux `include/uapi/linux/uhid.h`; of the answers that `hid-playstation.c` wants: there.
#![cfg(all(target_os = "linux", feature = "hidapi"))]

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::time::{Duration, Instant};

use gamepad::pads::PadOutput;
use gamepad::{Button, Gamepads, PadReport};

const EVENT_LEN: usize = 4380;
const DESTROY: u32 = 1;
const OUTPUT: u32 = 6;
const GET_REPORT: u32 = 9;
const GET_REPORT_REPLY: u32 = 10;
const CREATE2: u32 = 11;
const INPUT2: u32 = 12;
const SET_REPORT: u32 = 13;
const SET_REPORT_REPLY: u32 = 14;
const NON_BLOCKING: i32 = 0o4000;
const SERIAL: &str = "02:00:00:00:5e:01";

/// Reports of a DualSense by number and length: input 1 (63 bytes), output 2 (62), features 5, 9 and 32.
const DESCRIPTOR: &[u8] = &[
    0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, // game pad
    0x85, 0x01, 0x09, 0x30, 0x09, 0x31, 0x09, 0x32, 0x09, 0x35, 0x09, 0x33, 0x09, 0x34, // six axes
    0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x06, 0x81, 0x02, //
    0x06, 0x00, 0xff, 0x09, 0x20, 0x95, 57, 0x81, 0x02, // the maker's own
    0x85, 0x02, 0x09, 0x23, 0x95, 62, 0x91, 0x02, //
    0x85, 0x05, 0x09, 0x33, 0x95, 40, 0xb1, 0x02, //
    0x85, 0x09, 0x09, 0x34, 0x95, 19, 0xb1, 0x02, //
    0x85, 0x20, 0x09, 0x26, 0x95, 63, 0xb1, 0x02, 0xc0,
];

/// The virtual pad's end in the kernel.
struct Uhid {
    file: File,
    outputs: Vec<Vec<u8>>,
}

impl Uhid {
    fn create() -> std::io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).custom_flags(NON_BLOCKING).open("/dev/uhid")?;
        let mut uhid = Self { file, outputs: Vec::new() };
        let mut body = vec![0; 128 + 64 + 64];
        let name = b"Policy Space virtual DualSense";
        body[..name.len()].copy_from_slice(name);
        body[192..192 + SERIAL.len()].copy_from_slice(SERIAL.as_bytes());
        body.extend((DESCRIPTOR.len() as u16).to_le_bytes());
        body.extend(3u16.to_le_bytes()); // USB
        for number in [0x054c_u32, 0x0ce6, 0x0100, 0] {
            body.extend(number.to_le_bytes());
        }
        body.extend(DESCRIPTOR);
        uhid.send(CREATE2, &body)?;
        Ok(uhid)
    }

    fn send(&mut self, kind: u32, body: &[u8]) -> std::io::Result<()> {
        let mut event = kind.to_le_bytes().to_vec();
        event.extend(body);
        event.resize(EVENT_LEN, 0);
        self.file.write_all(&event)
    }

    fn input(&mut self, report: &[u8]) -> std::io::Result<()> {
        let body = [&(report.len() as u16).to_le_bytes()[..], report].concat();
        self.send(INPUT2, &body)
    }

    /// Replies to every request of the kernel.
    fn answer(&mut self) -> std::io::Result<()> {
        let mut event = [0; EVENT_LEN];
        loop {
            match self.file.read(&mut event) {
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) => return Err(error),
            }
            let (kind, body) = event.split_at(4);
            match u32::from_le_bytes(kind.try_into().unwrap()) {
                GET_REPORT => {
                    let report = feature(body[4]);
                    let error: u16 = if report.is_empty() { 5 } else { 0 };
                    let mut reply = body[..4].to_vec();
                    reply.extend(error.to_le_bytes());
                    reply.extend((report.len() as u16).to_le_bytes());
                    reply.extend(report);
                    self.send(GET_REPORT_REPLY, &reply)?;
                }
                SET_REPORT => {
                    let reply = [&body[..4], &[0, 0]].concat();
                    self.send(SET_REPORT_REPLY, &reply)?;
                }
                OUTPUT => {
                    let len = u16::from_le_bytes([body[4096], body[4097]]);
                    self.outputs.push(body[..usize::from(len)].to_vec());
                }
                _ => {}
            }
        }
    }
}

/// Calibration, address, firmware: what the kernel's driver reads before it takes the pad.
fn feature(id: u8) -> Vec<u8> {
    let mut report = vec![id];
    match id {
        0x05 => {
            let values: [i16; 17] = [
                0, 0, 0, 8640, -8640, 8640, -8640, 8640, -8640, 540, 540, 8192, -8192, 8192, -8192, 8192,
                -8192,
            ];
            report.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            report.resize(41, 0);
        }
        0x09 => {
            report.extend([0x01, 0x5e, 0, 0, 0, 0x02]);
            report.resize(20, 0);
        }
        0x20 => report.resize(64, 0x01),
        _ => report.clear(),
    }
    report
}

fn report(x: u8, right_trigger: u8, south: bool) -> [u8; 64] {
    let mut report = [0; 64];
    report[..7].copy_from_slice(&[0x01, x, 128, 128, 128, 0, right_trigger]);
    report[8] = if south { 0x28 } else { 0x08 };
    (report[33], report[37]) = (0x80, 0x80);
    report
}

/// Sends a report every 4 ms until `done` is true of the pad; false when it takes more than 15 s.
fn until(
    uhid: &mut Uhid,
    gamepads: &mut Gamepads,
    report: Option<&[u8]>,
    mut done: impl FnMut(&mut Gamepads, &Uhid) -> bool,
) -> bool {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(15) {
        uhid.answer().unwrap();
        if let Some(report) = report {
            uhid.input(report).unwrap();
        }
        gamepads.poll();
        if done(gamepads, uhid) {
            return true;
        }
        std::thread::sleep(Duration::from_millis(4));
    }
    false
}

fn is_ours(serial: Option<&str>) -> bool {
    serial.is_some_and(|serial| serial.eq_ignore_ascii_case(SERIAL))
}

#[test]
fn a_virtual_dualsense_end_to_end() {
    let mut uhid = match Uhid::create() {
        Ok(uhid) => uhid,
        Err(error) => return eprintln!("skipped: /dev/uhid: {error}"),
    };
    let (mut gamepads, errors) = Gamepads::with_all_backends();
    assert!(errors.is_empty(), "{errors:?}");
    let ours = |gamepads: &Gamepads| {
        gamepads.pads().find(|pad| is_ours(pad.device.serial.as_deref())).map(|pad| pad.device.key)
    };
    let rest = report(128, 0, false);
    let found = until(&mut uhid, &mut gamepads, Some(&rest), |gamepads, _| {
        ours(gamepads).is_some()
            || gamepads.problems().iter().any(|(device, _)| is_ours(device.serial.as_deref()))
    });
    assert!(found, "the virtual pad never showed up");
    let Some(key) = ours(&gamepads) else {
        return eprintln!("skipped: the virtual pad cannot be opened: {}", gamepads.problems()[0].1);
    };
    let state = |gamepads: &mut Gamepads| {
        let pad = gamepads.pads().find(|pad| pad.device.key == key);
        pad.map(|pad| gamepads.report_of(pad)).unwrap_or_default()
    };
    let held = report(255, 255, true);
    assert!(until(&mut uhid, &mut gamepads, Some(&held), |gamepads, _| {
        let found = state(gamepads).state;
        found.left_stick[0] == 1.0 && found.right_trigger == 1.0 && found.buttons.contains(Button::South)
    }));
    let output = PadOutput { low_rumble: 1.0, ..PadOutput::default() };
    assert!(gamepads.set_output(key, &output));
    assert!(until(&mut uhid, &mut gamepads, Some(&held), |_, uhid| {
        uhid.outputs.iter().any(|report| report.first() == Some(&0x02) && report[4] == 255)
    }));
    // Silent: neutral. Reporting again: present. Disconnected: neutral and removed.
    assert!(until(&mut uhid, &mut gamepads, None, |gamepads, _| state(gamepads) == PadReport::default()));
    assert!(until(&mut uhid, &mut gamepads, Some(&held), |gamepads, _| state(gamepads).state.left_stick[0]
        == 1.0));
    uhid.send(DESTROY, &[]).unwrap();
    let start = Instant::now();
    while ours(&gamepads).is_some() && start.elapsed() < Duration::from_secs(15) {
        gamepads.poll();
        std::thread::sleep(Duration::from_millis(4));
    }
    assert_eq!(ours(&gamepads), None, "a pad that is pulled out is gone");
}
