//! A clip on the joints of the model: generalised positions and velocities at 120 Hz, cycles closed.

use glam::{DQuat, DVec3, Quat};
use physics_bridge::Pose;
use policy_core::Skeleton;

use super::joint_fit::JointFit;
use super::{Clip, ClipError};

/// Poses per second of a [`Motion`] (near it: a cycle holds a whole number of them).
pub const MOTION_HZ: f32 = 120.0;

/// Poses from one control tick to the next.
pub const TICK_STRIDE: usize = 4;

/// A clip fitted to the joints and resampled.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Name of the clip.
    pub name: String,
    /// True when the last pose continues with the first.
    pub looping: bool,
    /// Poses at [`MOTION_HZ`].
    pub poses: Vec<Pose>,
    /// How far a cycle moves the root, metres.
    pub cycle_offset: [f64; 2],
    /// Seconds between poses.
    pub dt_secs: f64,
    /// How far the clip left the joint limits, radians, and where; such angles were clamped.
    pub outside_limits: (f32, String),
}

impl Motion {
    /// Fits `clip` to a skeleton and resamples it.
    ///
    /// # Errors
    /// When the clip is shorter than two poses, or lacks a body of the skeleton that has hinges.
    pub fn fit(clip: &Clip, skeleton: &Skeleton) -> Result<Self, ClipError> {
        let intervals = (clip.duration() * MOTION_HZ).round() as usize;
        if intervals < 2 {
            return Err(ClipError::FrameCount { clip: clip.name.clone(), found: intervals });
        }
        // A clip that was checked lasts at most 600 s and has a root in every frame; there are two poses or more.
        let dt = f64::from(clip.duration()) / intervals as f64;
        let count = if clip.looping { intervals } else { intervals + 1 };
        let mut fit = JointFit::new(skeleton, &clip.name, &clip.bodies)?;
        let poses = (0..count)
            .map(|i| {
                let (position, rotations) = clip.sample((i as f64 * dt) as f32);
                let angles = fit.angles(&rotations);
                let mut pose = Pose::new(skeleton);
                set_qpos(&mut pose.qpos, position.as_dvec3(), rotations[0], &angles);
                pose
            })
            .collect();
        // A skeleton has a joint, and `worst` gives the index of one.
        let (worst, joint) = fit.worst();
        let offset = if clip.looping { clip.cycle_offset().as_dvec3() } else { DVec3::ZERO };
        let mut motion = Self {
            name: clip.name.clone(),
            looping: clip.looping,
            poses,
            cycle_offset: [offset.x, offset.y],
            dt_secs: dt,
            outside_limits: (worst, skeleton.joints()[joint].name.clone()),
        };
        motion.differentiate();
        Ok(motion)
    }

    /// Works out the velocities of all poses from their positions.
    pub fn differentiate(&mut self) {
        let count = self.poses.len();
        let offset = DVec3::new(self.cycle_offset[0], self.cycle_offset[1], 0.0);
        for i in 0..count {
            let (before, after, span) = neighbours(i, count, self.looping);
            let mut from = self.poses[before].qpos.clone();
            let mut to = self.poses[after].qpos.clone();
            shift(&mut from, offset * if before > i { -1.0 } else { 0.0 });
            shift(&mut to, offset * if after < i { 1.0 } else { 0.0 });
            set_velocity(&mut self.poses[i].qvel, &from, &to, span * self.dt_secs);
        }
    }

    /// Index of the pose `ticks` control ticks before pose `index`; stops at the start of a clip that doesn't loop.
    #[must_use]
    pub fn earlier(&self, index: usize, ticks: usize) -> usize {
        // `fit` makes two poses or more, here and in `mean_speed`.
        let back = ticks * TICK_STRIDE;
        if self.looping {
            (index + self.poses.len() * (back / self.poses.len() + 1) - back) % self.poses.len()
        } else {
            index.saturating_sub(back)
        }
    }

    /// Lifts every pose by `metres`.
    pub fn lift(&mut self, metres: f64) {
        self.poses.iter_mut().for_each(|p| p.qpos[2] += metres);
    }

    /// Mean horizontal speed, metres per second.
    #[must_use]
    pub fn mean_speed(&self) -> f32 {
        let (first, last) = (&self.poses[0].qpos, &self.poses[self.poses.len() - 1].qpos);
        let steps = (self.poses.len() - 1) as f64;
        ((last[0] - first[0]).hypot(last[1] - first[1]) / (steps * self.dt_secs)) as f32
    }
}

/// `pose` turned about the vertical by `radians` and with the root over `x`, `y`.
#[must_use]
pub fn placed(pose: &Pose, x: f64, y: f64, radians: f64) -> Pose {
    let mut placed = pose.clone();
    (placed.qpos[0], placed.qpos[1]) = (x, y);
    let turn = DQuat::from_rotation_z(radians);
    let q = turn * DQuat::from_xyzw(pose.qpos[4], pose.qpos[5], pose.qpos[6], pose.qpos[3]);
    placed.qpos[3..7].copy_from_slice(&[q.w, q.x, q.y, q.z]);
    let v = turn * DVec3::new(pose.qvel[0], pose.qvel[1], pose.qvel[2]);
    placed.qvel[..3].copy_from_slice(&v.to_array());
    placed
}

fn set_qpos(qpos: &mut [f64], position: DVec3, rotation: Quat, angles: &[f32]) {
    qpos[..3].copy_from_slice(&position.to_array());
    let q = rotation.as_dquat().normalize();
    qpos[3..7].copy_from_slice(&[q.w, q.x, q.y, q.z]);
    qpos[7..].iter_mut().zip(angles).for_each(|(q, a)| *q = f64::from(*a));
}

/// The poses before and after `i` and how many steps lie between them.
fn neighbours(i: usize, count: usize, looping: bool) -> (usize, usize, f64) {
    if looping {
        ((i + count - 1) % count, (i + 1) % count, 2.0)
    } else {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(count - 1));
        (before, after, (after - before) as f64)
    }
}

fn shift(qpos: &mut [f64], by: DVec3) {
    qpos[0] += by.x;
    qpos[1] += by.y;
}

fn set_velocity(qvel: &mut [f64], from: &[f64], to: &[f64], secs: f64) {
    for k in 0..3 {
        qvel[k] = (to[k] - from[k]) / secs;
    }
    let quat = |q: &[f64]| DQuat::from_xyzw(q[4], q[5], q[6], q[3]);
    let mut turn = quat(from).conjugate() * quat(to);
    if turn.w < 0.0 {
        turn = -turn;
    }
    qvel[3..6].copy_from_slice(&(turn.to_scaled_axis() / secs).to_array());
    for ((v, to), from) in qvel[6..].iter_mut().zip(&to[7..]).zip(&from[7..]) {
        let tau = std::f64::consts::TAU;
        let turn = to - from;
        *v = (turn - tau * (turn / tau).round()) / secs;
    }
}
