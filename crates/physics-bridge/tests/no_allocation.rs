//! A tick allocates nothing. One test, alone in its process, because the allocator belongs to all of it.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use common::{body, humanoid, made_up_pack, quadruped, wriggle_into};
use glam::Vec3;
use physics_bridge::{
    BodyPoses, Character, Crowd, Fixture, HISTORY_SECS, Motion, Movable, Prop, Solid, Terrain, World,
};
use policy_core::{BodyId, CharacterState, Command, Controller, Goal, Heading, JointTargets, NodeId};

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
fn ticks_allocate_nothing() {
    assert!(allocations(|| drop(std::hint::black_box(vec![0u8; 100]))) > 0, "the counter counts");
    a_character_allocates_nothing();
    // Before any crowd: the threads of one that was dropped may still be ending.
    a_world_allocates_nothing();
    control_ticks_allocate_nothing();
    a_crowd_allocates_no_more_with_more_characters();
}

/// The first tick of a crowd makes room for its batches; the thread pool takes a block now and then.
fn control_ticks_allocate_nothing() {
    const TICKS: u64 = 64;
    let model = quadruped();
    let pack = Arc::new(made_up_pack(model.skeleton(), None, model.actuation()));
    let (mut character, mut controller) = (Character::new(&model), Controller::new(pack.clone()));
    let command = Command { goal: Goal::Node(NodeId::new(2)), ..Command::default() };
    let count = allocations(|| {
        (0..TICKS).for_each(|_| character.control_tick(&mut controller, &command, 1.0 / 30.0).unwrap());
    });
    assert_eq!(count, 0);
    let characters = (0..50).map(|_| Character::new(&model)).collect();
    let mut crowd = Crowd::new(characters, NonZeroUsize::new(2)).unwrap();
    let (mut controllers, commands) = (vec![Controller::new(pack); 50], [command; 50]);
    let mut run = |ticks: u64| {
        (0..ticks).for_each(|_| assert_eq!(crowd.control_tick(&mut controllers, &commands, 1.0 / 30.0), 0));
    };
    run(4);
    let found = allocations(|| run(TICKS));
    assert!(found <= TICKS / 8, "{found} allocations in {TICKS} ticks of a crowd");
}

fn a_character_allocates_nothing() {
    let terrain = Terrain::Steps { rise_m: 0.1, run_m: 0.5, count: 4 };
    for model in [humanoid(), humanoid().with_terrain(terrain).unwrap(), quadruped()] {
        let mut character = Character::new(&model);
        character.record_history(HISTORY_SECS);
        let (mut state, mut poses, mut saved) =
            (CharacterState::new(model.skeleton()), BodyPoses::new(model.skeleton()), character.save());
        let (mut pose, mut targets) = (character.pose(), JointTargets::new(model.skeleton()));
        let pushed = body(&model, model.skeleton().bodies()[1].name.as_str());
        let count = allocations(|| {
            for tick in 0..100 {
                character.sense_into(&mut state);
                wriggle_into(tick, &mut targets);
                character.actuate(&targets);
                if tick % 10 == 0 {
                    character.push(pushed, Vec3::X * 50.0, 0.1).unwrap();
                }
                character.step().unwrap();
                character.poses_into(&mut poses);
                character.pose_into(&mut pose);
                character.save_into(&mut saved);
                std::hint::black_box((character.contacts(), character.clearance()));
            }
            character.rewind_to(50).unwrap();
            character.restore(&saved).unwrap();
        });
        assert_eq!(count, 0);
    }
}

/// The thread pool takes a block for its queue every few dozen ticks; nothing goes with the characters.
fn a_crowd_allocates_no_more_with_more_characters() {
    const TICKS: u64 = 128;
    let model = humanoid();
    for count in [1, 16] {
        let characters = (0..count).map(|_| Character::new(&model)).collect();
        let mut crowd = Crowd::new(characters, NonZeroUsize::new(2)).unwrap();
        let mut ticks = vec![0; count];
        let mut run = |times: u64| {
            for _ in 0..times {
                crowd.tick_with(&mut ticks, |_, tick, _, targets| {
                    wriggle_into(*tick, targets);
                    *tick += 1;
                });
            }
        };
        run(4); // the threads have started
        let found = allocations(|| run(TICKS));
        assert!(found <= TICKS / 16, "{found} allocations in {TICKS} ticks of {count} characters");
    }
}

/// Also when something diverges, and when a reserved ball is thrown by an impulse.
fn a_world_allocates_nothing() {
    let model = quadruped();
    let pack = Arc::new(made_up_pack(model.skeleton(), None, model.actuation()));
    let mut world = World::new(&model).unwrap();
    let (character, other, crate_, balls) = world
        .edit(|edit| {
            let place = |x: f32| Motion::at(Vec3::new(x, 3.0, 1.0));
            let character = edit.add_character(&model, 0.0, 0.0, Heading::FORWARD, 0.0)?;
            let other = edit.add_character(&model, 2.0, 0.0, Heading::FORWARD, 0.0)?;
            let crate_ = edit.add_prop(Prop::cube(0.4, 5.0), place(1.0))?;
            let balls = (0..4).map(|i| edit.add_prop(Prop::ball(0.1, 1.0), place(i as f32 + 5.0)));
            let balls = balls.collect::<Result<Vec<_>, _>>()?;
            let half_extents = Vec3::new(2.0, 2.0, 0.1);
            edit.add_fixture(Fixture::new(Solid::Cuboid { half_extents }, Vec3::new(2.0, 0.0, 0.0)))?;
            Ok((character, other, crate_, balls))
        })
        .unwrap();
    world.record_history(HISTORY_SECS);
    let command = Command { goal: Goal::Node(NodeId::new(2)), ..Command::default() };
    let mut players = [character, other].map(|handle| (handle, Controller::new(pack.clone()), command));
    let mut saved = world.save();
    let (mut state, mut poses) = (CharacterState::new(model.skeleton()), BodyPoses::new(model.skeleton()));
    world.control_tick(&mut players, 1.0 / 30.0);
    let mut diverged = 0;
    let count = allocations(|| {
        for tick in 0..60 {
            diverged += world.control_tick(&mut players, 1.0 / 30.0);
            world.sense_into(character, &mut state).unwrap();
            world.poses_into(character, &mut poses).unwrap();
            world.push(Movable::Body(other, BodyId::new(1)), Vec3::X * 30.0, 0.1).unwrap();
            world.ray(Vec3::Z * 3.0, Vec3::X, 10.0, None).unwrap();
            if tick % 20 == 5 {
                // Faster than anything can be: it is taken out.
                world.impulse(balls[tick / 20], Vec3::X * 1e5).unwrap();
            }
            let grab = world.grab(crate_, Vec3::new(1.0, 3.0, 1.0), 100.0).unwrap();
            world.move_grab(grab, Vec3::new(1.0, 3.0, 2.0)).unwrap();
            world.release(grab).unwrap();
            world.save_into(&mut saved);
        }
        world.rewind_to(30).unwrap();
        world.restore(&saved).unwrap();
    });
    assert_eq!((count, diverged), (0, 3));
}
