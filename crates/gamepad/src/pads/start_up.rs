//! Requests that a pad needs once before it sends full reports. Pure data; the back end sends them.
//!
//! Source: Linux `drivers/hid/hid-nintendo.c` (handshake, subcommands), SDL `SDL_hidapi_ps4.c`,
//! `SDL_hidapi_ps5.c`, `SDL_hidapi_8bitdo.c` (feature reports that switch to full reports).

use super::output::NO_RUMBLE;
use super::switch_pro::{FACTORY_LEFT, FACTORY_RIGHT, USER_LEFT, USER_RIGHT};
use super::{Bus, Model};

/// One request to a pad after opening it, in order; failures are not fatal.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Request {
    /// Read this feature report and pass it to the parser.
    Feature {
        /// Number of the report.
        id: u8,
        /// Length with the id.
        len: usize,
    },
    /// Write this output report.
    Output(Vec<u8>),
}

impl Model {
    /// Requests after opening a pad of this model.
    #[must_use]
    pub fn start_up(self, bus: Bus) -> Vec<Request> {
        match (self, bus) {
            // Reading the calibration also switches a Bluetooth pad to full reports.
            (Self::DualShock4, Bus::Bluetooth) => {
                vec![Request::Feature { id: 0x02, len: 37 }, Request::Feature { id: 0x05, len: 41 }]
            }
            (Self::DualShock4 | Self::DualShock4Receiver, _) => vec![Request::Feature { id: 0x02, len: 37 }],
            (Self::DualSense, _) => vec![Request::Feature { id: 0x05, len: 41 }],
            (Self::SwitchPro, bus) => switch_pro(bus),
            (Self::EightBitDo | Self::EightBitDoUltimate, _) => vec![Request::Feature { id: 0x06, len: 64 }],
            (Self::XboxWireless | Self::XboxSeries, _) => Vec::new(),
        }
    }
}

fn switch_pro(bus: Bus) -> Vec<Request> {
    const HANDSHAKE: u8 = 0x02;
    const FAST: u8 = 0x03;
    const NO_TIMEOUT: u8 = 0x04;
    let mut requests = Vec::new();
    if bus == Bus::Usb {
        let commands = [HANDSHAKE, FAST, HANDSHAKE, NO_TIMEOUT];
        requests.extend(commands.map(|command| Request::Output(vec![0x80, command])));
    }
    let read = |address: u32, len: u8| {
        let [a, b, c, d] = address.to_le_bytes();
        (0x10, vec![a, b, c, d, len])
    };
    let subcommands = [
        read(FACTORY_LEFT, 9),
        read(FACTORY_RIGHT, 9),
        read(USER_LEFT, 11),
        read(USER_RIGHT, 11),
        (0x40, vec![1]),    // motion sensors on
        (0x48, vec![1]),    // rumble on
        (0x03, vec![0x30]), // full reports
    ];
    for (number, (command, arguments)) in (0..).zip(subcommands) {
        let mut report = vec![0x01, number];
        report.extend(NO_RUMBLE);
        report.extend(NO_RUMBLE);
        report.push(command);
        report.extend(arguments);
        requests.push(Request::Output(report));
    }
    requests
}
