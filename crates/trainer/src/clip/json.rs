//! The project's own clip format: JSON, z up, metres, seconds, quaternions xyzw.

use glam::{Quat, Vec3};
use policy_core::{BODY_COUNT, BODY_NAMES};
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
/// When it is not such a clip, or not one of this skeleton.
pub fn parse(name: &str, text: &str) -> Result<Clip, ClipError> {
    let wrong = |message: String| ClipError::Format { clip: name.into(), message };
    let file: File = serde_json::from_str(text).map_err(|e| wrong(e.to_string()))?;
    if file.bodies.iter().map(String::as_str).ne(BODY_NAMES) {
        return Err(wrong(format!("expected the bodies {BODY_NAMES:?}, found {:?}", file.bodies)));
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
        let rotations: &[[f32; 4]; BODY_COUNT] = rotations.as_slice().try_into().map_err(|_| {
            wrong(format!("expected {BODY_COUNT} rotations in frame {frame}, found {}", rotations.len()))
        })?;
        local_rotations.push(rotations.map(Quat::from_array));
    }
    let root_positions = file.root_pos.into_iter().map(Vec3::from_array).collect();
    Clip { name: name.into(), looping, times: file.times, root_positions, local_rotations }.checked()
}
