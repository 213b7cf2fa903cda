//! A world that lives for a while: characters under pads at random, some that flail, props thrown, pushed, grabbed, added and
//! removed, and divergences provoked. Nothing that is well is put back, nothing grows, nothing ends the process.
//!
//! `SOAK_SECS` (default 20), `SOAK_CHARACTERS` (6), `SOAK_PROPS` (16) and `SOAK_DIVERGENCES` (60) size it. An hour of
//! the real thing: `SOAK_SECS=3600 SOAK_CHARACTERS=50 SOAK_PROPS=100 SOAK_DIVERGENCES=10000`. `SOAK_WALL_SECS` ends it after that
//! time on the wall at the latest, with the divergences spread over what comes first.

mod common;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use common::humanoid;
use glam::{Quat, Vec3};
use physics_bridge::{
    CharacterHandle, Diverging, Fixture, Joint, MAX_SPEED_MPS, Model, Motion, Movable, Prop, PropHandle,
    Solid, World, WorldError,
};
use policy_core::{
    Bindings, BodyId, Button, Buttons, CharacterPack, CharacterState, CommandMapper, Controller,
    GamepadState, Heading, JointTargets,
};

/// The pack whose controllers steer.
const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");

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

    fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
    }
}

fn size(name: &str, default: usize) -> usize {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// Resident memory, kilobytes; `None` where the system does not tell.
fn resident_kb() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    text.lines().find(|line| line.starts_with("VmRSS"))?.split_whitespace().nth(1)?.parse().ok()
}

/// What steers a character.
struct Player {
    character: CharacterHandle,
    controller: Controller,
    mapper: CommandMapper,
    pad: GamepadState,
    /// Ticks until the pad changes.
    keeps: usize,
    /// Targets at random instead of a pad.
    flails: bool,
}

/// One in so many characters flails.
const FLAILS: usize = 5;
/// Lines of the report on memory.
const LOOKS: usize = 20;

impl Player {
    fn new(pack: &Arc<CharacterPack>, character: CharacterHandle, flails: bool) -> Self {
        Self {
            character,
            controller: Controller::new(Arc::clone(pack)),
            mapper: CommandMapper::new(pack, &Bindings::default()),
            pad: GamepadState::default(),
            keeps: 0,
            flails,
        }
    }

    /// Targets for the next tick, from what was sensed.
    fn targets(&mut self, state: &CharacterState, dt_secs: f32, random: &mut Random) -> &[f32] {
        if self.keeps == 0 {
            self.keeps = 10 + random.below(80);
            self.pad = pad_at_random(random);
        }
        self.keeps -= 1;
        let command = self.mapper.map(&self.pad, Heading::FORWARD, state);
        self.controller.tick(state, &command, dt_secs)
    }
}

fn pad_at_random(random: &mut Random) -> GamepadState {
    let mut trigger = || if random.below(2) == 0 { 0.0 } else { random.unit() };
    let (left_trigger, right_trigger) = (trigger(), trigger());
    let mut buttons = Buttons::NONE;
    for button in [Button::South, Button::East, Button::RightShoulder, Button::RightStick] {
        buttons.set(button, random.below(6) == 0);
    }
    let left_stick = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
    GamepadState { left_stick, left_trigger, right_trigger, buttons, ..GamepadState::default() }
}

struct Soak {
    world: World,
    model: Model,
    random: Random,
    characters: Vec<CharacterHandle>,
    players: Vec<Player>,
    state: CharacterState,
    props: Vec<PropHandle>,
    /// What was provoked in this tick.
    provoked: Vec<Diverging>,
    reports: BTreeMap<String, u32>,
}

fn prop(random: &mut Random) -> Prop {
    match random.below(4) {
        0 => Prop::cube(0.3, 4.0),
        1 => Prop::ball(0.12, 3.0),
        2 => Prop::new(Solid::Capsule { radius: 0.1, half_length: 0.2 }, 3.0),
        _ => Prop::new(Solid::Cylinder { radius: 0.2, half_length: 0.2 }, 10.0),
    }
}

impl Soak {
    fn new(characters: usize, props: usize) -> Self {
        let pack = Arc::new(CharacterPack::from_bytes(&std::fs::read(PACK).unwrap()).unwrap());
        let model = Model::for_pack(&pack).unwrap();
        let mut world = World::new(&model).unwrap();
        let mut random = Random(7);
        let reach = 1.0 + (characters as f32).sqrt();
        let (characters, props) = world
            .edit(|edit| {
                let mut stand = |_| {
                    let (x, y) = (random.between(-reach, reach), random.between(-reach, reach));
                    edit.add_character(&model, x, y, Heading::from_angle(random.between(-3.0, 3.0)), 0.0)
                };
                let characters = (0..characters).map(&mut stand).collect::<Result<Vec<_>, _>>()?;
                let mut put = |index: usize| {
                    let (x, y) = (random.between(-reach, reach), random.between(-reach, reach));
                    let at = Vec3::new(x, y, 2.0 + 0.35 * (index % 40) as f32);
                    edit.add_prop(prop(&mut random), Motion::at(at))
                };
                let props = (0..props).map(&mut put).collect::<Result<Vec<_>, _>>()?;
                let half_extents = Vec3::new(1.0, 1.0, 0.1);
                edit.add_fixture(Fixture {
                    rotation: Quat::from_rotation_x(0.2),
                    ..Fixture::new(Solid::Cuboid { half_extents }, Vec3::new(0.0, 0.0, 0.2))
                })?;
                Ok((characters, props))
            })
            .unwrap();
        let player = |(index, &character)| Player::new(&pack, character, index % FLAILS == FLAILS - 1);
        let players = characters.iter().enumerate().map(player).collect();
        let state = CharacterState::new(model.skeleton());
        let (provoked, reports) = (Vec::new(), BTreeMap::new());
        Self { world, model, random, characters, players, state, props, provoked, reports }
    }

