//! DeepMimic's `.txt` clips (Peng et al. 2018): JSON with one list of 44 numbers a frame, y up, quaternions wxyz.

use files::quoted;
use glam::{Quat, Vec3};
use serde::Deserialize;

use super::{Clip, ClipError, humanoid};

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
const BALLS: [(&str, usize); 8] = [
    ("torso", 8),
    ("head", 12),
    ("right_thigh", 16),
    ("right_foot", 21),
    ("right_upper_arm", 25),
    ("left_thigh", 30),
    ("left_foot", 35),
    ("left_upper_arm", 39),
];

/// Hinges and where their angles lie.
const HINGES: [(&str, usize); 4] =
    [("right_shin", 20), ("right_lower_arm", 29), ("left_shin", 34), ("left_lower_arm", 43)];

/// Reads the text of a DeepMimic clip.
///
/// # Errors
/// When it is not such a clip.
pub fn parse(name: &str, text: &str) -> Result<Clip, ClipError> {
    let wrong = |message: String| ClipError::Format { clip: name.into(), message: quoted(&message) };
    let file: File = serde_json::from_str(text).map_err(|e| wrong(e.to_string()))?;
    let looping = match file.looping.as_str() {
        "wrap" => true,
        "none" => false,
        other => return Err(wrong(format!("expected Loop to be wrap or none, found {other}"))),
    };
    let mut clip = Clip {
        name: name.into(),
        looping,
        bodies: humanoid::bodies(),
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
        clip.local_rotations.push(rotations(&clip.bodies, frame));
    }
    clip.checked()
}

fn rotations(bodies: &[String], frame: &[f32; FRAME]) -> Vec<Quat> {
    let quat = |at: usize| {
        // The tables above stay within the 44 numbers of a frame.
        let v = z_up(Vec3::new(frame[at + 1], frame[at + 2], frame[at + 3]));
        Quat::from_xyzw(v.x, v.y, v.z, frame[at])
    };
    let mut rotations = vec![Quat::IDENTITY; bodies.len()];
    // The tables name bodies of the humanoid, whatever the file says.
    let index = |name: &str| bodies.iter().position(|body| body == name).expect("a body of the humanoid");
    rotations[0] = quat(4);
    for (body, at) in BALLS {
        rotations[index(body)] = quat(at);
    }
    for (body, at) in HINGES {
        // Their axis is z, which points to the right there: our -y.
        rotations[index(body)] = Quat::from_rotation_y(-frame[at]);
    }
    rotations
}

/// y up and z to the right become z up and y to the left.
fn z_up(v: Vec3) -> Vec3 {
    Vec3::new(v.x, -v.z, v.y)
}
