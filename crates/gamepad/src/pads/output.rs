//! Rumble and light bar: output reports for the pads that take them.
//!
//! Source of the layouts: Linux `drivers/hid/hid-playstation.c` (`dualshock4_output_report_*`,
//! `dualsense_output_report_*`), `drivers/hid/hid-nintendo.c` (rumble amplitudes); SDL
//! `SDL_hidapi_xboxone.c`, `SDL_hidapi_8bitdo.c`.

use super::sony::{OUTPUT_SEED, crc32};
use super::{Bus, Model};

/// Longest output report that [`OutputEncoder::encode_into`] writes.
pub const MAX_OUTPUT_LEN: usize = 78;

/// Rumble and light of a pad until the next output. Default: no rumble, light off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PadOutput {
    /// Strength of the heavy, slow motor in [0, 1]; clamped, NaN is 0.
    pub low_rumble: f32,
    /// Strength of the light, fast motor in [0, 1]; clamped, NaN is 0.
    pub high_rumble: f32,
    /// Red, green, blue of the light bar.
    pub light: [u8; 3],
}

/// Makes output reports for one pad; keeps their sequence number.
#[derive(Clone, Debug)]
pub struct OutputEncoder {
    model: Model,
    bus: Bus,
    sequence: u8,
    lit: bool,
}

/// Rumble of one side of a Switch Pro at rest: 320 Hz and 160 Hz, no amplitude.
pub(super) const NO_RUMBLE: [u8; 4] = [0x00, 0x01, 0x40, 0x40];

impl OutputEncoder {
    /// An encoder for a pad of this model.
    #[must_use]
    pub fn new(model: Model, bus: Bus) -> Self {
        Self { model, bus, sequence: 0, lit: false }
    }

    /// True for pads with a light bar.
    #[must_use]
    pub fn has_light(&self) -> bool {
        matches!(self.model, Model::DualShock4 | Model::DualShock4Receiver | Model::DualSense)
    }

    /// Writes the next report to `out` and returns its length, id and checksum included.
    pub fn encode_into(&mut self, output: &PadOutput, out: &mut [u8; MAX_OUTPUT_LEN]) -> usize {
        out.fill(0);
        let len = match (self.model, self.bus) {
            (Model::DualShock4, Bus::Bluetooth) => dualshock4_bluetooth(output, out),
            (Model::DualShock4 | Model::DualShock4Receiver, _) => {
                out[0] = 0x05;
                dualshock4_common(output, &mut out[1..]);
                32
            }
            (Model::DualSense, Bus::Bluetooth) => self.dualsense_bluetooth(output, out),
            (Model::DualSense, _) => {
                out[0] = 0x02;
                self.dualsense_common(output, &mut out[1..]);
                63
            }
            (Model::SwitchPro, _) => {
                out[..2].copy_from_slice(&[0x10, self.sequence & 0x0f]);
                let side = switch_rumble(output);
                out[2..6].copy_from_slice(&side);
                out[6..10].copy_from_slice(&side);
                10
            }
            (Model::XboxWireless | Model::XboxSeries, _) => {
                let percent = |strength| (unit(strength) * 100.0).round() as u8;
                let (low, high) = (percent(output.low_rumble), percent(output.high_rumble));
                // Motor mask, two trigger motors, two grip motors, duration, delay, repeats.
                out[..9].copy_from_slice(&[0x03, 0x0f, 0, 0, low, high, 0xff, 0, 0xeb]);
                9
            }
            (Model::EightBitDo | Model::EightBitDoUltimate, _) => {
                out[..3].copy_from_slice(&[0x05, byte(output.low_rumble), byte(output.high_rumble)]);
                5
            }
        };
        self.sequence = self.sequence.wrapping_add(1);
        len
    }

