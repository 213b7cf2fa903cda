//! Divergences of every kind that can be provoked: each is caught in its tick, undone, told once and left behind, and
//! no memory is lost. 1,200 of them by default; `PROVOKED=10000` says how many.

mod common;

use std::collections::BTreeMap;

use common::{hash, humanoid};
use glam::Vec3;
use physics_bridge::{
    Cause, Character, Diverged, MAX_DEPTH_M, MAX_DISTANCE_M, MAX_SPEED_MPS, Model, Pose, Settings,
};
use policy_core::{BodyId, CharacterState, Heading, JointTargets};

/// A sequence of numbers that is the same in every run.
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    fn between(&mut self, least: f32, most: f32) -> f32 {
        least + (most - least) * self.unit()
    }

    fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f32) as usize
    }
}

type Provoke = fn(&mut Character, &mut Random);

/// Ways to make a simulation diverge, and whether the next tick must.
const KINDS: [(&str, bool, Provoke); 9] = [
    ("joint targets that are no numbers", true, bad_targets),
    ("a teleport far away", true, |c, r| posed(c, |pose| pose.qpos[0] = f64::from(r.between(10_100.0, 1e9)))),
    ("a teleport into the ground", true, |c, r| {
        posed(c, |pose| pose.qpos[2] = f64::from(r.between(-9_000.0, -3.0)));
    }),
    ("a body thrown", true, |c, r| posed(c, |pose| pose.qvel[r.below(3)] = f64::from(r.between(80.0, 1e6)))),
    ("a body spun", true, |c, r| {
        posed(c, |pose| {
            pose.qpos[2] = 5.0;
            pose.qvel[3 + r.below(3)] = f64::from(r.between(500.0, 1e8));
        });
    }),
    ("a joint spun", true, |c, r| {
        posed(c, |pose| {
            let joint = 6 + r.below(pose.qvel.len() - 6);
            pose.qvel[joint] = f64::from(r.between(1e8, 1e12));
        });
    }),
    ("blows without end", false, |c, r| {
        let body = BodyId::new(r.below(c.model().skeleton().body_count()));
        for _ in 0..3 {
            c.impulse(body, Vec3::new(r.between(-1.0, 1.0), r.between(-1.0, 1.0), 1.0) * 2e5).unwrap();
        }
    }),
    ("shoves on all bodies at once", false, |c, r| {
        for index in 0..c.model().skeleton().body_count() {
            let force = Vec3::new(r.between(-1.0, 1.0), r.between(-1.0, 1.0), r.between(-1.0, 1.0)) * 5e5;
            c.push(BodyId::new(index), force, 0.5).unwrap();
        }
    }),
    ("settings at their ends under wild targets", false, |c, r| {
        let end = |r: &mut Random, least| if r.unit() < 0.5 { least } else { 5.0 };
        let settings =
            Settings { gravity: end(r, 0.0), friction: end(r, 0.0), strength: 5.0, mass: end(r, 0.2) };
        c.set_model(&c.model().with_settings(settings).unwrap()).unwrap();
        posed(c, |pose| pose.qvel.iter_mut().for_each(|v| *v = f64::from(r.between(-60.0, 60.0))));
    }),
];

fn bad_targets(character: &mut Character, random: &mut Random) {
    let mut targets = JointTargets::new(character.model().skeleton());
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX];
    let joint = random.below(targets.len());
    targets[joint] = bad[random.below(bad.len())];
    character.actuate(&targets);
}

fn posed(character: &mut Character, change: impl FnOnce(&mut Pose)) {
    let mut pose = character.pose();
    change(&mut pose);
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
}

/// How many divergences are asked for.
fn wanted() -> usize {
    std::env::var("PROVOKED").map_or(1200, |count| count.parse().expect("PROVOKED is a number"))
}

/// Memory of this process, bytes; `None` where the system does not tell.
fn memory() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split_whitespace().nth(1)?.parse::<usize>().ok()? * 4096)
}

