//! The world and who steers it: the player, the fixed script or a replay. Always records.

use glam::{Quat, Vec3};
use lockstep::{Arena, ArenaConfig, ArenaError, SCRIPT_TICKS, script_pad};
use playground::RaceState;
use policy_core::{CharacterPack, FixedRate, GamepadState, Heading};
use replay::{Mismatch, Pad, Playback, Recorder, Replay, ReplayError};
use wasm_bindgen::JsError;

/// Where bodies are: origins of their frames and rotations, for each character, then for each prop.
pub type Poses = Vec<(Vec3, Quat)>;

/// Who steers.
enum Input {
    Player,
    Script,
    Replay(Box<Playback>),
    /// A script or a replay is over: the world waits.
    Over,
}

/// Why a tick was not run.
enum Stopped {
    Arena(ArenaError),
    Replay(ReplayError),
    Mismatch(Mismatch),
}

pub struct Game {
    pack: Vec<u8>,
    /// What the player plays in.
    chosen: ArenaConfig,
    arena: Arena,
    rate: FixedRate,
    recorder: Recorder,
    input: Input,
    pads: Vec<Pad>,
    /// Before the last tick and after it.
    poses: [Poses; 2],
}

impl Game {
    /// The world that a player has chosen.
    pub fn new(pack: Vec<u8>, chosen: ArenaConfig) -> Result<Self, JsError> {
        Self::in_world(pack, chosen, chosen)
    }

    fn in_world(pack: Vec<u8>, chosen: ArenaConfig, config: ArenaConfig) -> Result<Self, JsError> {
        let arena = Arena::new(&pack, config)?;
        let recorder = Recorder::new(arena.header())?;
        let rate = FixedRate::new(1.0 / arena.tick_secs());
        let poses = [poses_of(&arena), poses_of(&arena)];
        let pads = vec![Pad::default(); config.players];
        Ok(Self { pack, chosen, arena, rate, recorder, input: Input::Player, pads, poses })
    }

    pub fn pack(&self) -> &CharacterPack {
        self.arena.pack()
    }

    pub fn arena(&self) -> &Arena {
        &self.arena
    }

    pub fn ticks(&self) -> u32 {
        self.arena.tick_count() as u32
    }

    pub fn tick_secs(&self) -> f32 {
        self.arena.tick_secs()
    }

    pub fn hash(&mut self) -> u64 {
        self.arena.hash()
    }

    pub fn replay(&self) -> &Replay {
        self.recorder.replay()
    }