    fn dualsense_bluetooth(&mut self, output: &PadOutput, out: &mut [u8; MAX_OUTPUT_LEN]) -> usize {
        out[..3].copy_from_slice(&[0x31, self.sequence << 4, 0x10]);
        self.dualsense_common(output, &mut out[3..]);
        seal(out);
        MAX_OUTPUT_LEN
    }

    /// Flags select the fields in use: rumble as on a DualShock 4, light bar.
    fn dualsense_common(&mut self, output: &PadOutput, common: &mut [u8]) {
        common[0] = 0x01 | 0x02;
        common[1] = 0x04;
        common[2] = byte(output.high_rumble);
        common[3] = byte(output.low_rumble);
        if !self.lit {
            // Once: end the animation after connecting.
            common[38] = 0x02;
            common[41] = 0x02;
            self.lit = true;
        }
        common[44..47].copy_from_slice(&output.light);
    }
}

fn dualshock4_bluetooth(output: &PadOutput, out: &mut [u8; MAX_OUTPUT_LEN]) -> usize {
    const HID: u8 = 0x80;
    const CHECKSUM: u8 = 0x40;
    const POLL_MILLISECONDS: u8 = 4;
    out[..2].copy_from_slice(&[0x11, HID | CHECKSUM | POLL_MILLISECONDS]);
    dualshock4_common(output, &mut out[3..]);
    seal(out);
    MAX_OUTPUT_LEN
}

fn dualshock4_common(output: &PadOutput, common: &mut [u8]) {
    common[0] = 0x01 | 0x02;
    common[3] = byte(output.high_rumble);
    common[4] = byte(output.low_rumble);
    common[5..8].copy_from_slice(&output.light);
}

/// Writes the CRC32 to the end.
fn seal(out: &mut [u8; MAX_OUTPUT_LEN]) {
    let (bytes, tail) = out.split_at_mut(MAX_OUTPUT_LEN - 4);
    tail.copy_from_slice(&crc32(OUTPUT_SEED, bytes).to_le_bytes());
}

fn unit(strength: f32) -> f32 {
    if strength.is_nan() { 0.0 } else { strength.clamp(0.0, 1.0) }
}

fn byte(strength: f32) -> u8 {
    (unit(strength) * 255.0).round() as u8
}

/// Both bands of one side: 320 Hz for the light motor, 160 Hz for the heavy one.
fn switch_rumble(output: &PadOutput) -> [u8; 4] {
    let (high, low) = (amplitude(output.high_rumble), amplitude(output.low_rumble));
    let odd = if low % 2 == 1 { 0x80 } else { 0 };
    [NO_RUMBLE[0], NO_RUMBLE[1] + 2 * high, NO_RUMBLE[2] | odd, NO_RUMBLE[3] + low / 2]
}

/// Step 0 to 100 on the pad's scale, which is logarithmic in three pieces. `hid-nintendo.c` lists the values.
fn amplitude(strength: f32) -> u8 {
    let strength = unit(strength);
    let step = if strength < 0.005 {
        0.0
    } else if strength < 0.114 {
        1.0 + 4.0 * (strength * 100.0).log2()
    } else if strength < 0.227 {
        16.0 * (17.0 * strength).log2()
    } else {
        32.0 * (8.7 * strength).log2()
    };
    step.round().clamp(0.0, 100.0) as u8
}

#[cfg(test)]
mod tests {
    use super::amplitude;

    /// Steps and thousandths (of 1003) from the kernel's table.
    #[test]
    fn the_amplitude_scale_is_the_kernels() {
        let table = [(0, 0), (1, 10), (2, 12), (7, 28), (15, 112), (16, 117), (24, 166), (31, 225)];
        let upper = [(32, 230), (48, 325), (64, 460), (80, 650), (99, 981), (100, 1003)];
        for (step, thousandths) in table.into_iter().chain(upper) {
            let found = amplitude(thousandths as f32 / 1003.0);
            assert!(found.abs_diff(step) <= 1, "{thousandths}: step {step}, found {found}");
        }
    }
}