    /// Targets for all, and at times something from outside.
    fn play(&mut self) -> Result<(), WorldError> {
        let random = &mut self.random;
        let mut targets = JointTargets::new(self.model.skeleton());
        let dt_secs = 1.0 / self.model.control_hz();
        for player in &mut self.players {
            if player.flails {
                targets.iter_mut().for_each(|target| *target = random.between(-0.6, 0.6));
                self.world.actuate(player.character, &targets)?;
            } else {
                self.world.sense_into(player.character, &mut self.state)?;
                self.world.actuate(player.character, player.targets(&self.state, dt_secs, random))?;
            }
        }
        let who = self.characters[random.below(self.characters.len())];
        let what = self.props[random.below(self.props.len())];
        match random.below(40) {
            0 => self.world.push(Movable::Body(who, BodyId::new(1)), random.vector(300.0), 0.2)?,
            1 => self.world.impulse(what, random.vector(10.0))?,
            2 => self.world.stand_at(who, random.between(-4.0, 4.0), 0.0, Heading::FORWARD, 0.0)?,
            3 => {
                let at = self.world.motion(what)?.position;
                let grab = self.world.grab(what, at, 200.0)?;
                self.world.move_grab(grab, at + Vec3::Z)?;
                assert_eq!(self.world.step(), 0, "{:?}", self.world.divergences());
                self.world.release(grab)?;
            }
            4 => self.throw(what)?,
            _ => {}
        }
        Ok(())
    }

    /// Takes a prop out and throws another one; at times joins two for a while.
    fn throw(&mut self, what: PropHandle) -> Result<(), WorldError> {
        let random = &mut self.random;
        let velocity = random.vector(10.0);
        let motion = Motion::at(Vec3::new(random.between(-4.0, 4.0), 0.0, 2.5)).moving(velocity);
        let prop = prop(random);
        let hangs = random.below(4) == 0;
        let thrown = self.world.edit(|edit| {
            edit.remove_prop(what)?;
            let thrown = edit.add_prop(prop, motion)?;
            if hangs {
                let ends = [motion.position, motion.position + Vec3::Z];
                edit.join(thrown, None, Joint::Rope { ends, length: 1.2 })?;
            }
            Ok(thrown)
        })?;
        self.props.iter_mut().filter(|prop| **prop == what).for_each(|prop| *prop = thrown);
        Ok(())
    }

    /// Makes something diverge in the next tick.
    fn provoke(&mut self) -> Result<(), WorldError> {
        let who = self.characters[self.random.below(self.characters.len())];
        let what = self.props[self.random.below(self.props.len())];
        self.provoked.push(match self.random.below(5) {
            0 => {
                self.world.actuate(who, &[f32::NAN])?;
                Diverging::Character(who)
            }
            1 => {
                // Above everything, and faster than anything.
                let at = Vec3::new(self.random.between(-4.0, 4.0), self.random.between(-4.0, 4.0), 8.0);
                match self.world.place_prop(what, Motion::at(at)) {
                    Err(WorldError::Jointed) => return Ok(()),
                    placed => placed?,
                }
                self.world.impulse(what, Vec3::Z * 3e4)?;
                Diverging::Prop(what)
            }
            2 => {
                let down = Vec3::new(self.random.between(-3.0, 3.0), 0.0, -5.0);
                match self.world.place_prop(what, Motion::at(down)) {
                    Err(WorldError::Jointed) => return Ok(()),
                    placed => placed?,
                }
                Diverging::Prop(what)
            }
            3 => {
                let mut pose = physics_bridge::Pose::new(self.model.skeleton());
                self.world.pose_into(who, &mut pose)?;
                pose.qvel[2] = f64::from(MAX_SPEED_MPS) * 1e3;
                self.world.set_pose(who, &pose.qpos, &pose.qvel)?;
                Diverging::Character(who)
            }
            _ => {
                let mut pose = physics_bridge::Pose::new(self.model.skeleton());
                self.world.pose_into(who, &mut pose)?;
                pose.qvel[8] = 1e9;
                self.world.set_pose(who, &pose.qpos, &pose.qvel)?;
                Diverging::Character(who)
            }
        });
        Ok(())
    }

