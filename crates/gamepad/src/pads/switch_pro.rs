//! Switch Pro: full report 0x30 with stick calibration, replies 0x21 (calibration), simple report 0x3f.
//!
//! Source of the layouts: Linux `drivers/hid/hid-nintendo.c` (`joycon_input_report`, `joycon_parse_stick_cal`,
//! flash addresses), SDL `src/joystick/hidapi/SDL_hidapi_switch.c` (simple report, axes of the motion sensors).

use super::bytes::{GRAVITY, centred, i16x3_at, prefix, press, press_hat, u16_at};
use crate::{Battery, Button, Buttons, GamepadState, Motion, PadInput, Power, ReportError, Update};

/// Controls without motion, the first part of 0x21, 0x30 and 0x31.
const CONTROLS_LEN: usize = 13;
/// With three samples of the motion sensors.
const FULL_LEN: usize = 49;
const SIMPLE_LEN: usize = 12;
/// A reply to a flash read of nine bytes: header, ack, command, address, length, data.
const FLASH_REPLY_LEN: usize = 20 + 9;

/// Flash addresses of the stick calibrations: factory left and right, user left and right (after the magic).
pub(crate) const FACTORY_LEFT: u32 = 0x603d;
pub(crate) const FACTORY_RIGHT: u32 = 0x6046;
pub(crate) const USER_LEFT: u32 = 0x8010;
pub(crate) const USER_RIGHT: u32 = 0x801b;
const USER_MAGIC: [u8; 2] = [0xb2, 0xa1];

/// Lowest, centre and highest value of one axis of a stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct AxisRange {
    low: u16,
    centre: u16,
    high: u16,
}

impl AxisRange {
    /// The kernel's default for a pad without a plausible calibration.
    const DEFAULT: Self = Self { low: 500, centre: 2000, high: 3500 };

    fn new(below: u16, centre: u16, above: u16) -> Option<Self> {
        let low = centre.checked_sub(below)?;
        (below > 0 && above > 0).then_some(Self { low, centre, high: centre + above })
    }

    fn scaled(self, value: u16) -> f32 {
        centred(value.into(), self.low.into(), self.centre.into(), self.high.into())
    }
}

/// Parser of one Switch Pro pad.
#[derive(Clone, Debug)]
pub struct SwitchPro {
    left: [AxisRange; 2],
    right: [AxisRange; 2],
    user_left: bool,
    user_right: bool,
}

impl Default for SwitchPro {
    fn default() -> Self {
        let sticks = [AxisRange::DEFAULT; 2];
        Self { left: sticks, right: sticks, user_left: false, user_right: false }
    }
}

impl SwitchPro {
    /// Reads one report.
    ///
    /// # Errors
    /// [`ReportError`] for short and unknown reports; `input` is unchanged.
    pub fn parse_into(&mut self, report: &[u8], input: &mut PadInput) -> Result<Update, ReportError> {
        match *report.first().ok_or(ReportError::Empty)? {
            0x30 | 0x31 => {
                let controls = prefix::<CONTROLS_LEN>(report)?;
                let motion = prefix::<FULL_LEN>(report).ok().map(motion);
                *input = PadInput { motion, ..self.controls(controls) };
                Ok(Update::Controls)
            }
            0x21 => {
                *input = PadInput { motion: input.motion, ..self.controls(prefix(report)?) };
                self.accept_reply(report);
                Ok(Update::Controls)
            }
            0x3f => {
                *input = PadInput { raw: simple(prefix(report)?), ..PadInput::default() };
                Ok(Update::Controls)
            }
            // Replies of the USB handshake.
            0x81 => Ok(Update::Nothing),
            report_id => Err(ReportError::UnknownReport { report_id }),
        }
    }

    fn controls(&self, report: &[u8; CONTROLS_LEN]) -> PadInput {
        let buttons = full_buttons(report[3], report[4], report[5]);
        let pull = |button| if buttons.contains(button) { 1.0 } else { 0.0 };
        let raw = GamepadState {
            left_stick: stick(&report[6..9], self.left),
            right_stick: stick(&report[9..12], self.right),
            left_trigger: pull(Button::LeftTrigger),
            right_trigger: pull(Button::RightTrigger),
            buttons,
        };
        PadInput { raw, battery: Some(battery(report[2])), ..PadInput::default() }
    }

    /// Reads the calibration from a reply to a flash read. The user's is preferred to the factory's.
    fn accept_reply(&mut self, report: &[u8]) {
        let Ok(reply) = prefix::<FLASH_REPLY_LEN>(report) else { return };
        if reply[13] & 0x80 == 0 || reply[14] != 0x10 {
            return;
        }
        let address = u32::from_le_bytes([reply[15], reply[16], reply[17], reply[18]]);
        let user = |data: &[u8]| data.len() >= 11 && data[..2] == USER_MAGIC;
        let data = &report[20..];
        match address {
            FACTORY_LEFT if !self.user_left => self.left = ranges(data, LEFT_ORDER).unwrap_or(self.left),
            FACTORY_RIGHT if !self.user_right => self.right = ranges(data, RIGHT_ORDER).unwrap_or(self.right),
            USER_LEFT if user(data) => {
                if let Some(found) = ranges(&data[2..], LEFT_ORDER) {
                    (self.left, self.user_left) = (found, true);
                }
            }
            USER_RIGHT if user(data) => {
                if let Some(found) = ranges(&data[2..], RIGHT_ORDER) {
                    (self.right, self.user_right) = (found, true);
                }
            }
            _ => {}
        }
    }
}

