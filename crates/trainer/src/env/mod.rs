//! The characters that learn: start states, targets, blends, pushes, rewards and the ends of episodes.
//!
//! Observation, action and discriminator features are policy-core's, physics is physics-bridge's.

mod agent;
mod command;
mod config;
mod course;
mod demonstrations;
mod fallen;
mod feet;
mod fitted;
mod imitation;
mod normalisers;
mod population;
mod reward;

pub use agent::{Agent, Episode, PUSH_SECS, Recovery};
pub use command::{Command, DT_SECS};
pub use config::{After, EnvironmentConfig, Fall, Start, Task};
pub use course::{Course, CourseNode, Place};
pub use demonstrations::{Demonstrations, Moment, StartPose};
pub use fallen::{FallRule, stands};
pub use fitted::{Fitted, SourceError, fit};
pub use imitation::Likeness;
pub use normalisers::Normalisers;
pub use population::{NodeReport, Population, PopulationReport, REPORTED_NODES, Stage};
pub use reward::{Manner, RewardTerms, slide_mps, standing_reward, target_reward};
