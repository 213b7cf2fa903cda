//! Golden values for ports to other engines and languages: `port.json`. Each tick has a state and a command, and what
//! the controller makes of them. The ticks belong to one controller and are run in order.
//!
//! `crates/policy-core/examples/check_port.rs` compares an implementation's own values with them.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use physics_bridge::{Character, Model};
use policy_core::training::ActionScaling;
use policy_core::{
    BodyState, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, observe_into,
};
use serde::{Deserialize, Serialize};

use crate::{DT_SECS, HUMANOID_MJCF, reference_pack};

/// The whole file.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PortGolden {
    /// What the file is.
    pub format: String,
    /// Pack of the policies, beside this file.
    pub pack: String,
    /// Name of the node where the controller starts.
    pub start: String,
    /// Seconds from each tick to the next.
    pub dt_secs: f32,
    /// The ticks in order.
    pub ticks: Vec<PortTick>,
}

/// One control tick: the first two fields go in, the others come out.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PortTick {
    /// What is sensed.
    pub state: PortState,
    /// What is asked for.
    pub command: PortCommand,
    /// Raw observation, as `observe_into` gives it.
    pub observation: Vec<f32>,
    /// Policies by name with one blend weight for each layer.
    pub blend: Vec<(String, Vec<f32>)>,
    /// Normalised observation, then the target in the heading frame.
    pub policy_input: Vec<f32>,
    /// What the blended policy gives.
    pub action: Vec<f32>,
    /// Joint targets, radians.
    pub joint_targets: Vec<f32>,
}

/// A character's state: world space, SI units, bodies in the pack's order.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PortState {
    /// Origins of the bodies' frames, metres.
    pub positions: Vec<Vec3>,
    /// `world_from_body` as x, y, z, w.
    pub rotations: Vec<Quat>,
    /// Velocities of those origins, metres per second.
    pub linear_velocities: Vec<Vec3>,
    /// Radians per second about the world axes.
    pub angular_velocities: Vec<Vec3>,
    /// Radians per second, joints in the pack's order.
    pub joint_velocities: Vec<f32>,
    /// Metres.
    pub ground_height: f32,
    /// Metres, bodies in the pack's order; empty for level ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ground_rises: Vec<f32>,
}

/// A command: a point on the ground and a coordinate on a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PortCommand {
    /// World space, metres; none to stay.
    pub target: Option<Vec2>,
    /// Name of the path.
    pub path: String,
    /// Coordinate on it.
    pub coordinate: f32,
}

/// The file as it is in the repository.
///
/// # Panics
/// When it is broken; it is part of the sources.
#[must_use]
pub fn port_golden() -> PortGolden {
    serde_json::from_str(include_str!("port.json")).expect("the golden file is valid")
}

/// Makes the values anew. Every fifth of 200 ticks of a walk with a moving trigger and a turning target is kept as a
/// state, the last of them as if the ground were uneven. Then one controller runs over the kept states alone, so that the file has all that its values depend on.
///
/// # Panics
/// When the physics diverges or the pack lacks a name.
#[must_use]
pub fn made_anew() -> PortGolden {
    /// Ticks from one kept state to the next.
    const EVERY: u16 = 5;
    /// From this tick on a port is to see uneven ground; it walked on flat ground.
    const UNEVEN_FROM: u16 = 160;
    let pack = reference_pack();
    let mut controller = controller(&pack);
    let mut character = Character::new(&Model::from_mjcf(HUMANOID_MJCF).expect("the humanoid compiles"));
    let mut kept = Vec::new();
    for tick in 0..200u16 {
        let seconds = f32::from(tick) * DT_SECS;
        // Idle, then to Walk and some ticks there, then back into a blend.
        let coordinate = match tick / EVERY {
            0..4 => 0.0,
            4..34 => 1.0,
            _ => 0.25,
        };
        let target = (!(120..140).contains(&tick)).then(|| Vec2::new(4.0 - seconds, 1.5 * seconds));
        let asked = PortCommand { target, path: "speed".into(), coordinate };
        character.control_tick(&mut controller, &command(&pack, &asked), DT_SECS).expect("it only walks");
        if tick % EVERY == EVERY - 1 {
            let mut state = character.sensed().clone();
            if tick >= UNEVEN_FROM {
                state.sense_ground(pack.skeleton(), |at| 0.1 * (3.0 * at.x).sin());
            }
            kept.push((state, asked));
        }
    }
    let mut golden = PortGolden {
        format: "policy-space port golden 1".into(),
        pack: "reference.pack.safetensors".into(),
        start: "idle".into(),
        dt_secs: DT_SECS,
        ticks: kept.iter().map(|(state, asked)| PortTick::of(state, asked)).collect(),
    };
    golden.evaluate();
    golden
}

