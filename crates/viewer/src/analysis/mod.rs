//! Principal components of what characters go through and of what policies are (the paper's figures 5 and 6).
//!
//! The cloud of states comes from short runs of every policy in the physics, on a thread of its own; the axes
//! of parameters come from the policies themselves.

mod components;
mod parameters;

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use glam::{Vec2, Vec3};
use physics_bridge::{Character, Model, WALKING_START_MPS};
use policy_core::{
    CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, Heading, OBSERVATION_LEN,
};

use crate::assets;
use crate::sim::{Actor, TICK_SECS};
use components::Components;
pub use parameters::ParameterMap;

/// Ticks of each policy's run, the first few left out.
const RUN_TICKS: usize = 120;
const WARM_UP: usize = 10;
/// Points of the live trail.
const TRAIL: usize = 150;

/// A point of the cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// On the first three axes, scaled to about [-1, 1].
    pub at: Vec3,
    /// The policy that ran.
    pub node: usize,
}

/// Both maps.
#[derive(Clone, Debug)]
pub struct Analysis {
    states: Components,
    /// States that the policies go through.
    pub cloud: Vec<CloudPoint>,
    /// Where the player has been, newest last.
    pub trail: VecDeque<Vec3>,
    /// Policies, edges and blend.
    pub parameters: ParameterMap,
}

impl Analysis {
    /// Works everything out on a thread; the receiver gets it once. Nothing comes when the humanoid is broken.
    #[must_use]
    pub fn start(pack: Arc<CharacterPack>) -> Receiver<Self> {
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            if let Some(analysis) = Self::of(&pack) {
                // The demo may have gone on with another pack.
                let _ = sender.send(analysis);
            }
        });
        receiver
    }

    /// Works everything out, about a second. `None` when the humanoid is broken.
    #[must_use]
    pub fn of(pack: &Arc<CharacterPack>) -> Option<Self> {
        let model = Model::from_mjcf(assets::HUMANOID_MJCF).ok()?;
        let mut rows: Vec<(usize, [f32; OBSERVATION_LEN])> = Vec::new();
        for node in 0..pack.policies().len() {
            visit(pack, &model, node, &mut rows)?;
        }
        let flat: Vec<&[f32]> = rows.iter().map(|(_, row)| &row[..]).collect();
        let states = Components::of(&flat);
        let cloud =
            rows.iter().map(|(node, row)| CloudPoint { at: states.project(row), node: *node }).collect();
        let trail = VecDeque::with_capacity(TRAIL);
        Some(Self { states, cloud, trail, parameters: ParameterMap::of(pack) })
    }

    /// Takes in where the player is.
    pub fn follow(&mut self, player: &Actor) {
        let input = player.controller.policy_input();
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back(self.states.project(&input[..OBSERVATION_LEN]));
    }
}

/// Lets one policy run and keeps what it saw.
fn visit(
    pack: &Arc<CharacterPack>,
    model: &Model,
    node: usize,
    rows: &mut Vec<(usize, [f32; OBSERVATION_LEN])>,
) -> Option<()> {
    let moves = pack.graph().nodes()[node].speed_mps.is_some_and(|s| s > 0.1);
    let mut character = Character::new(model);
    let speed = if moves { WALKING_START_MPS } else { 0.0 };
    character.stand_at(0.0, 0.0, Heading::FORWARD, speed).ok()?;
    let config = ControllerConfig { start: node, recover: false, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(Arc::clone(pack), config);
    let target = moves.then_some(Vec2::new(100.0, 0.0));
    let command = Command { target, goal: Goal::Node(node), ..Command::default() };
    let mut state = CharacterState::default();
    for tick in 0..RUN_TICKS {
        character.sense_into(&mut state);
        let targets = *controller.tick(&state, &command, TICK_SECS);
        if tick >= WARM_UP {
            rows.push((node, *controller.policy_input().first_chunk()?));
        }
        character.actuate(&targets);
        if character.step().is_err() {
            break;
        }
    }
    Some(())
}
