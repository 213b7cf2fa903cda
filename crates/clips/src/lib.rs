//! Demonstration clips: files of motion, read, resampled, fitted to the joints of a skeleton and put on the ground.
//!
//! Training imitates clips and evaluation compares with them. A clip must have a body of the same name for each body of
//! the skeleton that has hinges; retargeting is done elsewhere.

mod deepmimic;
mod error;
mod feet;
mod fitted;
mod folder;
mod humanoid;
mod joint_fit;
mod json;
mod leap;
mod motion;
mod npy;
mod pickle;
mod pickle_machine;
mod punch;
mod side_steps;
mod symmetric;

pub use error::ClipError;
pub use fitted::{FitError, Fitted, fit};
pub use folder::{ClipFolder, MOTIONS_VARIABLE, from_bytes, load_file};
pub use joint_fit::JointFit;
pub use leap::Leap;
pub use motion::{MOTION_HZ, Motion, TICK_STRIDE, placed};

use std::sync::Arc;

use files::quoted;
use glam::{Quat, Vec3};

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
    /// Names of the bodies, the root first.
    pub bodies: Arc<[String]>,
    /// Position of the root in the world.
    pub root_positions: Vec<Vec3>,
    /// Rotation of every body in its parent's frame, `[frames][bodies]`; that of the root in the world.
    pub local_rotations: Vec<Vec<Quat>>,
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
        let start = self.times[0];
        for frame in 0..frames {
            // All lists have as many frames as there are times.
            let (expected, found) = (self.bodies.len(), self.local_rotations[frame].len());
            if found != expected || found == 0 {
                return Err(ClipError::Lengths {
                    clip: name(),
                    field: "rotations of a frame",
                    expected,
                    found,
                });
            }
            let finite = self.times[frame].is_finite()
                && self.root_positions[frame].is_finite()
                && self.root_positions[frame].abs().max_element() < 1e4
                && self.local_rotations[frame].iter().all(|q| q.is_finite());
            if !finite {
                return Err(ClipError::NotFinite { clip: name(), frame });
            }
            // Times that differ may become one when they are made to start at zero: rounding.
            if frame > 0 && self.times[frame] - start <= self.times[frame - 1] - start {
                return Err(ClipError::Times { clip: name(), frame });
            }
            let length_error = |q: &Quat| (q.length() - 1.0).abs() > 0.1;
            if let Some(body) = self.local_rotations[frame].iter().position(length_error) {
                return Err(ClipError::Quaternion { clip: name(), frame, body });
            }
        }
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
        // A clip that was checked has two frames or more, here and below.
        self.times[self.times.len() - 1]
    }

    /// Root position and local rotations at a time within the clip, by interpolation.
    #[must_use]
    pub fn sample(&self, time: f32) -> (Vec3, Vec<Quat>) {
        let last = self.times.len() - 1;
        let after = self.times.partition_point(|t| *t <= time).clamp(1, last);
        let (a, b) = (after - 1, after);
        let t = ((time - self.times[a]) / (self.times[b] - self.times[a])).clamp(0.0, 1.0);
        let rotations = between(&self.local_rotations[a], &self.local_rotations[b], t);
        (self.root_positions[a].lerp(self.root_positions[b], t), rotations)
    }

    /// The frames from one second to another, both within the clip. What looped still does: the last of these frames then has to
    /// look like the first.
    ///
    /// # Errors
    /// When the seconds are not an interval within the clip, or fewer than two frames lie in it.
    pub fn excerpt(&self, [from, to]: [f32; 2]) -> Result<Self, ClipError> {
        if !(from >= 0.0 && from < to && to <= self.duration() + 1e-3) {
            let (clip, duration) = (self.name.clone(), self.duration());
            return Err(ClipError::Excerpt { clip, duration, found: [from, to] });
        }
        let first = self.times.partition_point(|t| *t < from - 1e-4);
        let after = self.times.partition_point(|t| *t <= to + 1e-4);
        let excerpt = Self {
            times: self.times[first..after].to_vec(),
            root_positions: self.root_positions[first..after].to_vec(),
            local_rotations: self.local_rotations[first..after].to_vec(),
            ..self.clone()
        };
        excerpt.checked()
    }

    /// The clip and then its last pose, at rest for so many seconds: what it ends in is to be reached and kept. It does not loop.
    ///
    /// # Errors
    /// When the seconds are negative or not finite, or the clip becomes longer than one may be.
    pub fn held(&self, seconds: f32) -> Result<Self, ClipError> {
        let mut held = Self { looping: false, ..self.clone() };
        if seconds != 0.0 {
            // A clip that was checked has frames.
            let last = held.times.len() - 1;
            held.times.push(held.times[last] + seconds);
            held.root_positions.push(held.root_positions[last]);
            held.local_rotations.push(held.local_rotations[last].clone());
        }
        held.checked()
    }

    /// How far one cycle moves the root, horizontally.
    #[must_use]
    pub fn cycle_offset(&self) -> Vec3 {
        (self.root_positions[self.root_positions.len() - 1] - self.root_positions[0])
            * Vec3::new(1.0, 1.0, 0.0)
    }

    /// Every frame this much of the way, in [0, 1], to a pose of `other`, which has the same bodies: how it begins, half-way to its
    /// mirror image. The way of the root shrinks as much. A smaller and slower motion between this one and that pose.
    ///
    /// # Errors
    /// When the bodies of `other` are not the same in the same order.
    pub fn towards(&self, other: &Self, share: f32) -> Result<Self, ClipError> {
        if self.bodies != other.bodies {
            return Err(ClipError::Bodies {
                clip: other.name.clone(),
                expected: quoted(&self.bodies.join(", ")),
                found: quoted(&other.bodies.join(", ")),
            });
        }
        // Clips that were checked have frames, and a rotation of each body in every one; so below.
        let (first, mirrored) = (other.root_positions[0], &other.mirrored().local_rotations[0]);
        let rotations = between(&other.local_rotations[0], mirrored, 0.5);
        let root =
            |p: &Vec3| Vec3::new((1.0 - share) * p.x, (1.0 - share) * p.y, p.z + share * (first.z - p.z));
        let turn = |frame: &Vec<Quat>| between(frame, &rotations, share);
        Ok(Self {
            name: format!("{} towards {}", self.name, other.name),
            root_positions: self.root_positions.iter().map(root).collect(),
            local_rotations: self.local_rotations.iter().map(turn).collect(),
            ..self.clone()
        })
    }

    /// The same backwards: walking ahead becomes walking back.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let end = self.duration();
        Self {
            name: format!("{} (reversed)", self.name),
            times: self.times.iter().rev().map(|t| end - t).collect(),
            root_positions: self.root_positions.iter().rev().copied().collect(),
            local_rotations: self.local_rotations.iter().rev().cloned().collect(),
            ..self.clone()
        }
    }

    /// The same played faster or slower, by a factor above 0.
    ///
    /// # Errors
    /// When it becomes too long, or so short that times are no longer apart.
    pub fn at_pace(&self, factor: f32) -> Result<Self, ClipError> {
        Self { times: self.times.iter().map(|t| t / factor).collect(), ..self.clone() }.checked()
    }

    /// The mirror image: y negated, and bodies with `left` in their names swapped with those with `right`.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let flip = |q: Quat| Quat::from_xyzw(-q.x, q.y, -q.z, q.w);
        let twins: Vec<usize> = self.bodies.iter().enumerate().map(|(i, name)| self.twin(i, name)).collect();
        let mirror =
            |rotations: &Vec<Quat>| -> Vec<Quat> { twins.iter().map(|i| flip(rotations[*i])).collect() };
        Self {
            name: format!("{} (mirrored)", self.name),
            root_positions: self.root_positions.iter().map(|p| Vec3::new(p.x, -p.y, p.z)).collect(),
            local_rotations: self.local_rotations.iter().map(mirror).collect(),
            ..self.clone()
        }
    }

    /// The body whose motion a body has in the mirror; itself for one in the middle.
    fn twin(&self, index: usize, name: &str) -> usize {
        let other = twin_name(name);
        other.and_then(|other| self.bodies.iter().position(|body| *body == other)).unwrap_or(index)
    }
}

/// Rotations of all bodies this share of the way, in [0, 1], from one pose to another.
fn between(from: &[Quat], to: &[Quat], share: f32) -> Vec<Quat> {
    from.iter().zip(to).map(|(from, to)| from.slerp(*to, share)).collect()
}

/// The name of the body or hinge on the other side: with `left` where this one has `right`, and the other way round. `None` for one in the
/// middle.
#[must_use]
pub fn twin_name(name: &str) -> Option<String> {
    match (name.contains("left"), name.contains("right")) {
        (true, false) => Some(name.replace("left", "right")),
        (false, true) => Some(name.replace("right", "left")),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