/// Which of the three pairs of a stick's calibration are below, centre and above.
const LEFT_ORDER: [usize; 3] = [2, 1, 0];
const RIGHT_ORDER: [usize; 3] = [1, 0, 2];

/// Two values of 12 bits in three bytes.
fn pair(bytes: &[u8]) -> [u16; 2] {
    let [a, b, c] = [bytes[0], bytes[1], bytes[2]].map(u16::from);
    [a | (b & 0x0f) << 8, b >> 4 | c << 4]
}

fn ranges(data: &[u8], [below, centre, above]: [usize; 3]) -> Option<[AxisRange; 2]> {
    let pairs = [pair(&data[0..]), pair(&data[3..]), pair(&data[6..])];
    let axis = |i: usize| AxisRange::new(pairs[below][i], pairs[centre][i], pairs[above][i]);
    Some([axis(0)?, axis(1)?])
}

/// Twelve bits an axis, y up.
fn stick(bytes: &[u8], ranges: [AxisRange; 2]) -> [f32; 2] {
    let [x, y] = pair(bytes);
    [ranges[0].scaled(x), ranges[1].scaled(y)]
}

fn full_buttons(right: u8, shared: u8, left: u8) -> Buttons {
    use Button as B;
    let mut buttons = Buttons::NONE;
    let on_right =
        [(0x01, B::West), (0x02, B::North), (0x04, B::South), (0x08, B::East), (0x40, B::RightShoulder)];
    press(right, &on_right, &mut buttons);
    press(right, &[(0x80, B::RightTrigger)], &mut buttons);
    let in_middle = [(0x01, B::Select), (0x02, B::Start), (0x04, B::RightStick), (0x08, B::LeftStick)];
    press(shared, &in_middle, &mut buttons);
    press(shared, &[(0x10, B::Guide), (0x20, B::Misc)], &mut buttons);
    let on_left = [(0x01, B::DpadDown), (0x02, B::DpadUp), (0x04, B::DpadRight), (0x08, B::DpadLeft)];
    press(left, &on_left, &mut buttons);
    press(left, &[(0x40, B::LeftShoulder), (0x80, B::LeftTrigger)], &mut buttons);
    buttons
}

/// The report before the full mode is on: two bytes of buttons, hat, sticks of 16 bits with y down.
fn simple(report: &[u8; SIMPLE_LEN]) -> GamepadState {
    use Button as B;
    let mut buttons = Buttons::NONE;
    let faces = [(0x01, B::South), (0x02, B::East), (0x04, B::West), (0x08, B::North)];
    press(report[1], &faces, &mut buttons);
    let shoulders =
        [(0x10, B::LeftShoulder), (0x20, B::RightShoulder), (0x40, B::LeftTrigger), (0x80, B::RightTrigger)];
    press(report[1], &shoulders, &mut buttons);
    let middle = [(0x01, B::Select), (0x02, B::Start), (0x04, B::LeftStick), (0x08, B::RightStick)];
    press(report[2], &middle, &mut buttons);
    press(report[2], &[(0x10, B::Guide), (0x20, B::Misc)], &mut buttons);
    press_hat(report[3], &mut buttons);
    let axis = |at| centred(u16_at(report, at).into(), 0, 0x8000, 0xffff);
    let pull = |button| if buttons.contains(button) { 1.0 } else { 0.0 };
    GamepadState {
        left_stick: [axis(4), 0.0 - axis(6)],
        right_stick: [axis(8), 0.0 - axis(10)],
        left_trigger: pull(B::LeftTrigger),
        right_trigger: pull(B::RightTrigger),
        buttons,
    }
}

/// Bits 5 to 7: charge in five steps; bit 4: charging.
fn battery(status: u8) -> Battery {
    let percent = [5, 25, 50, 75, 100].get(usize::from(status >> 5)).copied();
    let power = if status & 0x10 != 0 { Power::Charging } else { Power::Discharging };
    Battery { percent, power: if percent.is_some() { power } else { Power::Unknown } }
}

/// Mean of the three samples: 4096 counts per g, 14.247 counts per degree/s; the chip's x is the pad's -z.
fn motion(report: &[u8; FULL_LEN]) -> Motion {
    const GYRO: f32 = std::f32::consts::PI / 180.0 / 14.247;
    const ACCEL: f32 = GRAVITY / 4096.0;
    let mean = |offset: usize, scale: f32| {
        let mut sum = [0.0; 3];
        for sample in 0..3 {
            let values = i16x3_at(report, 13 + 12 * sample + offset);
            sum = [0, 1, 2].map(|i| sum[i] + f32::from(values[i]) / 3.0);
        }
        [-sum[1] * scale, sum[2] * scale, -sum[0] * scale]
    };
    Motion { acceleration: mean(0, ACCEL), angular_velocity: mean(6, GYRO) }
}
