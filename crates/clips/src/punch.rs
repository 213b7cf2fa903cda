//! A punch, made by rule: a straight right out of a guard, on both feet.

use std::sync::Arc;

use glam::{Quat, Vec3};

use crate::error::find_body;
use crate::side_steps::LEG_SHARE;
use crate::{Clip, ClipError};

/// Frames a second.
const HZ: f32 = 60.0;

/// A moment of the punch: angles added to those of the standing pose, radians.
#[derive(Clone, Copy)]
struct Key {
    secs: f32,
    /// The torso to the left, and ahead.
    torso: [f32; 2],
    /// Upper arm and elbow of the arm that strikes, and of the other one; an arm ahead has a negative angle.
    strikes: [f32; 2],
    guards: [f32; 2],
    /// Half the bend of the knees.
    bend: f32,
}

const STANDS: Key = Key { secs: 0.0, torso: [0.0; 2], strikes: [0.0; 2], guards: [0.0; 2], bend: 0.0 };

/// Both fists before the chin, the striking shoulder back.
const GUARD: Key =
    Key { secs: 0.28, torso: [-0.25, 0.05], strikes: [-0.55, -1.75], guards: [-0.6, -1.75], bend: 0.1 };

/// The arm all but straight at the height of the shoulder, which has come ahead.
const REACH: Key =
    Key { secs: 0.6, torso: [0.5, 0.12], strikes: [-1.45, -0.05], guards: [-0.6, -1.8], bend: 0.14 };

/// Its moments in order. It can't be much quicker: the damper of the humanoid's elbow holds it at 4 radians a second.
const KEYS: [Key; 6] = [
    STANDS,
    GUARD,
    REACH,
    Key { secs: 0.7, ..REACH },
    Key { secs: 1.0, torso: [0.0, 0.05], ..GUARD },
    Key { secs: 1.35, ..STANDS },
];

impl Clip {
    /// A straight right, made of how this clip begins; it should begin standing. It lasts 1.35 s.
    ///
    /// # Errors
    /// When the clip lacks a torso, head, arm or leg: bodies of names such as `right_upper_arm`.
    pub fn punch(&self) -> Result<Self, ClipError> {
        let find = |name: &str| find_body(&self.name, &self.bodies, name);
        let [torso, head] = [find("torso")?, find("head")?];
        let arms = [
            [find("right_upper_arm")?, find("right_lower_arm")?],
            [find("left_upper_arm")?, find("left_lower_arm")?],
        ];
        let legs = [self.leg("right")?, self.leg("left")?];
        // A clip that was checked has a frame.
        let (pose, root) = (&self.local_rotations[0], self.root_positions[0]);
        let mut clip = Self {
            name: format!("{} (punch)", self.name),
            looping: false,
            times: Vec::new(),
            bodies: Arc::clone(&self.bodies),
            root_positions: Vec::new(),
            local_rotations: Vec::new(),
        };
        let last = KEYS[KEYS.len() - 1].secs;
        for index in 0..=(last * HZ).round() as usize {
            let secs = index as f32 / HZ;
            let key = at(secs);
            let mut rotations = pose.clone();
            let [left, ahead] = key.torso;
            rotations[torso] = Quat::from_rotation_z(left) * Quat::from_rotation_y(ahead) * pose[torso];
            // The eyes stay ahead.
            rotations[head] = Quat::from_rotation_z(-left) * Quat::from_rotation_y(-ahead) * pose[head];
            for ([upper, lower], [shoulder, elbow]) in arms.into_iter().zip([key.strikes, key.guards]) {
                rotations[upper] = Quat::from_rotation_y(shoulder) * pose[upper];
                rotations[lower] = Quat::from_rotation_y(elbow) * pose[lower];
            }
            for [thigh, shin, foot] in legs {
                rotations[thigh] = Quat::from_rotation_y(-key.bend) * pose[thigh];
                rotations[shin] = Quat::from_rotation_y(2.0 * key.bend) * pose[shin];
                rotations[foot] = Quat::from_rotation_y(-key.bend) * pose[foot];
            }
            let down = LEG_SHARE * root.z * (1.0 - key.bend.cos());
            clip.times.push(secs);
            clip.root_positions.push(root - down * Vec3::Z);
            clip.local_rotations.push(rotations);
        }
        clip.checked()
    }
}

/// The punch at a time, slow at each key.
fn at(secs: f32) -> Key {
    let next = KEYS.iter().position(|key| key.secs >= secs).unwrap_or(KEYS.len() - 1).max(1);
    let [from, to] = [KEYS[next - 1], KEYS[next]];
    let t = ((secs - from.secs) / (to.secs - from.secs)).clamp(0.0, 1.0);
    let t = t * t * (3.0 - 2.0 * t);
    let of = |a: f32, b: f32| a + t * (b - a);
    let both = |a: [f32; 2], b: [f32; 2]| [of(a[0], b[0]), of(a[1], b[1])];
    Key {
        secs,
        torso: both(from.torso, to.torso),
        strikes: both(from.strikes, to.strikes),
        guards: both(from.guards, to.guards),
        bend: of(from.bend, to.bend),
    }
}
