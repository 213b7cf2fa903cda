//! A leap, made by rule of a running clip: one of its flights lasts longer, so the body pushes off harder, rises, and lands softly.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use crate::side_steps::LEG_SHARE;
use crate::{Clip, ClipError};

/// Metres per second squared.
const GRAVITY: f32 = 9.81;

/// Frames a second.
const HZ: f32 = 60.0;

/// Most that half a knee may bend, radians.
const MOST_BEND: f32 = 1.2;

/// What thigh and knee of the leg ahead, and the knee of the leg behind, bend more at the top of the flight, radians.
const TUCK: [f32; 3] = [0.75, 0.55, 0.45];

/// A flight of a running clip, and how long it is to last.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Leap {
    /// Seconds of the clip between which no foot is on the ground.
    pub flight: [f32; 2],
    /// Seconds that it is to last.
    pub seconds: f32,
}

/// A frame of a leap.
struct Frame {
    /// Seconds of the clip that it is made of.
    source: f32,
    /// What the root is higher, and further ahead, metres.
    up: f32,
    ahead: f32,
    /// How far the legs are tucked up, in [0, 1].
    tuck: f32,
}

impl Clip {
    /// A leap, made of this clip of a run: its flight lasts as long as `leap` says, at the speed of the clip. The leg that stands
    /// before and after bends as far as the body dips to push off and to land.
    ///
    /// # Errors
    /// When the flight does not lie within the clip, or would become shorter or last for 2 s, or the clip lacks a thigh, shin or foot: bodies of
    /// names such as `left_thigh`.
    pub fn leap(&self, leap: &Leap) -> Result<Self, ClipError> {
        let [from, to] = leap.flight;
        let whole = self.duration();
        let in_order = from > 0.0 && from < to && to < whole && leap.seconds >= to - from;
        if !(in_order && leap.seconds < 2.0) {
            return Err(ClipError::Leap { clip: self.name.clone(), duration: whole, found: *leap });
        }
        let legs = [self.leg("left")?, self.leg("right")?];
        let frames = ((whole + (leap.seconds - (to - from))) * HZ).floor() as usize;
        let travels = (self.root_positions[self.times.len() - 1] - self.root_positions[0]).truncate();
        let along = travels.normalize_or_zero().extend(0.0);
        let speed = travels.length() / whole;
        // The leg behind pushes off, the leg ahead lands.
        let (_, at_take_off) = self.sample(from);
        let ahead = |leg: [usize; 3]| (at_take_off[0] * at_take_off[leg[0]] * Vec3::NEG_Z).dot(along);
        let [lands, pushes] = if ahead(legs[0]) > ahead(legs[1]) { legs } else { [legs[1], legs[0]] };
        let leg_metres = LEG_SHARE * self.root_positions[0].z;
        let (mut times, mut root_positions, mut local_rotations) = (Vec::new(), Vec::new(), Vec::new());
        for index in 0..=frames {
            let secs = index as f32 / HZ;
            let frame = frame_at(secs, leap, whole, speed);
            let (root, mut rotations) = self.sample(frame.source);
            if frame.tuck > 0.0 {
                turn(&mut rotations[lands[0]], -TUCK[0] * frame.tuck);
                turn(&mut rotations[lands[1]], TUCK[1] * frame.tuck);
                turn(&mut rotations[pushes[1]], TUCK[2] * frame.tuck);
            } else {
                let stands = if secs < from { pushes } else { lands };
                bend(&mut rotations, stands, -frame.up / leg_metres);
            }
            times.push(secs);
            root_positions.push(root + frame.ahead * along + frame.up * Vec3::Z);
            local_rotations.push(rotations);
        }
        let name = format!("{} (leap)", self.name);
        Self {
            name,
            looping: false,
            times,
            bodies: Arc::clone(&self.bodies),
            root_positions,
            local_rotations,
        }
        .checked()
    }
}

/// The frame at so many seconds of a leap, made of a clip that lasts `whole` seconds and goes at a speed in metres per second.
fn frame_at(secs: f32, leap: &Leap, whole: f32, speed: f32) -> Frame {
    let [from, to] = leap.flight;
    let lands = from + leap.seconds;
    // What it leaves the ground faster than the clip does.
    let rise = 0.5 * GRAVITY * (leap.seconds - (to - from));
    if secs < from {
        let t = secs / from;
        return Frame { source: secs, up: rise * from * (t * t * t - t * t), ahead: 0.0, tuck: 0.0 };
    }
    if secs < lands {
        let t = (secs - from) / leap.seconds;
        let source = from + t * (to - from);
        let height = |t: f32, seconds: f32| 0.5 * GRAVITY * seconds * seconds * t * (1.0 - t);
        return Frame {
            source,
            up: height(t, leap.seconds) - height(t, to - from),
            ahead: speed * (secs - source),
            tuck: (PI * t).sin().powi(2),
        };
    }
    let source = secs - leap.seconds + (to - from);
    let rests = whole - to;
    let t = 1.0 - (source - to) / rests;
    Frame { source, up: rise * rests * (t * t * t - t * t), ahead: speed * (secs - source), tuck: 0.0 }
}

/// Turns a limb about its own y axis; a limb ahead has a negative angle.
fn turn(limb: &mut Quat, angle: f32) {
    *limb *= Quat::from_rotation_y(angle);
}

/// Shortens a leg by a share of its length: the knee bends, and the foot keeps its attitude.
fn bend(rotations: &mut [Quat], [thigh, shin, foot]: [usize; 3], shorter: f32) {
    let half = rotations[shin].w.abs().min(1.0).acos();
    let bent = (half.cos() - shorter).clamp(MOST_BEND.cos(), 1.0).acos();
    let more = bent - half;
    turn(&mut rotations[thigh], -more);
    turn(&mut rotations[shin], 2.0 * more);
    rotations[foot] = Quat::from_rotation_y(-more) * rotations[foot];
}
