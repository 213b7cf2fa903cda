//! Clips on the ground of the physics: fitted, lifted, and what each pose senses there.

use physics_bridge::{Character, Model, PoseError};
use policy_core::CharacterState;

use super::feet::put_on_ground;
use crate::{Clip, ClipError, Motion};

/// Why clips can't be made ready.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A clip is wrong.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// A fitted pose is refused by the physics.
    #[error("clip {clip}: pose {index} is no pose of the character")]
    Pose {
        /// Name of the clip.
        clip: String,
        /// Index of the pose.
        index: usize,
        /// What is wrong with it.
        source: PoseError,
    },
}

/// A clip on the ground: its motion, and state and clearance of every pose.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The motion, lifted.
    pub motion: Motion,
    /// What each pose senses, by the physics' forward kinematics.
    pub states: Vec<CharacterState>,
    /// Height of each pose's lowest point, metres; negative inside the ground.
    pub clearances: Vec<f32>,
    /// How far the clip was lifted, metres.
    pub lift: f32,
}

/// Fits a clip, keeps the tips of its feet out of the ground, and lifts it so that a fifth of its poses touch the ground or sink
/// in.
///
/// # Errors
/// When the clip is too short, lacks a body, or the physics refuses a pose.
pub fn fit(clip: &Clip, model: &Model) -> Result<Fitted, FitError> {
    let mut motion = Motion::fit(clip, model.skeleton())?;
    let mut character = Character::new(model);
    for (index, pose) in motion.poses.iter_mut().enumerate() {
        put_on_ground(pose, &mut character).map_err(refused(&clip.name, index))?;
    }
    motion.differentiate();
    let mut lowest = states(&motion, model)?.1;
    lowest.sort_by(f32::total_cmp);
    // A motion has two poses or more, so a fifth of their number is an index.
    let lift = -lowest[lowest.len() / 5];
    motion.lift(f64::from(lift));
    let (states, clearances) = states(&motion, model)?;
    Ok(Fitted { motion, states, clearances, lift })
}

/// State and clearance of every pose by the physics' forward kinematics.
fn states(motion: &Motion, model: &Model) -> Result<(Vec<CharacterState>, Vec<f32>), FitError> {
    let mut character = Character::new(model);
    let mut states = vec![CharacterState::new(model.skeleton()); motion.poses.len()];
    let mut clearances = Vec::with_capacity(motion.poses.len());
    for (index, (pose, state)) in motion.poses.iter().zip(&mut states).enumerate() {
        character.set_pose(&pose.qpos, &pose.qvel).map_err(refused(&motion.name, index))?;
        character.sense_into(state);
        clearances.push(character.clearance());
    }
    Ok((states, clearances))
}

/// The error of a clip's pose that the physics refuses.
fn refused(clip: &str, index: usize) -> impl FnOnce(PoseError) -> FitError {
    move |source| FitError::Pose { clip: clip.into(), index, source }
}
