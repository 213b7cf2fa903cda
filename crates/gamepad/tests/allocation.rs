//! Nothing on the tick allocates: states of scripts and recordings, reports of every kind of pad.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

use gamepad::device::{DeviceEvent, DeviceInfo, DeviceKey, Source};
use gamepad::recording::{PadEvent, RecordedPad, Recorder, Recording, VirtualPad};
use gamepad::{Bus, Gamepads, PadId, PadSession, Script};

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is forwarded to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    // SAFETY: the caller keeps the contract of `GlobalAlloc::alloc`.
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }
    // SAFETY: the caller keeps the contract of `GlobalAlloc::dealloc`.
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn allocations(act: impl FnOnce()) -> u64 {
    let before = ALLOCATIONS.get();
    act();
    ALLOCATIONS.get() - before
}

const DUALSENSE: PadId = PadId { vendor: 0x054c, product: 0x0ce6, bus: Bus::Usb };

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(black_box(Box::new(1)))), 1);
}

#[test]
fn scripts_and_recordings() {
    let script =
        Script::from_ron("(entries: [(at: 1, ramp: 2, left_stick: (1.0, 0.0), tap: [East])])").unwrap();
    let counted = allocations(|| {
        for tick in 0..100 {
            black_box(script.state_at(f64::from(tick) / 30.0));
        }
    });
    assert_eq!(counted, 0);
    let pad = RecordedPad { id: DUALSENSE, name: String::new(), descriptor: Some(Vec::new()) };
    let mut recorder = Recorder::new(Vec::new(), &pad).unwrap();
    for step in 0..300 {
        recorder.record(f64::from(step) * 0.004, PadEvent::Report(&[0x01; 64])).unwrap();
    }
    let mut pad = VirtualPad::new(Recording::from_bytes(recorder.finish().unwrap()).unwrap()).unwrap();
    let counted = allocations(|| {
        for tick in 0..60 {
            black_box(pad.report_at(f64::from(tick) / 30.0));
        }
    });
    assert_eq!(counted, 0);
}

#[test]
fn reports_of_every_kind_of_pad() {
    // A game pad with two axes of one byte and eight buttons.
    let generic = [
        0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x09, 0x30, 0x09, 0x31, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08,
        0x95, 0x02, 0x81, 0x02, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81,
        0x02, 0xc0,
    ];
    for (vendor, product) in
        [(0x054c, 0x05c4), (0x054c, 0x0ce6), (0x057e, 0x2009), (0x045e, 0x0b13), (0x2dc8, 0x6001), (1, 1)]
    {
        for bus in [Bus::Usb, Bus::Bluetooth] {
            let mut session = PadSession::new(PadId { vendor, product, bus }, &generic).unwrap();
            let counted = allocations(|| {
                for id in 0..=255u8 {
                    let time_secs = f64::from(id) * 0.01;
                    let mut report = [0x80; 78];
                    report[0] = id;
                    let _ = session.accept(&report, time_secs);
                    let _ = session.accept(&report[..7], time_secs);
                    black_box(session.report_at(time_secs));
                }
            });
            assert_eq!(counted, 0, "{vendor:04x}:{product:04x}");
        }
    }
}

#[test]
fn several_pads_with_serial_numbers() {
    let mut gamepads = Gamepads::new(Vec::new());
    for key in 1..4 {
        let device = DeviceInfo {
            key: DeviceKey(key),
            name: String::new(),
            id: DUALSENSE,
            serial: Some(format!("00:11:22:33:44:{key:02x}")),
            path: String::new(),
            source: Source::Hid,
        };
        gamepads.apply(0.0, DeviceEvent::Connected { device, descriptor: Some(Vec::new()) });
    }
    let mut report = [0x80; 64];
    report[0] = 0x01;
    for step in 0..100 {
        // The event itself was allocated by the thread that read it.
        let event = DeviceEvent::Report(DeviceKey(1 + step % 3), Box::new(report));
        let counted = allocations(|| {
            gamepads.apply(step as f64 * 0.004, event);
            black_box(gamepads.report());
        });
        assert_eq!(counted, 0);
    }
}
