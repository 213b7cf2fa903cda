//! How a policy moves: pose error against its clip, sliding feet, and whether left and right do the same.

use std::sync::Arc;

use clips::{Clip, FitError, TICK_STRIDE, fit};
use glam::Vec3;
use physics::Model;
use policy_core::{CharacterPack, CharacterState, Heading, NodeId, Skeleton};
use serde::Serialize;

use super::eval_character::{EvalCharacter, SETTLE_SECS};
use crate::trial::TICK_SECS;

/// A foot whose frame is lower than this above the ground stands on it, metres; flat on the floor it is at 0.05.
pub const STANCE_METRES: f32 = 0.075;

/// Seconds that a policy is watched.
const WATCHED_SECS: f32 = 8.0;

/// Numbers of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MotionReport {
    /// Mean horizontal speed of feet that stand, metres per second.
    pub foot_slide_mps: f32,
    /// Share of time that the left foot stands.
    pub left_stance: f32,
    /// Share of time that the right foot stands.
    pub right_stance: f32,
    /// Landings of either foot per second.
    pub steps_per_second: f32,
    /// Mean horizontal speed of the pelvis, metres per second.
    pub speed_mps: f32,
}

impl MotionReport {
    /// Numbers of a motion sampled at the control rate.
    #[must_use]
    pub fn of(skeleton: &Skeleton, states: &[CharacterState]) -> Self {
        let mut report = Self::default();
        let secs = (states.len().saturating_sub(1)).max(1) as f32 * TICK_SECS;
        let (mut slide, mut stood) = (0.0, 0.0);
        let shares = [("left_foot", &mut report.left_stance), ("right_foot", &mut report.right_stance)];
        for (foot, share) in shares {
            let Some(foot) = skeleton.body_named(foot) else { continue };
            let height = |s: &CharacterState| s.height_of(foot);
            let mut count = 0.0;
            for pair in states.windows(2) {
                let (was, is) = (height(&pair[0]) < STANCE_METRES, height(&pair[1]) < STANCE_METRES);
                report.steps_per_second += f32::from(u8::from(!was && is)) / secs;
                if was && is {
                    let moved = pair[1].body(foot).position - pair[0].body(foot).position;
                    slide += moved.truncate().length() / TICK_SECS;
                    stood += 1.0;
                    count += 1.0;
                }
            }
            *share = count * TICK_SECS / secs;
        }
        report.foot_slide_mps = slide / f32::max(stood, 1.0);
        let place = |s: &CharacterState| s.root().position.truncate();
        let way: f32 = states.windows(2).map(|p| (place(&p[1]) - place(&p[0])).length()).sum();
        report.speed_mps = way / secs;
        report
    }
}

/// States of a policy that goes straight ahead, after it has settled; empty when it falls.
#[must_use]
pub fn watch(model: &Model, pack: &Arc<CharacterPack>, node: NodeId) -> Vec<CharacterState> {
    let mut eval = EvalCharacter::at(model, pack, node);
    let mut states = Vec::new();
    for tick in 0..((SETTLE_SECS + WATCHED_SECS) / TICK_SECS) as u32 {
        let command = eval.ahead(node);
        if !eval.tick(&command) || eval.controller.report().fallen {
            return Vec::new();
        }
        if tick as f32 * TICK_SECS >= SETTLE_SECS {
            states.push(eval.state.clone());
        }
    }
    states
}

/// States of a clip at the control rate, twice over when it loops.
///
/// # Errors
/// When the clip can't be fitted.
pub fn clip_states(model: &physics_bridge::Model, clip: &Clip) -> Result<Vec<CharacterState>, FitError> {
    let fitted = fit(clip, model)?;
    let count = if clip.looping { 2 * fitted.states.len() } else { fitted.states.len() };
    let [x, y] = fitted.motion.cycle_offset.map(|o| o as f32);
    let state = |i: usize| {
        let mut state = fitted.states[i % fitted.states.len()].clone();
        let cycle = (i / fitted.states.len()) as f32;
        state.bodies.iter_mut().for_each(|b| b.position += cycle * Vec3::new(x, y, 0.0));
        state
    };
    Ok((0..count).step_by(TICK_STRIDE).map(state).collect())
}

/// Mean distance of the bodies, relative to the pelvis and in its heading frame, between a motion and the best stretch of
/// a clip under dynamic time warping, metres. Each frame of the motion is used; the clip may begin and end anywhere, and
/// goes round.
#[must_use]
pub fn pose_error(motion: &[CharacterState], clip: &[CharacterState]) -> f32 {
    if motion.is_empty() || clip.is_empty() {
        return f32::NAN;
    }
    let (a, b): (Vec<_>, Vec<_>) = (motion.iter().map(shape).collect(), clip.iter().map(shape).collect());
    let cost = |i: usize, j: usize| {
        a[i].iter().zip(&b[j]).map(|(p, q): (&Vec3, &Vec3)| p.distance(*q)).sum::<f32>() / a[i].len() as f32
    };
    let mut row: Vec<f32> = (0..b.len()).map(|j| cost(0, j)).collect();
    for i in 1..a.len() {
        let mut next = vec![0.0; b.len()];
        for j in 0..b.len() {
            let back = |k: usize| row[(j + b.len() - k) % b.len()];
            // Stay, go on by a frame, or skip one: speeds up to twice the clip's.
            next[j] = cost(i, j) + back(0).min(back(1)).min(back(2));
        }
        row = next;
    }
    row.into_iter().fold(f32::INFINITY, f32::min) / a.len() as f32
}

fn shape(state: &CharacterState) -> Vec<Vec3> {
    let pelvis = state.root();
    let heading = Heading::from_rotation(pelvis.rotation);
    state.bodies[1..].iter().map(|b| heading.heading_from_world(b.position - pelvis.position)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn still() -> CharacterState {
        CharacterState::new(&Skeleton::humanoid())
    }

    fn swing(ticks: usize, rate: f32) -> Vec<CharacterState> {
        let state = |i: usize| {
            let mut state = still();
            state.bodies[11].position.x = (i as f32 * rate).sin();
            state
        };
        (0..ticks).map(state).collect()
    }

    #[test]
    fn a_motion_has_no_error_against_itself_or_a_slower_self() {
        let cycle = swing(63, 0.1);
        assert!(pose_error(&cycle, &cycle) < 1e-6);
        assert!(pose_error(&swing(40, 0.15), &cycle) < 0.01);
        assert!(pose_error(&vec![still(); 20], &cycle) < 0.01);
        assert!(pose_error(&[], &cycle).is_nan());
    }

    #[test]
    fn a_foot_that_is_dragged_slides() {
        let mut states = vec![still(); 31];
        let skeleton = Skeleton::humanoid();
        let [left, right] = ["left_foot", "right_foot"].map(|name| skeleton.body_named(name).unwrap());
        for (i, state) in states.iter_mut().enumerate() {
            state.body_mut(left).position = Vec3::new(0.5 * i as f32 * TICK_SECS, 0.0, 0.05);
            state.body_mut(right).position = Vec3::new(0.0, 0.0, 0.3);
        }
        let report = MotionReport::of(&skeleton, &states);
        assert!((report.foot_slide_mps - 0.5).abs() < 1e-3);
        assert!(report.left_stance > 0.99 && report.right_stance == 0.0);
    }
}
