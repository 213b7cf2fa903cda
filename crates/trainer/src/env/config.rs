//! Settings of the environment, as a recipe has them. Each part is documented in the file of its name.

use serde::{Deserialize, Serialize};

use super::command::CommandConfig;
use super::exploration::ExplorationConfig;
use super::meetings::MeetingsConfig;
use super::randomisation::RandomisationConfig;
use super::reset::ResetConfig;
use super::reward::RewardConfig;
use super::termination::TerminationConfig;

/// Settings of the environment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EnvironmentConfig {
    /// Characters that are stepped side by side.
    pub num_envs: usize,
    /// Ticks of a rollout.
    pub horizon: usize,
    /// Ticks after which an episode is truncated.
    pub episode_ticks: u32,
    /// When actions have noise.
    pub exploration: ExplorationConfig,
    /// What characters are told to do.
    pub command: CommandConfig,
    /// What that is worth.
    pub reward: RewardConfig,
    /// When an episode fails.
    pub termination: TerminationConfig,
    /// Where episodes start.
    pub reset: ResetConfig,
    /// Ground, pushes and differences of the body.
    pub randomisation: RandomisationConfig,
    /// What characters meet.
    pub meetings: MeetingsConfig,
}

impl Default for EnvironmentConfig {
    fn default() -> Self {
        Self {
            num_envs: 512,
            horizon: 16,
            episode_ticks: 300,
            exploration: ExplorationConfig::default(),
            command: CommandConfig::default(),
            reward: RewardConfig::default(),
            termination: TerminationConfig::default(),
            reset: ResetConfig::default(),
            randomisation: RandomisationConfig::default(),
            meetings: MeetingsConfig::default(),
        }
    }
}
