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
use policy_core::{CharacterPack, Command, Controller, ControllerConfig, Goal, Heading, NodeId};

use crate::sim::{SteeredCharacter, model_of};
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
    pub node: NodeId,
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
    /// Computes both maps on a thread; the receiver gets them once. Nothing comes when the pack's body can't be
    /// simulated.
    #[must_use]
    pub fn start(pack: Arc<CharacterPack>) -> Receiver<Self> {
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            if let Some(analysis) = Self::of(&pack) {
                // The demo may have opened another pack by then.
                let _ = sender.send(analysis);
            }
        });
        receiver
    }

    /// Computes both maps, which takes about a second. `None` when the pack's body can't be simulated.
    #[must_use]
    pub fn of(pack: &Arc<CharacterPack>) -> Option<Self> {
        let model = model_of(pack).ok()?;
        let mut rows: Vec<(NodeId, Vec<f32>)> = Vec::new();
        for node in 0..pack.policies().len() {
            visit(pack, &model, NodeId::new(node), &mut rows)?;
        }
        let flat: Vec<&[f32]> = rows.iter().map(|(_, row)| &row[..]).collect();
        let states = Components::of(&flat);
        let cloud =
            rows.iter().map(|(node, row)| CloudPoint { at: states.project(row), node: *node }).collect();
        let trail = VecDeque::with_capacity(TRAIL);
        Some(Self { states, cloud, trail, parameters: ParameterMap::of(pack) })
    }

    /// Adds where the player is.
    pub fn follow(&mut self, player: &SteeredCharacter) {
        let input = player.controller.policy_input();
        let observation = player.controller.pack().skeleton().observation_len();
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back(self.states.project(&input[..observation]));
    }
}

/// Lets one policy run and keeps what it observed.
fn visit(
    pack: &Arc<CharacterPack>,
    model: &Model,
    node: NodeId,
    rows: &mut Vec<(NodeId, Vec<f32>)>,
) -> Option<()> {
    let moves = pack.graph().node(node).speed_mps.is_some_and(|s| s > 0.1);
    let mut character = Character::new(model);
    let speed = if moves { WALKING_START_MPS } else { 0.0 };
    character.stand_at(0.0, 0.0, Heading::FORWARD, speed).ok()?;
    let config = ControllerConfig { start: node, auto_recover: false, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(Arc::clone(pack), config);
    let target = moves.then_some(Vec2::new(100.0, 0.0));
    let command = Command { target, goal: Goal::Node(node), ..Command::default() };
    let observation = model.skeleton().observation_len();
    for tick in 0..RUN_TICKS {
        let stepped = character.control_tick(&mut controller, &command, 1.0 / model.control_hz());
        if tick >= WARM_UP {
            rows.push((node, controller.policy_input()[..observation].to_vec()));
        }
        if stepped.is_err() {
            break;
        }
    }
    Some(())
}