    /// Steps, checks what is told, and replaces what was taken out.
    fn step(&mut self) {
        self.world.step();
        let told: Vec<_> = self.world.divergences().to_vec();
        for divergence in &told {
            let what = divergence.what.expect("every divergence is of something");
            assert!(
                self.provoked.contains(&what),
                "it was well: {divergence:?}, provoked {:?}",
                self.provoked
            );
            for player in self.players.iter_mut().filter(|p| what == Diverging::Character(p.character)) {
                player.controller.reset();
            }
            assert_eq!(told.iter().filter(|other| other.what == Some(what)).count(), 1, "{told:?}");
            *self.reports.entry(format!("{:?}, {:?}", divergence.cause, divergence.remedy)).or_default() += 1;
        }
        assert!(told.len() >= self.provoked.len(), "{told:?} of {:?}", self.provoked);
        self.provoked.clear();
        for index in 0..self.props.len() {
            if self.world.motion(self.props[index]).is_err() {
                let motion = Motion::at(Vec3::new(self.random.between(-4.0, 4.0), 0.0, 2.5));
                let prop = prop(&mut self.random);
                self.props[index] = self.world.edit(|edit| edit.add_prop(prop, motion)).unwrap();
            }
        }
        let mut state = CharacterState::new(self.model.skeleton());
        for &character in &self.characters {
            self.world.sense_into(character, &mut state).expect("no character is lost");
            assert!(state.bodies.iter().all(|body| body.position.is_finite() && body.position.z > -0.6));
        }
    }
}

#[test]
fn a_world_lives() {
    let ticks = 30 * size("SOAK_SECS", 20);
    let divergences = size("SOAK_DIVERGENCES", 60);
    let mut soak = Soak::new(size("SOAK_CHARACTERS", 6), size("SOAK_PROPS", 16));
    let mut early = None;
    let mut provoked = 0;
    let (start, wall_secs) = (Instant::now(), size("SOAK_WALL_SECS", usize::MAX) as f64);
    let (mut told, mut ran) = (0, 0);
    for tick in 0..ticks {
        let done = (tick as f64 / ticks as f64).max(start.elapsed().as_secs_f64() / wall_secs);
        if done >= 1.0 {
            break;
        }
        ran = tick + 1;
        soak.play().unwrap();
        if f64::from(provoked) < done * divergences as f64 {
            soak.provoke().unwrap();
            provoked += 1;
        }
        soak.step();
        if done * LOOKS as f64 >= f64::from(told) {
            told += 1;
            let (minute, wall) = (tick as f32 / 1800.0, start.elapsed().as_secs_f32() / 60.0);
            println!(
                "minute {minute:.1}, after {wall:.1} on the wall: {provoked} provoked, {:?} kB",
                resident_kb()
            );
        }
        if early.is_none() && done >= 1.0 / 3.0 {
            early = resident_kb();
        }
    }
    println!("{provoked} divergences in {ran} ticks: {:#?}", soak.reports);
    println!("resident memory {early:?} kB, at the end {:?} kB", resident_kb());
    if let (Some(early), Some(late)) = (early, resident_kb()) {
        assert!(late < 1.3 * early + 20_000.0, "memory is flat: {early} kB, then {late} kB");
    }
}

/// Props put into the bodies of a character, `SOAK_INSIDE` times (default 60): they are driven apart, or one of them diverges,
/// which is told once a tick; the character stays in the world and sound.
#[test]
fn props_inside_a_body_leave_it() {
    let tries = size("SOAK_INSIDE", 60);
    let (model, mut random, mut told) = (humanoid(), Random(5), 0);
    let mut soak = Soak::new(1, 1);
    let who = soak.characters[0];
    let mut state = CharacterState::new(model.skeleton());
    for tried in 0..tries {
        soak.world.sense_into(who, &mut state).unwrap();
        let body = state.bodies[random.below(state.bodies.len())].position;
        let what = match soak.world.motion(soak.props[0]) {
            Ok(_) => soak.props[0],
            Err(_) => {
                let prop = prop(&mut random);
                soak.world.edit(|edit| edit.add_prop(prop, Motion::at(Vec3::Z * 3.0))).unwrap()
            }
        };
        soak.props[0] = what;
        soak.world.place_prop(what, Motion::at(body)).unwrap();
        for _ in 0..15 {
            soak.world.step();
            let mut of: Vec<_> = soak.world.divergences().iter().map(|divergence| divergence.what).collect();
            told += of.len();
            assert!(
                of.iter()
                    .all(|of| [Some(Diverging::Prop(what)), Some(Diverging::Character(who))].contains(of))
            );
            of.dedup();
            assert_eq!(of.len(), soak.world.divergences().len(), "told once, try {tried}");
            soak.world.sense_into(who, &mut state).expect("the character is not lost");
            let sound = |v: Vec3| v.is_finite() && v.length() <= MAX_SPEED_MPS;
            assert!(state.bodies.iter().all(|body| sound(body.linear_velocity)), "try {tried}");
        }
    }
    println!("{tries} props inside a body, {told} divergences");
}
