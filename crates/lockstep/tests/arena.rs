//! The same pads give the same state: again, after a restore, and in the order in which rollback asks for it.
#![allow(missing_docs, reason = "tests")]

use lockstep::{
    Arena, ArenaConfig, ArenaError, ArenaScene, LooseKind, PUT_BUTTON, Pad, SCRIPT_TICKS, SHOVE_BUTTON, Seen,
    THROW_BUTTON, script_pad,
};
use replay::{Playback, Recorder, Replay};

const PACK: &[u8] = include_bytes!("../../../assets/humanoid.pack.safetensors");

fn arena(players: usize) -> Arena {
    Arena::new(PACK, ArenaConfig { players, ..ArenaConfig::default() }).unwrap()
}

fn pads(tick: u32, players: usize) -> Vec<Pad> {
    (0..players).map(|player| script_pad(tick, player)).collect()
}

#[test]
fn the_script_runs_and_starts_a_roll() {
    let (mut arena, mut seen) = (arena(1), Seen::default());
    for tick in 0..SCRIPT_TICKS {
        arena.tick(&pads(tick, 1)).unwrap();
        seen.look(&arena);
    }
    assert!(seen.rolled && seen.top_speed_mps > 0.5, "{seen:?}");
}

#[test]
fn a_character_that_is_shoved_until_it_lies_gets_up() {
    let (mut arena, mut seen) = (arena(1), Seen::default());
    for tick in 0..900 {
        let pad = if seen.fell { Pad::default() } else { tapping(tick, SHOVE_BUTTON, 0.0) };
        arena.tick(&[pad]).unwrap();
        seen.look(&arena);
        if seen.got_up {
            return;
        }
    }
    panic!("{seen:?}");
}

#[test]
fn the_same_pads_give_the_same_hashes_and_other_pads_others() {
    let mut arenas = [arena(2), arena(2), arena(2)];
    for tick in 0..60 {
        let same = pads(tick, 2);
        let mut other = same.clone();
        if tick == 40 {
            other[1].left_stick[0] ^= 1;
        }
        let [a, b, c] = &mut arenas;
        a.tick(&same).unwrap();
        b.tick(&same).unwrap();
        c.tick(&other).unwrap();
        assert_eq!(a.hash(), b.hash(), "tick {tick}");
        assert_eq!(a.hash() == c.hash(), tick < 40, "tick {tick}: one step of a stick is seen at once");
    }
}

#[test]
fn a_restored_arena_continues_bit_for_bit() {
    let mut arena = arena(2);
    // In the middle of the fall, with contacts and a skill under way.
    for tick in 0..350 {
        arena.tick(&pads(tick, 2)).unwrap();
    }
    let (saved, at) = (arena.save(), arena.hash());
    let run = |arena: &mut Arena| -> Vec<u64> {
        (350..400)
            .map(|tick| {
                arena.tick(&pads(tick, 2)).unwrap();
                arena.hash()
            })
            .collect()
    };
    let first = run(&mut arena);
    arena.restore(&saved).unwrap();
    assert_eq!(arena.hash(), at);
    assert_eq!(run(&mut arena), first);
    assert_eq!(saved.tick_count(), 350);
}

#[test]
fn saving_and_restoring_every_tick_changes_nothing() {
    let (mut plain, mut restored) = (arena(2), arena(2));
    for tick in 0..120 {
        let pads = pads(tick, 2);
        plain.tick(&pads).unwrap();
        // A guess that was wrong, taken back.
        let before = restored.save();
        restored.tick(&[Pad { left_stick: [-90, 20], ..pads[0] }, pads[1]]).unwrap();
        restored.restore(&before).unwrap();
        restored.tick(&pads).unwrap();
        assert_eq!(plain.hash(), restored.hash(), "tick {tick}");
    }
}