impl PortGolden {
    /// Overwrites what comes out, from what goes in.
    pub fn evaluate(&mut self) {
        let pack = reference_pack();
        let mut controller = controller(&pack);
        for tick in &mut self.ticks {
            let state = tick.state.to_state();
            tick.joint_targets =
                controller.tick(&state, &command(&pack, &tick.command), self.dt_secs).to_vec();
            tick.observation = vec![0.0; pack.skeleton().observation_len()];
            observe_into(pack.skeleton(), &state, &mut tick.observation);
            tick.policy_input = controller.policy_input().to_vec();
            tick.action = actions(pack.action(), &tick.joint_targets);
            let name = |term: &policy_core::training::BlendTerm| {
                let layers = pack.policies()[term.policy.index()].layers().len();
                (pack.graph().nodes()[term.policy.index()].name.clone(), term.weights[..layers].to_vec())
            };
            tick.blend = controller.report().blend.terms().iter().map(name).collect();
        }
    }
}

fn controller(pack: &Arc<CharacterPack>) -> Controller {
    // A port may leave these out: what a policy is shown is the target as it is.
    let config =
        ControllerConfig { steering: None, turn_assist: None, give_way: None, ..ControllerConfig::default() };
    Controller::with_config(Arc::clone(pack), config)
}

fn command(pack: &CharacterPack, asked: &PortCommand) -> Command {
    let path = pack.graph().path_named(&asked.path).expect("the reference pack has the path");
    let goal = Goal::Path { path, coordinate: asked.coordinate };
    Command { target: asked.target, goal, ..Command::default() }
}

fn actions(scaling: &ActionScaling, targets: &[f32]) -> Vec<f32> {
    let scaled = targets.iter().zip(scaling.centre()).zip(scaling.gain());
    scaled.map(|((target, centre), gain)| (target - centre) / gain).collect()
}

impl PortTick {
    /// A tick with nothing evaluated yet.
    fn of(state: &CharacterState, command: &PortCommand) -> Self {
        let each = |of: fn(&BodyState) -> Vec3| state.bodies.iter().map(of).collect();
        let state = PortState {
            positions: each(|body| body.position),
            rotations: state.bodies.iter().map(|body| body.rotation).collect(),
            linear_velocities: each(|body| body.linear_velocity),
            angular_velocities: each(|body| body.angular_velocity),
            joint_velocities: state.joint_velocities.clone(),
            ground_height: state.ground_height,
            ground_rises: if state.ground_rises.iter().all(|rise| *rise == 0.0) {
                Vec::new()
            } else {
                state.ground_rises.clone()
            },
        };
        let nothing = Vec::new;
        Self {
            state,
            command: command.clone(),
            observation: nothing(),
            blend: Vec::new(),
            policy_input: nothing(),
            action: nothing(),
            joint_targets: nothing(),
        }
    }
}

impl PortState {
    /// As policy-core wants it.
    #[must_use]
    pub fn to_state(&self) -> CharacterState {
        let mut state = CharacterState::new(reference_pack().skeleton());
        for (index, body) in state.bodies.iter_mut().enumerate() {
            *body = BodyState {
                position: self.positions[index],
                rotation: self.rotations[index],
                linear_velocity: self.linear_velocities[index],
                angular_velocity: self.angular_velocities[index],
            };
        }
        state.joint_velocities.copy_from_slice(&self.joint_velocities);
        state.sense_level_ground(self.ground_height);
        if !self.ground_rises.is_empty() {
            state.ground_rises.clone_from(&self.ground_rises);
        }
        state
    }
}
