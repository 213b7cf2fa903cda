//! Sensing, actuating and what is written before a step allocate nothing. What Rapier allocates is not counted: its own
//! step, and its list of modified bodies, which starts empty in every step. One test, alone in its process, because the allocator belongs to all of it.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use common::{crane, humanoid};
use physics_rapier::rapier3d::prelude::*;
use physics_rapier::{Articulation, Drive, Pose, Sets};
use policy_core::{CharacterState, JointTargets};

struct Counting;

static COUNT: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is handed on to the system's allocator; the counter allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
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
    let before = COUNT.load(Ordering::Relaxed);
    work();
    COUNT.load(Ordering::Relaxed) - before
}

#[test]
fn a_tick_allocates_nothing_but_rapiers_step() {
    assert!(allocations(|| drop(std::hint::black_box(vec![0u8; 100]))) > 0, "the counter counts");
    for (model, drive) in
        [(humanoid(), Drive::Torques), (humanoid(), Drive::Motors), (crane(), Drive::Torques)]
    {
        let mut world = PhysicsWorld { gravity: Vector::new(0.0, 0.0, -9.81), ..PhysicsWorld::new() };
        let groups = InteractionGroups::all();
        let mut character = Articulation::insert(&model, &mut Sets::from(&mut world), drive, groups);
        let (mut state, mut pose) = (CharacterState::new(model.skeleton()), Pose::new(model.skeleton()));
        let targets = JointTargets::new(model.skeleton());
        let bodies: Vec<RigidBodyHandle> = world.bodies.iter().map(|(handle, _)| handle).collect();
        for tick in 0..20 {
            bodies.iter().for_each(|&body| assert!(world.bodies.get_mut(body).is_some()));
            let count = allocations(|| {
                character.sense_into(&world.bodies, &world.multibody_joints, 0.0, &mut state).unwrap();
                character.pose_into(&world.bodies, &world.multibody_joints, &mut pose).unwrap();
                character.actuate(&targets);
                character.before_step(&mut world.bodies, &mut world.multibody_joints).unwrap();
            });
            assert_eq!(count, 0, "in tick {tick}");
            world.step();
        }
    }
}