#[test]
fn a_recorded_run_is_played_again_and_a_change_is_found() {
    let mut arena = arena(2);
    let mut recorder = Recorder::new(arena.header()).unwrap();
    for tick in 0..90 {
        let pads = pads(tick, 2);
        arena.tick(&pads).unwrap();
        recorder.push(&pads, arena.hash()).unwrap();
    }
    let replay = Replay::from_bytes(&recorder.finish().to_bytes()).unwrap();
    let play = |disturbed: Option<u32>| -> Result<u32, replay::Mismatch> {
        let mut arena = self::arena(2);
        arena.header().expect(replay.header()).unwrap();
        let mut playback = Playback::new(&replay);
        while let Some(pads) = playback.next_pads() {
            let mut pads = pads.to_vec();
            if disturbed == Some(playback.tick()) {
                pads[0].triggers[1] ^= 64;
            }
            arena.tick(&pads).unwrap();
            playback.check(arena.hash())?;
        }
        Ok(playback.tick())
    };
    assert_eq!(play(None), Ok(90));
    let mismatch = play(Some(35)).unwrap_err();
    assert_eq!((mismatch.tick, mismatch.equal), (60, 30));
}

#[test]
fn wrong_numbers_are_refused() {
    let config = ArenaConfig::default();
    let made = |config| Arena::new(PACK, config).map(|_| ()).unwrap_err().to_string();
    assert_eq!(made(ArenaConfig { players: 0, ..config }), "expected 1 to 8 players, found 0");
    assert_eq!(made(ArenaConfig { players: 9, ..config }), "expected 1 to 8 players, found 9");
    assert_eq!(
        made(ArenaConfig { scene: ArenaScene::Flat { crates: 65 }, ..config }),
        "expected at most 64 crates, found 65"
    );
    assert!(matches!(Arena::new(b"no pack", config), Err(ArenaError::Pack(_))));
    let mut two = arena(2);
    assert!(matches!(two.tick(&[Pad::default()]), Err(ArenaError::Pads { expected: 2, found: 1 })));
    assert!(matches!(two.restore(&arena(1).save()), Err(ArenaError::State)));
}

fn playground(players: usize) -> Arena {
    Arena::new(PACK, ArenaConfig { players, scene: ArenaScene::Playground, seed: 3 }).unwrap()
}

#[test]
fn in_the_playground_the_others_wander_and_the_pendulum_keeps_its_height() {
    let mut arena = playground(1);
    assert!(arena.character_count() >= 4, "{}", arena.character_count());
    let index = arena.layout().props.iter().position(|prop| prop.swing_m.is_some()).expect("a pendulum");
    let swing = arena.layout().props[index].swing_m.unwrap();
    let (mut ways, mut heights) = (vec![0.0; arena.character_count()], Vec::new());
    for tick in 0..450 {
        arena.tick(&[Pad::default()]).unwrap();
        for (index, way) in ways.iter_mut().enumerate() {
            let velocity = arena.player(index).unwrap().state.root().linear_velocity;
            *way += velocity.truncate().length() * arena.tick_secs();
        }
        if tick > 300 {
            heights.push(arena.props().nth(index).unwrap().motion.position.z);
        }
    }
    assert!(ways[1..].iter().filter(|way| **way > 2.0).count() >= 2, "{ways:?}");
    let span = |heights: &[f32]| {
        heights.iter().fold(f32::MIN, |a, b| a.max(*b)) - heights.iter().fold(f32::MAX, |a, b| a.min(*b))
    };
    assert!(span(&heights) > 0.6 * swing, "it swings by {} of {swing} m", span(&heights));
}

#[test]
fn the_playground_goes_back_to_what_was_saved() {
    let mut arena = playground(2);
    let pads = |tick: u32| [script_pad(tick, 0), script_pad(tick, 1)];
    (0..60).for_each(|tick| arena.tick(&pads(tick)).unwrap());
    let saved = arena.save();
    let run = |arena: &mut Arena| {
        (60..120).for_each(|tick| arena.tick(&pads(tick)).unwrap());
        arena.hash()
    };
    let expected = run(&mut arena);
    arena.restore(&saved).unwrap();
    assert_eq!(run(&mut arena), expected);
    assert!(playground(1).restore(&saved).is_err(), "of two players");
}

#[test]
fn a_header_names_the_scene_and_another_is_refused() {
    for scene in [ArenaScene::Flat { crates: 7 }, ArenaScene::Playground] {
        let config = ArenaConfig { players: 2, scene, seed: 5 };
        let header = Arena::new(PACK, config).unwrap().header();
        header.check().unwrap();
        assert_eq!(ArenaConfig::of(&header).unwrap(), config);
    }
    let mut header = playground(1).header();
    header.scene = "playground/0123456789abcdef".into();
    let said = ArenaConfig::of(&header).unwrap_err().to_string();
    assert!(said.contains("playground of this version, found \"playground/0123"), "{said}");
    let full = ArenaConfig { players: 8, scene: ArenaScene::Playground, seed: 1 };
    let most = playground(1).layout().starts.len();
    let expected = format!("expected 1 to {most} players, found 8");
    assert_eq!(Arena::new(PACK, full).unwrap_err().to_string(), expected);
}

