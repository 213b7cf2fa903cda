//! No tick allocates, nor does saving, restoring or failing: a counting allocator watches.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::mem::MaybeUninit;

use common::{Body, DT, JOINTS, controller, pack, tick, walking};
use policy_space::*;

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator unchanged; counting touches no memory of its own.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|c| c.set(c.get() + 1));
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(work: impl FnOnce()) -> usize {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1u8; 64]))) > 0);
}

#[test]
fn ticks_saving_and_failing_do_not_allocate() {
    let pack = pack();
    let (mut controller, mut state) = (controller(&pack), ps_state_new(Some(&pack)).unwrap());
    let mut bytes = vec![0u8; ps_state_byte_len(Some(&state))];
    let (mut body, mut command) = (Body::standing(), walking());
    let (mut targets, mut input) = ([0.0; JOINTS], [0.0f32; 225]);
    let mut report = MaybeUninit::uninit();
    let count = allocations(|| {
        for i in 0..100 {
            command.coordinate = if i < 50 { i as f32 / 50.0 } else { 0.5 };
            assert_eq!(tick(&mut controller, &body, &command, &mut targets), PsStatus::Ok);
            assert_eq!(ps_controller_report(Some(&controller), Some(&mut report)), PsStatus::Ok);
            assert_eq!(ps_controller_save(Some(&controller), Some(&mut state)), PsStatus::Ok);
            // SAFETY: all pointers are of slices, with their lengths.
            let status = unsafe {
                [
                    ps_state_to_bytes(Some(&state), bytes.as_mut_ptr(), bytes.len()),
                    ps_state_from_bytes(Some(&mut state), Some(&pack), bytes.as_ptr(), bytes.len()),
                ]
            };
            assert_eq!(status, [PsStatus::Ok; 2]);
            assert_eq!(ps_controller_restore(Some(&mut controller), Some(&state)), PsStatus::Ok);
            let sensed = body.sensed();
            // SAFETY: all pointers are of slices, with their lengths.
            let status = unsafe {
                [
                    ps_controller_prepare(
                        Some(&mut controller),
                        Some(&sensed),
                        Some(&command),
                        DT,
                        input.as_mut_ptr(),
                        input.len(),
                    ),
                    ps_controller_accept(
                        Some(&mut controller),
                        input.as_ptr(),
                        JOINTS,
                        targets.as_mut_ptr(),
                        JOINTS,
                    ),
                ]
            };
            assert_eq!(status, [PsStatus::Ok; 2]);
        }
        body.bodies[3].rotation[1] = f32::NAN;
        assert_eq!(tick(&mut controller, &body, &command, &mut targets), PsStatus::BadNumber);
        assert_eq!(tick(&mut controller, &body, &command, &mut []), PsStatus::WrongCount);
    });
    assert_eq!(count, 0);
}
