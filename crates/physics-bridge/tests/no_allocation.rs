//! A tick allocates nothing. Alone in its process, because the allocator belongs to all of it.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use common::{humanoid, wriggle};
use glam::Vec3;
use physics_bridge::{BodyPoses, Character, HISTORY_SECS, Terrain};
use policy_core::{Body, CharacterState};

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is handed on to the system's allocator; the counter allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promises are handed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are handed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(work: impl FnOnce()) -> u64 {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![0u8; 100]))) > 0);
}

#[test]
fn a_tick_allocates_nothing() {
    let terrain = Terrain::Steps { rise_m: 0.1, run_m: 0.5, count: 4 };
    for model in [humanoid(), humanoid().with_terrain(terrain).unwrap()] {
        let mut character = Character::new(&model);
        character.record_history(HISTORY_SECS);
        let (mut state, mut poses, mut saved) =
            (CharacterState::default(), BodyPoses::default(), character.save());
        let count = allocations(|| {
            for tick in 0..100 {
                character.sense_into(&mut state);
                character.actuate(&wriggle(tick));
                if tick % 10 == 0 {
                    character.push(Body::Torso, Vec3::X * 50.0, 0.1).unwrap();
                }
                character.step().unwrap();
                character.poses_into(&mut poses);
                character.save_into(&mut saved);
                std::hint::black_box((character.contacts(), character.clearance()));
            }
            character.rewind_to(50).unwrap();
            character.restore(&saved).unwrap();
        });
        assert_eq!(count, 0);
    }
}
