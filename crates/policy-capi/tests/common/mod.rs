//! A pack with everything that a pack can have, and what a standing humanoid senses.
#![allow(dead_code, reason = "each test file uses its part")]

use std::ffi::CStr;

use policy_core::{ActuationContract, CharacterPack, JointActuation};
use policy_space::*;

pub const DT: f32 = 1.0 / 30.0;
pub const BODIES: usize = 15;
pub const JOINTS: usize = 28;
pub const MJCF: &str = "<mujoco/>";

const REFERENCE: &[u8] = include_bytes!("../../../../tests/golden/reference.pack.safetensors");

/// Bytes of the reference pack, of version 1.
pub fn old_bytes() -> &'static [u8] {
    REFERENCE
}

/// The reference pack with motors, MJCF text and a mesh, as version 2.
pub fn bytes() -> Vec<u8> {
    let pack = CharacterPack::from_bytes(REFERENCE).unwrap();
    let (mut manifest, mut tensors) = (pack.manifest().clone(), pack.tensors().clone());
    let motor = |i| JointActuation { gain: i as f32, damping: 2.0, force_limit: 3.0, armature: 0.5 };
    let joints = (0..JOINTS).map(motor).collect();
    manifest.actuation = Some(ActuationContract { physics_hz: 120.0, mass_kg: 48.9, joints });
    manifest.mjcf = Some(MJCF.into());
    tensors.mesh = Some(vec![1, 2, 3]);
    CharacterPack::from_parts(manifest, tensors).unwrap().to_bytes()
}

pub fn load(bytes: &[u8]) -> Box<PsPack> {
    // SAFETY: a slice is valid for its length.
    unsafe { ps_pack_from_bytes(bytes.as_ptr(), bytes.len()) }.unwrap_or_else(|| panic!("{}", last_error()))
}

pub fn pack() -> Box<PsPack> {
    load(&bytes())
}

pub fn controller(pack: &PsPack) -> Box<PsController> {
    ps_controller_new(Some(pack), None).unwrap_or_else(|| panic!("{}", last_error()))
}

pub fn last_error() -> &'static str {
    // SAFETY: the text ends with a zero; each caller is done with it before the next failure.
    unsafe { CStr::from_ptr(ps_last_error()) }.to_str().unwrap()
}

/// The arrays of a humanoid that stands.
pub struct Body {
    pub bodies: Vec<PsBody>,
    pub velocities: Vec<f32>,
}

impl Body {
    pub fn standing() -> Self {
        let body = PsBody { position: [0.0, 0.0, 0.9], rotation: [0.0, 0.0, 0.0, 1.0], ..PsBody::default() };
        let mut bodies = vec![body; BODIES];
        bodies[2].position[2] = 1.4;
        Self { bodies, velocities: vec![0.0; JOINTS] }
    }

    pub fn sensed(&self) -> PsSensed {
        PsSensed {
            bodies: self.bodies.as_ptr(),
            body_count: self.bodies.len(),
            joint_velocities: self.velocities.as_ptr(),
            joint_count: self.velocities.len(),
            ground_height: 0.0,
            ground_heights: std::ptr::null(),
        }
    }
}

/// Along the path *speed*, towards a point ahead.
pub fn walking() -> PsCommand {
    PsCommand {
        has_target: 1,
        target: [5.0, 0.5],
        goal: PsGoal::Path as i32,
        goal_index: 0,
        coordinate: 0.7,
        ..PsCommand::default()
    }
}

/// One tick with arrays that are as long as they say.
pub fn tick(controller: &mut PsController, body: &Body, command: &PsCommand, out: &mut [f32]) -> PsStatus {
    let sensed = body.sensed();
    // SAFETY: all pointers are of slices, with their lengths.
    unsafe {
        ps_controller_tick(Some(controller), Some(&sensed), Some(command), DT, out.as_mut_ptr(), out.len())
    }
}