/// What a tick that returned `Ok` promises of every body.
fn assert_plausible(character: &Character, state: &mut CharacterState, what: &str) {
    character.sense_into(state);
    assert!(state.is_finite(), "{what}: {state:?}");
    for body in &state.bodies {
        let ground = character.model().height_at(body.position.x, body.position.y);
        let (speed, depth) = (body.linear_velocity.length(), ground - body.position.z);
        assert!(speed <= 1.01 * MAX_SPEED_MPS, "{what}: {speed} m/s");
        assert!(depth <= MAX_DEPTH_M + 0.01, "{what}: {depth} m deep");
        assert!(body.position.length() <= 1.01 * MAX_DISTANCE_M, "{what}: at {}", body.position);
    }
}

/// Steps until the simulation diverges, at most two seconds; every tick before that is plausible.
fn diverge(character: &mut Character, what: &str, at_once: bool, random: &mut Random) -> Option<Diverged> {
    let mut state = CharacterState::new(character.model().skeleton());
    let mut targets = JointTargets::new(character.model().skeleton());
    for tick in 0..60 {
        let before = hash(character);
        match character.step() {
            Err(error) => {
                assert_eq!(hash(character), before, "{what}: back in the state before the tick");
                assert!(character.contacts().is_empty(), "{what}: contacts of a tick that never was");
                return Some(error);
            }
            Ok(()) => assert!(!at_once, "{what} was not caught in its tick"),
        }
        assert_plausible(character, &mut state, what);
        if tick % 2 == 0 {
            targets.iter_mut().for_each(|target| *target = random.between(-20.0, 20.0));
            character.actuate(&targets);
        }
    }
    None
}

/// Stands the character up where it was and lets it go on.
fn recover(character: &mut Character, sound: &Model, place: Vec3, what: &str) {
    character.set_model(sound).unwrap();
    character.stand_at(place.x, place.y, Heading::FORWARD, 0.0).unwrap();
    assert!((0..15).all(|body| !character.is_pushed(BodyId::new(body))), "{what}: pushes end");
    for _ in 0..3 {
        character.step().unwrap_or_else(|error| panic!("{what}: told again: {error}"));
    }
    let now = character.centre_of_mass().truncate();
    assert!(now.distance(place.truncate()) < 0.3, "{what}: stands at {now}, was at {place}");
}

#[test]
fn every_divergence_is_caught_in_its_tick_and_left_behind() {
    let (wanted, sound) = (wanted(), humanoid());
    let mut random = Random(7);
    let mut character = Character::new(&sound);
    character.record_history(1.0);
    let (mut found, mut causes) = ([0; KINDS.len()], BTreeMap::<String, usize>::new());
    let mut early = None;
    let mut tries = 0;
    while found.iter().sum::<usize>() < wanted {
        let kind = tries % KINDS.len();
        let (what, at_once, provoke) = KINDS[kind];
        let place = Vec3::new(random.between(-500.0, 500.0), random.between(-500.0, 500.0), 0.0);
        character.stand_at(place.x, place.y, Heading::FORWARD, 0.0).unwrap();
        provoke(&mut character, &mut random);
        if let Some(error) = diverge(&mut character, what, at_once, &mut random) {
            found[kind] += 1;
            *causes.entry(format!("{:?}", error.cause)).or_default() += 1;
            assert!(error.excess.is_none_or(|excess| excess.value > excess.limit), "{error}");
        }
        recover(&mut character, &sound, place, what);
        tries += 1;
        if early.is_none() && found.iter().sum::<usize>() > wanted / 10 {
            early = memory();
        }
    }
    println!("{} divergences in {tries} tries: {causes:?}", found.iter().sum::<usize>());
    for ((what, ..), count) in KINDS.iter().zip(found) {
        println!("{count:6} {what}");
        assert!(count > 0 || wanted < 100, "{what} never diverged");
    }
    let expected =
        [Cause::BadControl, Cause::TooFast, Cause::SpinsTooFast, Cause::BelowGround, Cause::TooFarAway];
    assert!(expected.iter().all(|cause| causes.contains_key(&format!("{cause:?}"))), "{causes:?}");
    if let (Some(early), Some(late)) = (early, memory()) {
        println!("memory: {} kB after a tenth, {} kB at the end", early / 1024, late / 1024);
        assert!(late < early + (8 << 20), "memory grew from {early} to {late} bytes");
    }
}
