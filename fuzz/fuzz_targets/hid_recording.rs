//! A recording made of anything; and one with sound checksums around reports made of anything, played as a pad.
#![no_main]

mod hid_checks;

use gamepad::calibration::Calibration;
use gamepad::recording::{PadEvent, RecordedPad, Recorder, Recording, VirtualPad};
use gamepad::{Bus, PadId};
use libfuzzer_sys::fuzz_target;

const PADS: [(u16, u16); 8] = [
    (0x054c, 0x05c4),
    (0x054c, 0x0ce6),
    (0x057e, 0x2009),
    (0x045e, 0x02e0),
    (0x045e, 0x0b13),
    (0x2dc8, 0x6001),
    (0x2dc8, 0x6012),
    (0x1234, 0x5678),
];

fuzz_target!(|bytes: &[u8]| {
    if let Ok(recording) = Recording::from_bytes(bytes.to_vec()) {
        play(recording);
    }
    let Some((&first, rest)) = bytes.split_first() else { return };
    let (vendor, product) = PADS[usize::from(first % 8)];
    let bus = [Bus::Usb, Bus::Bluetooth][usize::from(first >> 3 & 1)];
    let (descriptor, mut rest) = rest.split_at(rest.len().min(if first % 8 == 7 { 200 } else { 0 }));
    let pad = RecordedPad {
        id: PadId { vendor, product, bus },
        name: String::new(),
        descriptor: Some(descriptor.to_vec()),
    };
    let mut recorder = Recorder::new(Vec::new(), &pad).expect("memory takes everything");
    let mut time_secs = 0.0;
    while let Some(([len, wait, kind], after)) = rest.split_first_chunk() {
        let (report, after) = after.split_at(after.len().min(usize::from(*len)));
        time_secs += f64::from(*wait) * 0.002;
        let event = match kind % 16 {
            0 => PadEvent::Disconnected,
            1 => PadEvent::Feature(report),
            2 => PadEvent::Calibration(Calibration::default()),
            _ => PadEvent::Report(report),
        };
        recorder.record(time_secs, event).expect("memory takes everything");
        rest = after;
    }
    let written = recorder.finish().expect("memory takes everything");
    play(Recording::from_bytes(written).expect("what was written can be read"));
});

fn play(recording: Recording) {
    let duration = recording.duration();
    let Ok(mut pad) = VirtualPad::new(recording) else { return };
    for step in 0..=20 {
        hid_checks::check_state(&pad.report_at(duration * f64::from(step) / 20.0).state);
    }
    hid_checks::check_state(&pad.report_at(duration).state);
    assert!(pad.is_over());
}