#[test]
fn the_first_checkpoint_starts_the_clock() {
    let mut arena = playground(1);
    let first = arena.layout().checkpoints[0];
    let start = arena.layout().starts[0].at;
    let towards = policy_core::Heading::from_direction(first.at - start);
    let pad =
        Pad::from_state(&policy_core::GamepadState { left_stick: [0.0, 1.0], ..Default::default() }, towards);
    for _ in 0..300 {
        arena.tick(&[pad]).unwrap();
        if arena.race(0).unwrap().state() == playground::RaceState::Running {
            return;
        }
    }
    panic!("{:?} at {}", arena.race(0), arena.player(0).unwrap().state.root().position);
}

/// A pad that presses a button in one tick of four: it goes down anew each time.
fn tapping(tick: u32, button: policy_core::Button, heading: f32) -> Pad {
    let mut state = policy_core::GamepadState::default();
    state.buttons.set(button, tick.is_multiple_of(4));
    Pad::from_state(&state, policy_core::Heading::from_angle(heading))
}

#[test]
fn a_ball_is_thrown_once_a_press_and_flies_where_the_camera_looks() {
    let mut arena = arena(1);
    let props = arena.props().count();
    let held = tapping(0, THROW_BUTTON, 1.0);
    (0..10).for_each(|_| arena.tick(&[held]).unwrap());
    assert_eq!(arena.props().count(), props + 1, "one for one press");
    let ball = arena.props().last().unwrap().motion;
    let from = arena.player(0).unwrap().state.root().position;
    let way = (ball.position - from).truncate();
    assert!(
        way.length() > 2.0 && way.normalize().dot(policy_core::glam::Vec2::from_angle(1.0)) > 0.98,
        "{way}"
    );
    assert_eq!(arena.left(LooseKind::Ball), LooseKind::Ball.most() - 1);
}

#[test]
fn what_is_put_down_comes_in_turn_and_ends() {
    let mut arena = arena(1);
    let props = arena.props().count();
    for tick in 0..4 * 20 {
        arena.tick(&[tapping(tick, PUT_BUTTON, tick as f32)]).unwrap();
    }
    assert_eq!(arena.props().count(), props + 16, "4 of each kind");
    assert!(LooseKind::PUT.iter().all(|kind| arena.left(*kind) == 0));
    let paints: Vec<_> = arena.props().skip(props).take(5).map(|prop| prop.paint).collect();
    let expected: Vec<_> = (0..5).map(|index| LooseKind::PUT[index % 4].prop().1).collect();
    assert_eq!(paints, expected);
}

#[test]
fn throws_are_saved_taken_back_and_hashed() {
    let mut arena = playground(2);
    let pads = |tick: u32| {
        let throws = if tick.is_multiple_of(3) { THROW_BUTTON } else { PUT_BUTTON };
        [tapping(tick, throws, 0.3), tapping(tick + 2, PUT_BUTTON, 2.0)]
    };
    (0..20).for_each(|tick| arena.tick(&pads(tick)).unwrap());
    let (saved, at, props) = (arena.save(), arena.hash(), arena.props().count());
    let run = |arena: &mut Arena| -> Vec<u64> {
        let tick = |tick| {
            arena.tick(&pads(tick)).unwrap();
            arena.hash()
        };
        (20..60).map(tick).collect()
    };
    let first = run(&mut arena);
    assert!(arena.props().count() > props + 5, "more were thrown");
    arena.restore(&saved).unwrap();
    assert_eq!((arena.hash(), arena.props().count()), (at, props));
    assert_eq!(run(&mut arena), first);
    let mut other = playground(2);
    (0..20).for_each(|tick| other.tick(&pads(tick)).unwrap());
    assert_eq!(other.hash(), at);
    other.tick(&[Pad::default(), Pad::default()]).unwrap();
    assert_ne!(other.hash(), first[0], "a press is seen at once");
}
