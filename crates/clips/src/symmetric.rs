//! A gait that is alike to both sides, made of one that limps.

use glam::Quat;

use crate::{Clip, ClipError, between};

impl Clip {
    /// A cycle that is its own mirror image half a cycle later: each frame is half-way between the clip and its mirror image, half a
    /// cycle on. It goes along x.
    ///
    /// People step further with one leg than with the other. A policy that imitates both the clip and its mirror image takes up one of the
    /// two limps.
    ///
    /// # Errors
    /// When the clip does not loop.
    pub fn symmetric(&self) -> Result<Self, ClipError> {
        if !self.looping {
            return Err(ClipError::NotLooping { clip: self.name.clone() });
        }
        let (clip, secs) = (self.along_x(), self.duration());
        let (mirrored, offset) = (clip.mirrored(), clip.cycle_offset());
        let frame = |time: &f32| {
            let later = (time + 0.5 * secs) % secs;
            let ((one, rotations), (other, twins)) = (clip.sample(*time), mirrored.sample(later));
            let sway = 0.5 * (one + other - offset * (time + later) / secs);
            (offset * *time / secs + sway, between(&rotations, &twins, 0.5))
        };
        let (root_positions, local_rotations) = self.times.iter().map(frame).unzip();
        let name = format!("{} (symmetric)", self.name);
        Self { name, root_positions, local_rotations, ..clip }.checked()
    }

    /// The clip turned about the vertical until a cycle goes along x; itself when it stays where it is.
    fn along_x(&self) -> Self {
        let way = self.cycle_offset().truncate();
        let turn = Quat::from_rotation_z(if way.length() > 0.01 { -way.to_angle() } else { 0.0 });
        let mut clip = self.clone();
        clip.root_positions.iter_mut().for_each(|p| *p = turn * *p);
        // A clip that was checked has a root in every frame.
        clip.local_rotations.iter_mut().for_each(|frame| frame[0] = turn * frame[0]);
        clip
    }
}
