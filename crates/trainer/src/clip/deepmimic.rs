//! DeepMimic's `.txt` clips (Peng et al. 2018): JSON with one list of 44 numbers a frame, y up, quaternions wxyz.

use glam::{Quat, Vec3};
use policy_core::{BODY_COUNT, Body};
use serde::Deserialize;

use super::{Clip, ClipError};

#[derive(Deserialize)]
struct File {
    #[serde(rename = "Loop")]
    looping: String,
    #[serde(rename = "Frames")]
    frames: Vec<Vec<f32>>,
}

/// Numbers of a frame: duration, root position and rotation, then the joints.
const FRAME: usize = 44;

/// Ball joints and where their quaternions begin.
const BALLS: [(Body, usize); 8] = [
    (Body::Torso, 8),
    (Body::Head, 12),
    (Body::RightThigh, 16),
    (Body::RightFoot, 21),
    (Body::RightUpperArm, 25),
    (Body::LeftThigh, 30),
    (Body::LeftFoot, 35),
    (Body::LeftUpperArm, 39),
];

/// Hinges and where their angles lie.
const HINGES: [(Body, usize); 4] =
    [(Body::RightShin, 20), (Body::RightLowerArm, 29), (Body::LeftShin, 34), (Body::LeftLowerArm, 43)];

/// Reads the text of a DeepMimic clip.
///
/// # Errors
/// When it is not such a clip.
pub fn parse(name: &str, text: &str) -> Result<Clip, ClipError> {
    let wrong = |message: String| ClipError::Format { clip: name.into(), message };
    let file: File = serde_json::from_str(text).map_err(|e| wrong(e.to_string()))?;
    let looping = match file.looping.as_str() {
        "wrap" => true,
        "none" => false,
        other => return Err(wrong(format!("expected Loop to be wrap or none, found {other}"))),
    };
    let mut clip = Clip {
        name: name.into(),
        looping,
        times: Vec::with_capacity(file.frames.len()),
        root_positions: Vec::with_capacity(file.frames.len()),
        local_rotations: Vec::with_capacity(file.frames.len()),
    };
    let mut time = 0.0;
    for (index, frame) in file.frames.iter().enumerate() {
        let frame: &[f32; FRAME] = frame.as_slice().try_into().map_err(|_| {
            wrong(format!("expected {FRAME} numbers in frame {index}, found {}", frame.len()))
        })?;
        clip.times.push(time);
        // The last frame's duration is zero in these files: nothing follows it.
        time += frame[0];
        clip.root_positions.push(z_up(Vec3::new(frame[1], frame[2], frame[3])));
        clip.local_rotations.push(rotations(frame));
    }
    clip.checked()
}

fn rotations(frame: &[f32; FRAME]) -> [Quat; BODY_COUNT] {
    let quat = |at: usize| {
        let v = z_up(Vec3::new(frame[at + 1], frame[at + 2], frame[at + 3]));
        Quat::from_xyzw(v.x, v.y, v.z, frame[at])
    };
    let mut rotations = [Quat::IDENTITY; BODY_COUNT];
    rotations[Body::Pelvis.index()] = quat(4);
    for (body, at) in BALLS {
        rotations[body.index()] = quat(at);
    }
    for (body, at) in HINGES {
        // Their axis is z, which points to the right there: our -y.
        rotations[body.index()] = Quat::from_rotation_y(-frame[at]);
    }
    rotations
}

/// y up and z to the right become z up and y to the left.
fn z_up(v: Vec3) -> Vec3 {
    Vec3::new(v.x, -v.z, v.y)
}
