//! 8BitDo pads in their own HID modes: reports 0x01, 0x03, 0x04, and the old one of nine bytes without an id.
//!
//! Source of the layouts: SDL `src/joystick/hidapi/SDL_hidapi_8bitdo.c`; which face button is where: the
//! positional entries of SDL's game controller database. In their other modes these pads identify as Switch Pro or
//! Xbox pads.

use super::bytes::{GRAVITY, centred, i16x3_at, prefix, press, press_hat, trigger_u8};
use crate::{Battery, Button, Buttons, GamepadState, Motion, PadInput, Power, ReportError, Update};

const OLD_LEN: usize = 9;
const PLAIN_LEN: usize = 10;
const FULL_LEN: usize = 34;

/// Parser of one 8BitDo pad.
#[derive(Clone, Debug)]
pub struct EightBitDo {
    faces: [(u8, Button); 4],
}

impl EightBitDo {
    /// `a_is_east`: the face buttons are where Nintendo has them (SN30, SF30, Pro 2), not where Xbox has them.
    #[must_use]
    pub fn new(a_is_east: bool) -> Self {
        use Button::{East, North, South, West};
        let [a, b, x, y] = if a_is_east { [East, South, North, West] } else { [South, East, West, North] };
        Self { faces: [(0x01, a), (0x02, b), (0x08, x), (0x10, y)] }
    }

    /// Reads one report.
    ///
    /// # Errors
    /// [`ReportError`] for short and unknown reports; `input` is unchanged.
    pub fn parse_into(&self, report: &[u8], input: &mut PadInput) -> Result<Update, ReportError> {
        if let Ok(report) = <&[u8; OLD_LEN]>::try_from(report) {
            *input = PadInput { raw: self.old(report), ..PadInput::default() };
            return Ok(Update::Controls);
        }
        match *report.first().ok_or(ReportError::Empty)? {
            0x01 | 0x03 | 0x04 => {
                let mut found = PadInput { raw: self.plain(prefix(report)?), ..PadInput::default() };
                if let Some(&extra) = report.get(PLAIN_LEN) {
                    // The paddles L4 and R4; one of the pad's own buttons is enough for a game.
                    found.raw.buttons.set(Button::Misc, extra & 0x03 != 0);
                }
                if let Ok(report) = prefix::<FULL_LEN>(report) {
                    found.battery = Some(battery(report[14]));
                    found.motion = Some(motion(report));
                }
                *input = found;
                Ok(Update::Controls)
            }
            report_id => Err(ReportError::UnknownReport { report_id }),
        }
    }

    fn buttons(&self, first: u8, second: u8, hat: u8) -> Buttons {
        let mut buttons = Buttons::NONE;
        press_hat(hat, &mut buttons);
        press(first, &self.faces, &mut buttons);
        press(first, &[(0x40, Button::LeftShoulder), (0x80, Button::RightShoulder)], &mut buttons);
        let others = [
            (0x01, Button::LeftTrigger),
            (0x02, Button::RightTrigger),
            (0x04, Button::Select),
            (0x08, Button::Start),
            (0x10, Button::Guide),
            (0x20, Button::LeftStick),
            (0x40, Button::RightStick),
        ];
        press(second, &others, &mut buttons);
        buttons
    }

    /// Buttons, hat, sticks; the triggers are switches.
    fn old(&self, report: &[u8; OLD_LEN]) -> GamepadState {
        let pull = |bit| if report[1] & bit != 0 { 1.0 } else { 0.0 };
        GamepadState {
            left_stick: stick(report[3], report[4]),
            right_stick: stick(report[5], report[6]),
            left_trigger: pull(0x01),
            right_trigger: pull(0x02),
            buttons: self.buttons(report[0], report[1], report[2]),
        }
    }

    /// Id, hat, sticks, right trigger, left trigger, buttons.
    fn plain(&self, report: &[u8; PLAIN_LEN]) -> GamepadState {
        GamepadState {
            left_stick: stick(report[2], report[3]),
            right_stick: stick(report[4], report[5]),
            left_trigger: trigger_u8(report[7]),
            right_trigger: trigger_u8(report[6]),
            buttons: self.buttons(report[8], report[9], report[1]),
        }
    }
}

/// Two bytes with centre 127, y down.
fn stick(x: u8, y: u8) -> [f32; 2] {
    [centred(x.into(), 0, 127, 255), 0.0 - centred(y.into(), 0, 127, 255)]
}

/// Seven bits of percent; the top bit: charging.
fn battery(status: u8) -> Battery {
    let percent = (status & 0x7f).min(100);
    let power = match (percent, status & 0x80 != 0) {
        (100, _) => Power::Full,
        (_, true) => Power::Charging,
        (_, false) => Power::Discharging,
    };
    Battery { percent: Some(percent), power }
}

/// Accelerometer of 4096 counts per g, gyroscope of 2000 degrees/s full scale; the chip's x is the pad's -z.
fn motion(report: &[u8; FULL_LEN]) -> Motion {
    const GYRO: f32 = 2000.0 / 32767.0 * std::f32::consts::PI / 180.0;
    const ACCEL: f32 = GRAVITY / 4096.0;
    let turned = |at, scale| {
        let [x, y, z] = i16x3_at(report, at).map(f32::from);
        [-y * scale, z * scale, -x * scale]
    };
    Motion { acceleration: turned(15, ACCEL), angular_velocity: turned(21, GYRO) }
}
