//! The project's own clip format: JSON, z up, metres, seconds, quaternions xyzw.

use files::quoted;
use glam::{Quat, Vec3};
use policy_core::training::MAX_SKELETON_PARTS;
use serde::Deserialize;

use super::{Clip, ClipError};

#[derive(Deserialize)]
struct File {
    #[serde(rename = "loop")]
    looping: String,
    #[serde(default)]
    up: Option<String>,
    #[serde(default)]
    quat: Option<String>,
    bodies: Vec<String>,
    times: Vec<f32>,
    root_pos: Vec<[f32; 3]>,
    local_rot: Vec<Vec<[f32; 4]>>,
}

/// Reads the text of a JSON clip.
///
/// # Errors
/// When it is not such a clip.
pub fn parse(name: &str, text: &str) -> Result<Clip, ClipError> {
    let wrong = |message: String| ClipError::Format { clip: name.into(), message: quoted(&message) };
    let file: File = serde_json::from_str(text).map_err(|e| wrong(e.to_string()))?;
    let twice = |i: usize| file.bodies[..i].contains(&file.bodies[i]);
    if !(1..=MAX_SKELETON_PARTS).contains(&file.bodies.len()) || (1..file.bodies.len()).any(twice) {
        return Err(wrong(format!(
            "expected 1 to {MAX_SKELETON_PARTS} bodies of different names, found {:?}",
            file.bodies
        )));
    }
    for (field, expected, found) in [("up", "z", &file.up), ("quat", "xyzw", &file.quat)] {
        if let Some(found) = found.as_ref().filter(|f| *f != expected) {
            return Err(wrong(format!("expected {field} to be {expected}, found {found}")));
        }
    }
    let looping = match file.looping.as_str() {
        "wrap" => true,
        "none" => false,
        other => return Err(wrong(format!("expected loop to be wrap or none, found {other}"))),
    };
    let mut local_rotations = Vec::with_capacity(file.local_rot.len());
    for (frame, rotations) in file.local_rot.iter().enumerate() {
        let (expected, found) = (file.bodies.len(), rotations.len());
        if found != expected {
            return Err(wrong(format!("expected {expected} rotations in frame {frame}, found {found}")));
        }
        local_rotations.push(rotations.iter().copied().map(Quat::from_array).collect());
    }
    let root_positions = file.root_pos.into_iter().map(Vec3::from_array).collect();
    let bodies = file.bodies.into();
    Clip { name: name.into(), looping, times: file.times, bodies, root_positions, local_rotations }.checked()
}
