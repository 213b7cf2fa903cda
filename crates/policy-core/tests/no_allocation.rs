//! Nothing on the tick allocates: a counting allocator watches whole ticks of every kind.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

use common::{n, p, standing};
use policy_core::{
    Arithmetic, BatchScratch, Bindings, Blend, BlendMode, Button, Buttons, Command, CommandMapper,
    Controller, ControllerConfig, ControllerState, GamepadState, Goal, Heading, evaluate_batch_into,
};

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
fn ticks_of_every_kind_do_not_allocate() {
    let pack = Arc::new(common::pack(2.0));
    let config = ControllerConfig {
        handover_secs: 0.1,
        turn_assist: Some(policy_core::TurnAssist::default()),
        ..ControllerConfig::default()
    };
    let mut controller = Controller::with_config(pack.clone(), config);
    let mut saved = ControllerState::new(&pack);
    let mut bytes = vec![0; saved.byte_len()];
    let mut mapper = CommandMapper::new(&pack, &Bindings::default());
    let mut state = standing();
    let mut pad = GamepadState { left_stick: [0.3, 0.9], ..GamepadState::default() };
    let count = allocations(|| {
        for tick in 0..600 {
            let t = tick as f32 / 600.0;
            (pad.right_trigger, pad.left_trigger) = (t, if tick % 200 > 150 { 1.0 } else { 0.0 });
            pad.buttons = if tick % 120 == 60 { Buttons::NONE.with(Button::East) } else { Buttons::NONE };
            state.bodies[0].position.z = if tick % 200 > 180 { 0.2 } else { 0.9 };
            let mut command = mapper.map(&pad, Heading::FORWARD, &state);
            controller.set_blend_mode(BlendMode::ALL[tick % 3]);
            if tick > 500 {
                command.goal = Goal::Node(n(tick % 7));
            }
            if tick % 50 > 40 {
                command.blend = Some(Blend::between_per_layer(p(0), p(3), [0.2, 0.4, 0.6, 0.0]));
            }
            controller.tick(&state, &command, 1.0 / 30.0);
            controller.save_into(&mut saved);
            saved.write_bytes(&mut bytes);
            saved.read_bytes(&pack, &bytes).unwrap();
            controller.restore(&saved).unwrap();
        }
        state.bodies[3].rotation.x = f32::NAN;
        controller.tick(&state, &Command::default(), 1.0 / 30.0);
    });
    assert_eq!(count, 0);
}

#[test]
fn batches_do_not_allocate() {
    let pack = common::pack(0.0);
    let blends: Vec<Blend> = (0..100).map(|i| Blend::between(p(i % 5), p(i % 5 + 1), 0.5)).collect();
    let (inputs, mut out) = (vec![0.1; 100 * 225], vec![0.0; 100 * 28]);
    let mut scratch = BatchScratch::for_mlp(&pack.policies()[0], 100);
    let count = allocations(|| {
        evaluate_batch_into(pack.policies(), Arithmetic::Fused, &blends, &inputs, &mut scratch, &mut out);
    });
    assert_eq!(count, 0);
}
