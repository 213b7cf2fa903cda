//! The golden walk: sixty control ticks of the Walk policy towards (20, 5), recorded with MuJoCo 3.17.0
//! before this project began.

use serde::Deserialize;

pub mod port;

/// The whole recording.
#[derive(Debug, Deserialize)]
pub struct GoldenWalk {
    /// Name of the policy.
    pub policy: String,
    /// Where it walks to, world, metres.
    pub target_world: [f32; 2],
    /// Names in the order of `ctrl`.
    pub actuators: Vec<String>,
    /// Names in the order of `qpos[7..]`.
    pub joints_in_qpos_order: Vec<String>,
    /// Names in the order of the observation.
    pub bodies: Vec<String>,
    /// `qpos` after 300 ticks.
    pub final_qpos_after_300_ticks: Vec<f64>,
    /// The first sixty ticks.
    pub ticks: Vec<GoldenTick>,
}

/// State, observation and action of one control tick, all taken before it is stepped.
#[derive(Debug, Deserialize)]
pub struct GoldenTick {
    /// Generalised position, 35.
    pub qpos: Vec<f64>,
    /// Generalised velocity, 34.
    pub qvel: Vec<f64>,
    /// Raw observation, 223.
    pub observation: Vec<f32>,
    /// Raw discriminator frame, 125.
    pub discriminator_frame: Vec<f32>,
    /// Normalised observation and target, 225.
    pub policy_input: Vec<f32>,
    /// Normalised action, 28.
    pub action: Vec<f32>,
    /// Joint targets in radians, 28.
    pub ctrl: Vec<f64>,
}

/// Reads the recording.
///
/// # Panics
/// When the file is not the recording; it is part of the sources.
#[must_use]
pub fn golden_walk() -> GoldenWalk {
    serde_json::from_str(include_str!("golden_walk.json")).expect("the golden file is valid")
}

/// The largest difference between two lists, as (index, difference). NaN counts as infinite.
///
/// # Panics
/// When the lengths differ.
#[must_use]
pub fn largest_difference(a: &[f32], b: &[f32]) -> (usize, f32) {
    assert_eq!(a.len(), b.len(), "lists of different length");
    let difference = |(a, b): (&f32, &f32)| {
        let d = (a - b).abs();
        if d.is_nan() { f32::INFINITY } else { d }
    };
    let largest = a.iter().zip(b).map(difference).enumerate().max_by(|x, y| x.1.total_cmp(&y.1));
    largest.unwrap_or((0, 0.0))
}
