//! What DualShock 4 and DualSense have in common: buttons, checksums, touch points, motion.
//!
//! Source of the layouts: Linux `drivers/hid/hid-playstation.c`; SDL `SDL_hidapi_ps4.c`, `SDL_hidapi_ps5.c`.

use super::bytes::{GRAVITY, i16_at, i16x3_at, press, press_hat, trigger_u8};
use crate::{Button, Buttons, GamepadState, Motion, ReportError, Touch};

/// Seeds of the CRC32 over Bluetooth: the byte that precedes the report on the wire.
pub(crate) const INPUT_SEED: u8 = 0xa1;
pub(crate) const OUTPUT_SEED: u8 = 0xa2;

/// CRC32 over the seed and the bytes.
pub(crate) fn crc32(seed: u8, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&[seed]);
    hasher.update(bytes);
    hasher.finalize()
}

/// Checks the CRC32 in the last four bytes of an input report.
pub(crate) fn check_crc(report: &[u8]) -> Result<(), ReportError> {
    let Some((bytes, tail)) = report.split_last_chunk::<4>() else {
        return Err(ReportError::Empty);
    };
    let (expected, found) = (crc32(INPUT_SEED, bytes), u32::from_le_bytes(*tail));
    if expected == found {
        return Ok(());
    }
    Err(ReportError::Checksum { report_id: report[0], expected, found })
}

/// The three bytes of buttons; the third one's upper bits hold a counter and are ignored.
pub(crate) fn buttons(bytes: [u8; 3]) -> Buttons {
    let mut buttons = Buttons::NONE;
    press_hat(bytes[0] & 0x0f, &mut buttons);
    let faces = [(0x10, Button::West), (0x20, Button::South), (0x40, Button::East), (0x80, Button::North)];
    press(bytes[0], &faces, &mut buttons);
    let others = [
        (0x01, Button::LeftShoulder),
        (0x02, Button::RightShoulder),
        (0x04, Button::LeftTrigger),
        (0x08, Button::RightTrigger),
        (0x10, Button::Select),
        (0x20, Button::Start),
        (0x40, Button::LeftStick),
        (0x80, Button::RightStick),
    ];
    press(bytes[1], &others, &mut buttons);
    press(bytes[2], &[(0x01, Button::Guide), (0x02, Button::Touchpad)], &mut buttons);
    buttons
}

/// Sticks of four bytes, three bytes of buttons, then the triggers: the simple reports of both pads.
pub(crate) fn simple_state(bytes: &[u8; 9]) -> GamepadState {
    GamepadState {
        left_stick: super::bytes::stick_u8(bytes[0], bytes[1]),
        right_stick: super::bytes::stick_u8(bytes[2], bytes[3]),
        left_trigger: trigger_u8(bytes[7]),
        right_trigger: trigger_u8(bytes[8]),
        buttons: buttons([bytes[4], bytes[5], bytes[6]]),
    }
}

/// A touch point of four bytes: contact (top bit: no finger), 12 bits of x, 12 bits of y.
pub(crate) fn touch_point(bytes: &[u8], size: [u16; 2]) -> Option<Touch> {
    let x = u16::from(bytes[1]) | u16::from(bytes[2] & 0x0f) << 8;
    let y = u16::from(bytes[2] >> 4) | u16::from(bytes[3]) << 4;
    let fraction = |value: u16, size: u16| (f32::from(value) / f32::from(size - 1)).min(1.0);
    (bytes[0] & 0x80 == 0)
        .then(|| Touch { id: bytes[0], position: [fraction(x, size[0]), 1.0 - fraction(y, size[1])] })
}

/// Scales of the motion sensors: nominal, or as measured in the factory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionScale {
    bias: [f32; 6],
    /// rad/s per count, then m/s^2 per count.
    scale: [f32; 6],
}

impl MotionScale {
    /// 16 counts per degree/s and 8192 counts per g.
    pub const NOMINAL: Self = {
        let (gyro, accel) = (std::f32::consts::PI / 180.0 / 16.0, GRAVITY / 8192.0);
        Self { bias: [0.0; 6], scale: [gyro, gyro, gyro, accel, accel, accel] }
    };

    /// From a pad's calibration feature report (35 bytes or more, with its id).
    ///
    /// `pairs` tells the order of the gyroscope's plus and minus values: one pair for each axis (USB, DualSense)
    /// or all plus values first (DualShock 4 over Bluetooth). `None` when a value is implausible, as with many
    /// copies of these pads: use [`MotionScale::NOMINAL`] then.
    #[must_use]
    pub fn from_feature(report: &[u8], pairs: bool) -> Option<Self> {
        const LEN: usize = 35;
        if report.len() < LEN {
            return None;
        }
        let at = |index: usize| f32::from(i16_at(report, 1 + 2 * index));
        let mut found = Self::NOMINAL;
        let speed = at(9) + at(10);
        for axis in 0..3 {
            let (plus, minus) =
                if pairs { (at(3 + 2 * axis), at(4 + 2 * axis)) } else { (at(3 + axis), at(6 + axis)) };
            found.bias[axis] = at(axis);
            found.scale[axis] = speed / (plus - minus) * std::f32::consts::PI / 180.0;
            let (plus, minus) = (at(11 + 2 * axis), at(12 + 2 * axis));
            found.bias[3 + axis] = (plus + minus) / 2.0;
            found.scale[3 + axis] = 2.0 * GRAVITY / (plus - minus);
        }
        found.is_plausible().then_some(found)
    }

    /// SDL's bounds: a bias of at most 1024 counts, a scale within half of the nominal one.
    fn is_plausible(&self) -> bool {
        let near = |(scale, nominal): (&f32, &f32)| (scale / nominal - 1.0).abs() <= 0.5;
        self.bias.iter().all(|bias| bias.abs() <= 1024.0)
            && self.scale.iter().zip(&Self::NOMINAL.scale).all(near)
    }

    /// Twelve bytes: gyroscope x, y, z, accelerometer x, y, z.
    pub(crate) fn motion(&self, bytes: &[u8]) -> Motion {
        let (gyro, accel) = (i16x3_at(bytes, 0), i16x3_at(bytes, 6));
        let scaled = |raw: i16, i: usize| (f32::from(raw) - self.bias[i]) * self.scale[i];
        Motion {
            angular_velocity: [0, 1, 2].map(|i| scaled(gyro[i], i)),
            acceleration: [0, 1, 2].map(|i| scaled(accel[i], 3 + i)),
        }
    }
}
