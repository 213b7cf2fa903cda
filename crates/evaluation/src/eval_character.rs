//! One character under its controller, as in a game, and the random player that steers it.

use std::sync::Arc;

use glam::Vec2;
use physics::{Character, Model, PhysicsCharacter};
use policy_core::contract::WALKING_START_MPS;
use policy_core::training::{Heights, TARGET_RANGE_METRES};
use policy_core::{
    CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, GraphPosition, Heading,
    NodeId, PathId, Skeleton,
};
use random::Rng;

use crate::trial::TICK_SECS;

/// Seconds of walking before anything is measured.
pub const SETTLE_SECS: f32 = 2.0;

/// Largest speed at which a character is set down that is to stand, metres per second.
const STANDING_MPS: f32 = 0.3;

/// Seconds within which any node of a path is reached.
const REACH_SECS: f32 = 15.0;

/// A character and its controller.
#[derive(Debug)]
pub struct EvalCharacter {
    /// The body.
    pub character: Character,
    /// What steers it.
    pub controller: Controller,
    /// What it senses now.
    pub state: CharacterState,
}

impl EvalCharacter {
    /// A character that walks along x from the node called `start`, or from the first one. It does not get up by itself,
    /// and turns are left to its policies.
    #[must_use]
    pub fn new(model: &Model, pack: &Arc<CharacterPack>, start: &str) -> Self {
        let start = pack.graph().node_named(start).unwrap_or_default();
        Self::with_config(model, pack, ControllerConfig { start, ..ControllerConfig::unassisted() })
    }

    /// As [`EvalCharacter::new`], from the node and with all else that `config` has a controller do by itself, but for getting up.
    #[must_use]
    pub fn with_config(model: &Model, pack: &Arc<CharacterPack>, config: ControllerConfig) -> Self {
        let config = ControllerConfig { auto_recover: false, ..config };
        let mut eval = Self {
            character: Character::new(model),
            controller: Controller::with_config(pack.clone(), config),
            state: CharacterState::new(pack.skeleton()),
        };
        eval.reset(Heading::FORWARD);
        eval
    }

    /// A character that acts as `node`, straight ahead: one that is on a path and moves is reached from Walk, the second node
    /// of the path, as in a game; it may have fallen on the way. Any other stands there from the start.
    #[must_use]
    pub fn at(model: &Model, pack: &Arc<CharacterPack>, node: NodeId) -> Self {
        let mut eval = Self::before(model, pack, node);
        eval.reach(node, 0.0);
        eval
    }

    /// As [`EvalCharacter::at`], one of many that differ: it starts at another speed and goes another way, which is returned,
    /// radians from x.
    pub(super) fn at_by_chance(
        model: &Model,
        pack: &Arc<CharacterPack>,
        node: NodeId,
        rng: &mut Rng,
    ) -> (Self, f32) {
        let mut eval = Self::before(model, pack, node);
        let way = rng.angle();
        let most = if pack.graph().node(node).stands() { STANDING_MPS } else { WALKING_START_MPS };
        eval.set_down(Heading::from_angle(way), rng.range(0.0, most));
        eval.reach(node, way);
        (eval, way)
    }

    /// A character where a game would have it before it acts as `node`.
    fn before(model: &Model, pack: &Arc<CharacterPack>, node: NodeId) -> Self {
        let graph = pack.graph();
        let path = graph.paths().iter().find(|p| p.nodes().contains(&node));
        let stands = graph.node(node).stands();
        let start = path.filter(|_| !stands).map_or(node, |p| p.nodes()[1]);
        Self::new(model, pack, &graph.node(start).name)
    }

    /// Goes along `way` until it acts as `node`.
    fn reach(&mut self, node: NodeId, way: f32) {
        for _ in 0..(REACH_SECS / TICK_SECS) as u32 {
            let position = self.controller.report().position;
            if position == GraphPosition::node(node) {
                break;
            }
            let command = self.along(node, way);
            self.tick(&command);
        }
    }

    /// Stands it up at the origin, walking.
    pub fn reset(&mut self, heading: Heading) {
        self.controller.reset();
        let node = self.controller.report().position.nearest_node();
        let stands = self.controller.pack().graph().node(node).stands();
        self.set_down(heading, if stands { 0.0 } else { WALKING_START_MPS });
    }

