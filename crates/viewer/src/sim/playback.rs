//! Plays a clip of poses instead of the simulation: forward kinematics alone, nothing is stepped.

use std::path::Path;

use physics::PhysicsCharacter;
use physics_bridge::{BodyPoses, Character, Model, Pose};

use super::bodies::Bodies;
use super::{Simulation, interpolated};
use crate::pose_clip::{PoseClip, PoseClipError};

/// A clip and how far it has been played, round and round.
#[derive(Clone, Debug)]
pub struct Playback {
    poses: PoseClip,
    /// Where the bodies are in each pose.
    bodies: Vec<BodyPoses>,
    /// Velocities of a body at rest.
    at_rest: Vec<f64>,
    tick_secs: f64,
    ticks: u64,
}

impl Playback {
    /// Reads a file of poses and works out where the bodies of `model` are in each.
    ///
    /// # Errors
    /// When the file is no good, or holds a pose that no character can take.
    pub fn load(path: &Path, model: &Model) -> Result<Self, PoseClipError> {
        let Pose { qpos, qvel: at_rest } = Pose::new(model.skeleton());
        let poses = PoseClip::load(path, qpos.len())?;
        let mut character = Character::new(model);
        let mut bodies = vec![BodyPoses::new(model.skeleton()); poses.qpos.len()];
        for (row, (qpos, bodies)) in poses.qpos.iter().zip(&mut bodies).enumerate() {
            character.set_pose(qpos, &at_rest).map_err(|source| PoseClipError::Pose {
                path: path.to_owned(),
                row,
                source,
            })?;
            character.poses_into(bodies);
        }
        let tick_secs = 1.0 / f64::from(model.control_hz());
        Ok(Self { poses, bodies, at_rest, tick_secs, ticks: 0 })
    }

    /// Name of the clip.
    #[must_use]
    pub fn clip(&self) -> &str {
        &self.poses.clip
    }

    /// Poses a second.
    #[must_use]
    pub fn hz(&self) -> f64 {
        self.poses.hz
    }

    /// Number of poses.
    #[must_use]
    pub fn pose_count(&self) -> usize {
        self.bodies.len()
    }

    /// Length of the clip, seconds: each pose lasts until the next, the last one as long as the others.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.bodies.len() as f64 / self.poses.hz
    }

    /// Time in the clip `alpha` of the way into the last tick, seconds.
    #[must_use]
    pub fn secs(&self, alpha: f32) -> f64 {
        let ticks = (self.ticks as f64 - 1.0 + f64::from(alpha)).max(0.0);
        (ticks * self.tick_secs).rem_euclid(self.duration())
    }

    /// Where the bodies are `alpha` of the way into the last tick. Between two poses positions are interpolated
    /// linearly and rotations on the sphere; from the last pose to the first it jumps.
    #[must_use]
    pub fn poses(&self, alpha: f32) -> BodyPoses {
        let (row, share) = self.place(alpha);
        let next = (row + 1).min(self.bodies.len() - 1);
        interpolated(&self.bodies[row], &self.bodies[next], share)
    }

    /// True when the last tick has gone on from the end to the start.
    #[must_use]
    pub fn has_restarted(&self) -> bool {
        let cycle = |ticks: u64| (ticks as f64 * self.tick_secs / self.duration()).floor();
        self.ticks > 0 && cycle(self.ticks) > cycle(self.ticks - 1)
    }

    /// The pose before a time, and the share of the way to the next.
    fn place(&self, alpha: f32) -> (usize, f32) {
        let at = self.secs(alpha) * self.poses.hz;
        let row = (at as usize).min(self.bodies.len() - 1);
        (row, (at - row as f64).clamp(0.0, 1.0) as f32)
    }
}

impl Simulation {
    /// Shows a clip from now on, on the empty floor: the player's character is posed, nothing is simulated.
    pub fn play(&mut self, playback: Playback) {
        self.playback = Some(playback);
        self.show_pose(0);
    }

    /// The clip that is shown instead of the simulation.
    #[must_use]
    pub fn playback(&self) -> Option<&Playback> {
        self.playback.as_ref()
    }

    /// Where the bodies of a character are `alpha` of the way into the last tick.
    ///
    /// # Panics
    /// When there is none of that index.
    #[must_use]
    pub fn poses(&self, index: usize, alpha: f32) -> BodyPoses {
        match &self.playback {
            Some(playback) if index == 0 => playback.poses(alpha),
            _ => self.steered[index].poses(alpha),
        }
    }

    /// Puts the player's character where the clip has it after so many ticks.
    pub(super) fn show_pose(&mut self, ticks: u64) {
        let Some(playback) = &mut self.playback else { return };
        playback.ticks = ticks;
        let (row, _) = playback.place(1.0);
        let Bodies::Apart(crowd) = &mut self.bodies else { return };
        // Every pose was tried when the clip was loaded.
        if crowd.character_mut(0).set_pose(&playback.poses.qpos[row], &playback.at_rest).is_ok() {
            self.steered[0].restart(self.bodies.of(0));
        }
    }

    /// One tick of the clip; false when none is played.
    pub(super) fn tick_playback(&mut self) -> bool {
        let Some(ticks) = self.playback.as_ref().map(|p| p.ticks + 1) else { return false };
        self.show_pose(ticks);
        self.ticks += 1;
        true
    }
}
