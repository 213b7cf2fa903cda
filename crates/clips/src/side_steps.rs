//! Steps aside, made by rule: people who are filmed for clips hardly ever walk sideways.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Quat, Vec3};

use crate::error::find_body;
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
pub(crate) const LEG_SHARE: f32 = 0.95;

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
        let legs = [self.leg("left")?, self.leg("right")?];
        let reach = 0.5 * mps * CYCLE_SECS * STANCE / (LEG_SHARE * height);
        let lowest = BEND[0].cos() * (SPREAD + reach).cos();
        let frame = |index: usize| {
            let phase = index as f32 / FRAMES as f32;
            let mut rotations = pose.clone();
            for (side, [thigh, shin, foot]) in [1.0, -1.0].into_iter().zip(legs) {
                let leg = leg_at((phase + 0.25 * (1.0 - side)).fract(), side, reach, lowest);
                rotations[thigh] = leg.thigh * pose[thigh];
                rotations[shin] = pose[shin] * leg.shin;
                rotations[foot] = pose[foot] * leg.foot;
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

    /// Thigh, shin and foot of a side.
    pub(crate) fn leg(&self, side: &str) -> Result<[usize; 3], ClipError> {
        let find = |part: &str| find_body(&self.name, &self.bodies, &format!("{side}_{part}"));
        Ok([find("thigh")?, find("shin")?, find("foot")?])
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