    /// The body upright at the origin, at a speed in metres per second. The controller goes on.
    pub fn set_down(&mut self, heading: Heading, speed: f32) {
        self.character.stand_at(0.0, 0.0, heading, speed).expect("finite numbers");
        self.character.sense_into(&mut self.state);
    }

    /// One control tick. False when the physics diverged.
    pub fn tick(&mut self, command: &Command) -> bool {
        self.character.actuate(self.controller.tick(&self.state, command, TICK_SECS));
        let sound = self.character.step().is_ok();
        self.character.sense_into(&mut self.state);
        sound
    }

    /// The command to go straight ahead along x as `node`; to stay, for a node that stands.
    #[must_use]
    pub fn ahead(&self, node: NodeId) -> Command {
        self.along(node, 0.0)
    }

    /// As [`EvalCharacter::ahead`], along another way, radians from x.
    pub(super) fn along(&self, node: NodeId, way: f32) -> Command {
        let stands = self.controller.pack().graph().node(node).stands();
        let target = self.position() + TARGET_RANGE_METRES * Vec2::from_angle(way);
        Command { target: (!stands).then_some(target), goal: Goal::Node(node), ..Command::default() }
    }

    /// Horizontal place of the pelvis.
    #[must_use]
    pub fn position(&self) -> Vec2 {
        self.state.root().position.truncate()
    }

    /// True when pelvis and head are as high as in standing.
    #[must_use]
    pub fn is_upright(&self) -> bool {
        is_upright(self.controller.pack().skeleton(), &self.state)
    }

    /// Height of the pelvis above the ground, metres.
    #[must_use]
    pub fn pelvis_height(&self) -> f32 {
        self.state.root_height()
    }
}

/// True when pelvis and head, if there is one, are as high as those of the humanoid in standing.
pub(super) fn is_upright(skeleton: &Skeleton, state: &CharacterState) -> bool {
    let heights = Heights::of(skeleton, state);
    heights.root > 0.65 && heights.head > 1.1
}

/// A random player: new directions every 2 to 5 s, turns of up to 90 degrees, a trigger that sweeps or rests.
#[derive(Clone, Copy, Debug)]
pub struct Wanderer {
    rng: Rng,
    path: PathId,
    end: f32,
    direction: f32,
    turn_in: f32,
    /// Coordinate on the path now.
    pub coordinate: f32,
    sweep_mps: f32,
    rising: bool,
}

impl Wanderer {
    /// A player on a path, at `coordinate` and resting there, or sweeping over the whole path when `None`.
    #[must_use]
    pub fn new(rng: Rng, path: PathId, end: f32, coordinate: Option<f32>) -> Self {
        let mut player = Self {
            rng,
            path,
            end,
            direction: 0.0,
            turn_in: SETTLE_SECS,
            coordinate: coordinate.unwrap_or(1.0_f32.min(end)),
            sweep_mps: 0.0,
            rising: true,
        };
        if coordinate.is_none() {
            player.draw_sweep();
        }
        player
    }

    /// A whole sweep up and down takes 4 to 8 s.
    fn draw_sweep(&mut self) {
        self.sweep_mps = 2.0 * self.end / self.rng.range(4.0, 8.0);
    }

    /// Unit vector it wants to go along.
    #[must_use]
    pub fn direction(&self) -> Vec2 {
        Vec2::from_angle(self.direction)
    }

    /// Next command for a character at `position`. Below the path's second node the target comes nearer, as the stick of
    /// a pad would have it.
    pub fn command(&mut self, position: Vec2) -> Command {
        self.turn_in -= TICK_SECS;
        if self.turn_in <= 0.0 {
            self.turn_in = self.rng.range(2.0, 5.0);
            self.direction += self.rng.range(-1.0, 1.0) * std::f32::consts::FRAC_PI_2;
        }
        if self.sweep_mps > 0.0 {
            let step = self.sweep_mps * TICK_SECS;
            self.coordinate += if self.rising { step } else { -step };
            if self.coordinate >= self.end || self.coordinate <= 0.0 {
                self.coordinate = self.coordinate.clamp(0.0, self.end);
                self.rising = !self.rising;
                self.draw_sweep();
            }
        }
        let push = self.coordinate.min(1.0);
        let target = position + self.direction() * (push * TARGET_RANGE_METRES);
        Command {
            target: (push > 0.0).then_some(target),
            goal: Goal::Path { path: self.path, coordinate: self.coordinate },
            ..Command::default()
        }
    }
}
