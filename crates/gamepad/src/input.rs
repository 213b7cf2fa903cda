//! Input of a pad as plain data: controls before dead zones, motion, battery, touch.

use crate::GamepadState;

/// One pad's input as reported: scaled to the units below, before dead zones and calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PadInput {
    /// Sticks, triggers and buttons before dead zones. A worn stick rests off zero here.
    pub raw: GamepadState,
    /// Motion sensors, where the report has them.
    pub motion: Option<Motion>,
    /// Battery, where the report has it.
    pub battery: Option<Battery>,
    /// Fingers on the touch pad, where there is one.
    pub touch: [Option<Touch>; 2],
}

/// A pad's input with its state after dead zones: what a game reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PadReport {
    /// State after calibration and dead zones; neutral while the pad is gone or silent.
    pub state: GamepadState,
    /// The same as reported; default while the pad is gone or silent.
    pub input: PadInput,
}

/// Motion sensors in the frame of the pad: x to its right, y out of its face, z towards the player.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Rotation rate about x (pitch), y (yaw), z (roll) in rad/s.
    pub angular_velocity: [f32; 3],
    /// Specific force in m/s^2; about 9.81 along y while the pad lies face up.
    pub acceleration: [f32; 3],
}

/// State of the battery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Battery {
    /// Charge in percent, [0, 100]; coarse on most pads. `None` when the pad reports a fault.
    pub percent: Option<u8>,
    /// Whether it charges or discharges.
    pub power: Power,
}

/// Whether a battery charges or discharges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Power {
    /// Runs on battery.
    Discharging,
    /// Charges.
    Charging,
    /// Plugged in and full.
    Full,
    /// The pad reports a fault (voltage, temperature, charger) or nothing.
    Unknown,
}

/// A finger on the touch pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Number of the contact; a new one for each touch.
    pub id: u8,
    /// x to the right, y away from the player, each in [0, 1].
    pub position: [f32; 2],
}

/// What one report changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Update {
    /// Sticks, triggers and buttons.
    Controls,
    /// Another part of the input: battery, guide button, calibration.
    Other,
    /// Nothing.
    Nothing,
    /// A wireless receiver reports that its pad is off.
    Absent,
}

/// Why a report was refused. The input is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The report is empty.
    #[error("expected a report, found no byte")]
    Empty,
    /// Fewer bytes than the report's layout has.
    #[error("report {report_id:#04x}: expected at least {expected} bytes, found {found}")]
    TooShort {
        /// First byte of the report.
        report_id: u8,
        /// Bytes in the layout.
        expected: usize,
        /// Bytes in the report.
        found: usize,
    },
    /// The CRC32 at the end does not match the bytes before it.
    #[error("report {report_id:#04x}: expected checksum {expected:#010x}, found {found:#010x}")]
    Checksum {
        /// First byte of the report.
        report_id: u8,
        /// CRC32 of the bytes.
        expected: u32,
        /// CRC32 in the report.
        found: u32,
    },
    /// A report that this pad is not known to send.
    #[error("report {report_id:#04x}: expected a report of this pad, found an unknown one")]
    UnknownReport {
        /// First byte of the report.
        report_id: u8,
    },
}
