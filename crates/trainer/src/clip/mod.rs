//! Demonstration clips: files of motion on the humanoid's skeleton, read, resampled and fitted to its joints.
//!
//! Refuses anything that is not on the 15-body skeleton; retargeting is done elsewhere.

mod deepmimic;
mod error;
mod fit;
mod folder;
mod json;
mod motion;
mod npy;
mod pickle;
mod pickle_machine;

pub use error::ClipError;
pub use fit::{JointFit, JointLimits};
pub use folder::{ClipFolder, MOTIONS_VARIABLE, load_file};
pub use motion::{MOTION_HZ, Motion, TICK_STRIDE, placed};

use glam::{Quat, Vec3};
use policy_core::BODY_COUNT;

/// Longest clip that is read, in frames.
pub const MAX_FRAMES: usize = 100_000;

/// A clip as its file has it. Metres, seconds, z up, facing along x.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name, that of its file without the ending.
    pub name: String,
    /// True when the last frame continues with the first, the root moved on.
    pub looping: bool,
    /// Time of every frame, ascending from zero.
    pub times: Vec<f32>,
    /// Position of the pelvis in the world.
    pub root_positions: Vec<Vec3>,
    /// Rotation of every body in its parent's frame; entry 0 is the pelvis in the world.
    pub local_rotations: Vec<[Quat; BODY_COUNT]>,
}

impl Clip {
    /// Checks what every format has in common: lengths, finite numbers, ascending times, unit quaternions.
    ///
    /// # Errors
    /// Names the first thing that is wrong.
    pub fn checked(mut self) -> Result<Self, ClipError> {
        let name = || self.name.clone();
        let frames = self.times.len();
        if !(2..=MAX_FRAMES).contains(&frames) {
            return Err(ClipError::FrameCount { clip: name(), found: frames });
        }
        for (field, found) in
            [("root positions", self.root_positions.len()), ("local rotations", self.local_rotations.len())]
        {
            if found != frames {
                return Err(ClipError::Lengths { clip: name(), field, expected: frames, found });
            }
        }
        for frame in 0..frames {
            let finite = self.times[frame].is_finite()
                && self.root_positions[frame].is_finite()
                && self.root_positions[frame].abs().max_element() < 1e4
                && self.local_rotations[frame].iter().all(|q| q.is_finite());
            if !finite {
                return Err(ClipError::NotFinite { clip: name(), frame });
            }
            if frame > 0 && self.times[frame] <= self.times[frame - 1] {
                return Err(ClipError::Times { clip: name(), frame });
            }
            let length_error = |q: &Quat| (q.length() - 1.0).abs() > 0.1;
            if let Some(body) = self.local_rotations[frame].iter().position(length_error) {
                return Err(ClipError::Quaternion { clip: name(), frame, body });
            }
        }
        let start = self.times[0];
        self.times.iter_mut().for_each(|t| *t -= start);
        for rotations in &mut self.local_rotations {
            rotations.iter_mut().for_each(|q| *q = q.normalize());
        }
        if self.duration() > 600.0 {
            return Err(ClipError::Duration { clip: self.name.clone(), found: self.duration() });
        }
        Ok(self)
    }

    /// Seconds from the first to the last frame.
    #[must_use]
    pub fn duration(&self) -> f32 {
        self.times[self.times.len() - 1]
    }

    /// Pelvis position and local rotations at a time within the clip, by interpolation.
    #[must_use]
    pub fn sample(&self, time: f32) -> (Vec3, [Quat; BODY_COUNT]) {
        let last = self.times.len() - 1;
        let after = self.times.partition_point(|t| *t <= time).clamp(1, last);
        let (a, b) = (after - 1, after);
        let t = ((time - self.times[a]) / (self.times[b] - self.times[a])).clamp(0.0, 1.0);
        let rotations =
            std::array::from_fn(|i| self.local_rotations[a][i].slerp(self.local_rotations[b][i], t));
        (self.root_positions[a].lerp(self.root_positions[b], t), rotations)
    }

    /// How far one cycle moves the root, horizontally.
    #[must_use]
    pub fn cycle_offset(&self) -> Vec3 {
        (self.root_positions[self.root_positions.len() - 1] - self.root_positions[0])
            * Vec3::new(1.0, 1.0, 0.0)
    }

    /// Every frame this much of the way, in [0, 1], to a pose of `other`: how it begins, half-way to its mirror image. The way
    /// that is gone shrinks as much. A smaller and slower motion between this one and that pose.
    #[must_use]
    pub fn towards(&self, other: &Self, share: f32) -> Self {
        let (first, mirrored) = (other.root_positions[0], other.mirrored().local_rotations[0]);
        let rotations: [Quat; BODY_COUNT] =
            std::array::from_fn(|i| other.local_rotations[0][i].slerp(mirrored[i], 0.5));
        let root =
            |p: &Vec3| Vec3::new((1.0 - share) * p.x, (1.0 - share) * p.y, p.z + share * (first.z - p.z));
        let turn = |frame: &[Quat; BODY_COUNT]| std::array::from_fn(|i| frame[i].slerp(rotations[i], share));
        Self {
            name: format!("{} towards {}", self.name, other.name),
            root_positions: self.root_positions.iter().map(root).collect(),
            local_rotations: self.local_rotations.iter().map(turn).collect(),
            ..self.clone()
        }
    }

    /// The mirror image: left and right swapped, y turned round.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let flip = |q: Quat| Quat::from_xyzw(-q.x, q.y, -q.z, q.w);
        let mirror =
            |rotations: &[Quat; BODY_COUNT]| std::array::from_fn(|i| flip(rotations[MIRRORED_BODY[i]]));
        Self {
            name: format!("{} (mirrored)", self.name),
            root_positions: self.root_positions.iter().map(|p| Vec3::new(p.x, -p.y, p.z)).collect(),
            local_rotations: self.local_rotations.iter().map(mirror).collect(),
            ..self.clone()
        }
    }
}

/// The body whose motion a body takes in the mirror.
const MIRRORED_BODY: [usize; BODY_COUNT] = [0, 1, 2, 6, 7, 8, 3, 4, 5, 12, 13, 14, 9, 10, 11];

#[cfg(test)]
pub(crate) mod tests;
