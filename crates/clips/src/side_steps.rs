//! Steps aside, made by rule: people who are filmed for clips hardly ever walk sideways.

use std::f32::consts::PI;
use std::sync::Arc;

use files::quoted;
use glam::{Quat, Vec3};

use crate::{Clip, ClipError};

/// Seconds of a cycle of two steps.
const CYCLE_SECS: f32 = 0.7;

/// Share of the cycle in which a foot stands.
const STANCE: f32 = 0.58;

/// Frames of a cycle.
const FRAMES: usize = 42;

/// Angle of a leg to its side half-way through its stance, radians: with less the feet would meet.
const SPREAD: f32 = 0.13;

/// Half the bend of the knee in the stance where the leg is spread most, and what swinging adds, radians.
const BEND: [f32; 2] = [0.15, 0.27];

/// Length of a leg as a share of the height of a standing root.
const LEG_SHARE: f32 = 0.95;

/// Rotations of thigh, shin and foot over those of the standing pose.
struct Leg {
    thigh: Quat,
    shin: Quat,
    foot: Quat,
}

impl Clip {
    /// A cycle of steps to the left at a speed in metres per second, made of how this clip begins, half-way to its mirror image.
    /// It should begin standing. The rest of the body keeps that pose.
    ///
    /// # Errors
    /// When the clip lacks a thigh, shin or foot: bodies of names such as `left_thigh`.
    pub fn side_steps(&self, mps: f32) -> Result<Self, ClipError> {
        let standing = self.towards(self, 1.0)?;
        // A clip that was checked has a frame.
        let (pose, height) = (&standing.local_rotations[0], standing.root_positions[0].z);
        let legs = ["left", "right"].map(|side| self.leg(side));
        let [left, right] = legs;
        let legs = [left?, right?];
        let reach = 0.5 * mps * CYCLE_SECS * STANCE / (LEG_SHARE * height);
        let lowest = BEND[0].cos() * (SPREAD + reach).cos();
        let frame = |index: usize| {
            let phase = index as f32 / FRAMES as f32;
            let mut rotations = pose.clone();
            for (side, bodies) in [1.0, -1.0].into_iter().zip(&legs) {
                let leg = leg_at((phase + 0.25 * (1.0 - side)).fract(), side, reach, lowest);
                let turns = [leg.thigh, leg.shin, leg.foot];
                for ((body, turn), first) in bodies.iter().zip(turns).zip([true, false, false]) {
                    let stands = pose[*body];
                    rotations[*body] = if first { turn * stands } else { stands * turn };
                }
            }
            rotations
        };
        let secs = |index: usize| CYCLE_SECS * index as f32 / FRAMES as f32;
        let down = LEG_SHARE * height * (1.0 - lowest);
        let clip = Self {
            name: format!("{} (side steps)", self.name),
            looping: true,
            times: (0..=FRAMES).map(secs).collect(),
            bodies: Arc::clone(&self.bodies),
            root_positions: (0..=FRAMES).map(|i| Vec3::new(0.0, mps * secs(i), height - down)).collect(),
            local_rotations: (0..=FRAMES).map(frame).collect(),
        };
        clip.checked()
    }

    fn leg(&self, side: &str) -> Result<[usize; 3], ClipError> {
        let mut bodies = [0; 3];
        for (body, part) in bodies.iter_mut().zip(["thigh", "shin", "foot"]) {
            let name = format!("{side}_{part}");
            *body = self.bodies.iter().position(|b| *b == name).ok_or_else(|| ClipError::Body {
                clip: self.name.clone(),
                expected: name,
                found: quoted(&self.bodies.join(", ")),
            })?;
        }
        Ok(bodies)
    }
}

/// A leg at a phase of its cycle, which begins as the foot comes down. Standing, it goes from `reach` ahead to as much behind while
/// the hip keeps its height, `lowest` times the leg; swinging, it comes back over the ground.
fn leg_at(phase: f32, side: f32, reach: f32, lowest: f32) -> Leg {
    let swing = ((phase - STANCE) / (1.0 - STANCE)).max(0.0);
    let along = if swing > 0.0 { -(PI * swing).cos() } else { 1.0 - 2.0 * phase / STANCE };
    let roll = side * SPREAD + reach * along;
    let bend = (lowest / roll.cos()).min(1.0).acos() + BEND[1] * (PI * swing).sin();
    let (pitch, level) = (Quat::from_rotation_y(-bend), Quat::from_rotation_x(-roll));
    Leg {
        thigh: Quat::from_rotation_x(roll) * pitch,
        shin: Quat::from_rotation_y(2.0 * bend),
        foot: pitch * level,
    }
}