    pub fn mode(&self) -> &'static str {
        match self.input {
            Input::Player => "recording",
            Input::Script => "script",
            Input::Replay(_) => "playing",
            Input::Over => "over",
        }
    }

    /// Seconds that the replay still takes; `None` when none is played.
    pub fn replay_left(&self) -> Option<f32> {
        let Input::Replay(playback) = &self.input else { return None };
        Some((playback.replay().ticks() - playback.tick()) as f32 * self.tick_secs())
    }

    /// Begins anew. The script is for flat ground.
    pub fn restart(&mut self, script: bool) -> Result<(), JsError> {
        let flat = ArenaConfig { players: self.chosen.players, ..ArenaConfig::default() };
        let config = if script { flat } else { self.chosen };
        *self = Self::in_world(self.pack.clone(), self.chosen, config)?;
        if script {
            self.input = Input::Script;
        }
        Ok(())
    }

    /// Plays a replay from the start, in the world that it was played in.
    pub fn play(&mut self, replay: &Replay) -> Result<(), JsError> {
        let config = ArenaConfig::of(replay.header())?;
        let game = Self::in_world(self.pack.clone(), self.chosen, config)?;
        game.arena.header().expect(replay.header())?;
        *self = Self { input: Input::Replay(Box::new(Playback::new(replay))), ..game };
        Ok(())
    }

    /// The course in a few words; empty where there is none.
    pub fn course(&self) -> String {
        let count = self.arena.layout().checkpoints.len();
        let Some(race) = self.arena.race(0).filter(|_| count > 0) else { return String::new() };
        let (secs, falls) = (race.secs(self.tick_secs()), race.falls());
        let falls = if falls == 1 { "1 fall".to_owned() } else { format!("{falls} falls") };
        match race.state() {
            RaceState::Waiting => "Course: go to the light".into(),
            RaceState::Running => {
                format!("Course: {secs:.1} s, {falls}, checkpoint {} of {count}", race.next() + 1)
            }
            RaceState::Finished => format!("Course done: {secs:.1} s, {falls}"),
        }
    }

    /// Time and falls of a run over the course that is done.
    pub fn finished(&self) -> Option<(f32, u32)> {
        let race = self.arena.race(0)?;
        (race.state() == RaceState::Finished).then(|| (race.secs(self.tick_secs()), race.falls()))
    }

    /// Weight of each policy in what the player's character does.
    pub fn weights(&self) -> Vec<f32> {
        let mut weights = vec![0.0; self.pack().policies().len()];
        if let Some(player) = self.arena.player(0) {
            for term in player.report.blend.terms() {
                weights[term.policy.index()] += term.weights[0];
            }
        }
        weights
    }

    /// Runs the ticks that are due.
    pub fn advance(&mut self, secs: f32, pad: &GamepadState, camera: Heading) -> Result<u32, JsError> {
        let due = self.rate.advance(secs);
        for tick in 0..due {
            match self.tick(pad, camera) {
                Ok(true) => {}
                Ok(false) => return Ok(tick),
                Err(stopped) => {
                    self.input = Input::Over;
                    return Err(match stopped {
                        Stopped::Arena(error) => error.into(),
                        Stopped::Replay(error) => error.into(),
                        Stopped::Mismatch(error) => error.into(),
                    });
                }
            }
        }
        Ok(due)
    }

    /// One tick; false when there is nothing more to play.
    fn tick(&mut self, pad: &GamepadState, camera: Heading) -> Result<bool, Stopped> {
        let tick = self.ticks();
        match &mut self.input {
            Input::Player => self.pads[0] = Pad::from_state(pad, camera),
            Input::Script if tick >= SCRIPT_TICKS => self.input = Input::Over,
            Input::Script => {
                self.pads.iter_mut().enumerate().for_each(|(player, pad)| *pad = script_pad(tick, player));
            }
            Input::Replay(playback) => match playback.next_pads() {
                Some(pads) => self.pads.copy_from_slice(pads),
                None => self.input = Input::Over,
            },
            Input::Over => {}
        }
        if matches!(self.input, Input::Over) {
            return Ok(false);
        }
        self.arena.tick(&self.pads).map_err(Stopped::Arena)?;
        let hash = self.arena.hash();
        self.recorder.push(&self.pads, hash).map_err(Stopped::Replay)?;
        if let Input::Replay(playback) = &mut self.input {
            playback.check(hash).map_err(Stopped::Mismatch)?;
        }
        let [before, now] = &mut self.poses;
        std::mem::swap(before, now);
        *now = poses_of(&self.arena);
        Ok(true)
    }

    /// Where everything is now, between the last two ticks.
    pub fn poses(&self) -> Poses {
        let alpha = self.rate.fraction();
        let between = |(a, b): (&(Vec3, Quat), &(Vec3, Quat))| (a.0.lerp(b.0, alpha), a.1.slerp(b.1, alpha));
        self.poses[0].iter().zip(&self.poses[1]).map(between).collect()
    }

    /// Gait, skill and speed of the player.
    pub fn doing(&self) -> String {
        let Some(player) = self.arena.player(0) else { return String::new() };
        let pack = self.pack();
        let nodes = pack.graph().nodes();
        let what = match player.report.skill {
            Some(skill) => pack.skills()[skill.skill.index()].name.clone(),
            None => {
                let at = player.report.position;
                let (from, to) = (&nodes[at.from.index()].name, &nodes[at.to.index()].name);
                if at.t < 0.05 || from == to { from.clone() } else { format!("{from} to {to}") }
            }
        };
        let speed = player.state.horizontal_speed();
        format!("{} at {speed:.1} m/s", what.replace('_', " "))
    }
}

fn poses_of(arena: &Arena) -> Poses {
    let players = (0..arena.character_count()).filter_map(|index| arena.player(index));
    let bodies = players.flat_map(|player| player.state.bodies.iter().map(|b| (b.position, b.rotation)));
    bodies.chain(arena.props().map(|prop| (prop.motion.position, prop.motion.rotation))).collect()
}
