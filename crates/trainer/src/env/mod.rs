//! The environments that policies learn in, in the parts of the field: [`observation`](Env::observe_into), [`Command`],
//! [`reward`](RewardConfig), [`termination`](TerminationConfig), [`reset`](ResetConfig).
//!
//! Observation, action and discriminator features are policy-core's, physics is physics-bridge's.

mod averaged;
mod command;
mod config;
mod demonstrations;
#[expect(clippy::module_inception, reason = "the environment itself, beside its parts")]
mod env;
mod exploration;
mod graph;
#[cfg(test)]
mod made_up;
mod meetings;
mod mirrored;
mod normalisers;
mod observation;
mod randomisation;
mod reset;
mod reward;
mod termination;
mod track_clip;
mod tracking;
mod vec_env;

pub use command::{Command, CommandConfig, DT_SECS, StrafeConfig};
pub use config::EnvironmentConfig;
pub use demonstrations::{ClipPhase, Demonstrations, ReferenceState};
pub use env::{Env, EnvContext, Episode};
pub use exploration::ExplorationConfig;
pub use graph::{GraphNode, TrainingGraph};
pub use meetings::MeetingsConfig;
pub(crate) use meetings::{MET, WALK};
pub use mirrored::{MirrorError, mirror_of, mirrored_joints};
pub use normalisers::Normalisers;
pub use randomisation::RandomisationConfig;
pub use reset::{HandOver, HandOverConfig, InPlayConfig, OutOf, RUNS_MPS, ResetConfig};
pub use reward::{
    Pace, RewardConfig, RewardTerms, Task, foot_slip_mps, paid_velocity, standing_reward, target_reward,
};
pub use termination::{Termination, TerminationConfig, TerminationHeights, TerminationRule};
pub use tracking::TrackedState;
pub use vec_env::{EpisodeReport, NodeReport, REPORTED_NODES, VecEnv};
