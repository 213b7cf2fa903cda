//! Devices and their events as plain data from back ends.

use std::fmt;

use crate::pads::{Bus, NoGamepad, PadId};
use crate::{GamepadState, udev};

/// Identifies one connection of one device while the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DeviceKey(pub u64);

/// Which library reads a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Source {
    /// hidapi: raw HID reports.
    Hid,
    /// gilrs: evdev, XInput and the like, with SDL's mappings.
    Gilrs,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Hid => "hidapi",
            Self::Gilrs => "gilrs",
        })
    }
}

/// A device that a back end found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Which connection this is.
    pub key: DeviceKey,
    /// Its name, for people.
    pub name: String,
    /// Vendor, product, bus; zeros when the back end does not know.
    pub id: PadId,
    /// Serial number or Bluetooth address, where there is one.
    pub serial: Option<String>,
    /// Path in the system, e.g. `/dev/hidraw3`.
    pub path: String,
    /// Which library reads it.
    pub source: Source,
}

/// An event of a device.
#[derive(Clone, Debug, PartialEq)]
pub enum DeviceEvent {
    /// It was connected and can be read.
    Connected {
        /// The device.
        device: DeviceInfo,
        /// Its HID report descriptor; `None` when its events are states.
        descriptor: Option<Vec<u8>>,
    },
    /// An input report.
    Report(DeviceKey, Box<[u8]>),
    /// A feature report requested at start-up.
    Feature(DeviceKey, Box<[u8]>),
    /// A raw state.
    State(DeviceKey, GamepadState),
    /// It was disconnected.
    Disconnected(DeviceKey),
    /// It is connected but can't be read.
    Unusable {
        /// The device.
        device: DeviceInfo,
        /// Why, and what to do.
        problem: Problem,
    },
}

/// Why a pad can't be read, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// This user may not open it.
    #[error(
        "{path}: expected permission to read and write, found none. Install the udev rule with these commands, then \
         reconnect the pad:\n{}", udev::install_commands(*id)
    )]
    Permission {
        /// The device file.
        path: String,
        /// The pad.
        id: PadId,
    },
    /// It can't be opened for another reason.
    #[error("{path}: cannot be opened: {message}. Close other programs that use it, or reconnect the pad")]
    Open {
        /// The device file or the system's name for the device.
        path: String,
        /// Message of the system.
        message: String,
    },
    /// It is not a pad, or its descriptor is not understood.
    #[error("{0}. Record it with `pad record` and report it, or use it through gilrs")]
    NoGamepad(NoGamepad),
}

impl From<NoGamepad> for Problem {
    fn from(error: NoGamepad) -> Self {
        Self::NoGamepad(error)
    }
}

/// The bus by its usual name.
impl fmt::Display for Bus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Usb => "USB",
            Self::Bluetooth => "Bluetooth",
            Self::Other => "other bus",
        })
    }
}
