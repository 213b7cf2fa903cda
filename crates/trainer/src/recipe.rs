//! Recipes: one TOML file for each skill, saying all that a run depends on but its seed.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::amp::DiscriminatorConfig;
use crate::env::EnvironmentConfig;
use crate::ppo::PpoConfig;

mod checks;

/// How one skill is trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Name of the skill: node of the graph, folder of the run.
    pub skill: String,
    /// Skill it starts from and is pulled towards.
    #[serde(default)]
    pub parent: Option<String>,
    /// True to train the whole straight line from the parent, not only its end.
    #[serde(default)]
    pub edge: bool,
    /// Paths of skills that are trained together, each on from its own run and with its own clips; then the recipe has
    /// no parent and no clips, and its name is that of the run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paths: Vec<Vec<String>>,
    /// Edges of those paths whose middle has a style of its own: the faster skill's clip half-way to the slower one's pose.
    /// Without it the middle is judged by both ends, and stopping and going by turns suits both.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub halfway: Vec<[String; 2]>,
    /// Skills of those paths that stay as they are; the others learn to blend with them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frozen: Vec<String>,
    /// Demonstration clips.
    #[serde(default)]
    pub clips: Vec<ClipShare>,
    /// Phases in order.
    pub phases: Vec<Phase>,
    /// The environment.
    #[serde(default)]
    pub environment: EnvironmentConfig,
    /// The policy's optimisation.
    #[serde(default)]
    pub ppo: PpoConfig,
    /// The discriminator.
    #[serde(default)]
    pub discriminator: DiscriminatorConfig,
}

/// A clip and how often it is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClipShare {
    /// Name of the clip's file, without its ending.
    pub name: String,
    /// Its share among the clips of the recipe.
    #[serde(default = "one")]
    pub share: f32,
    /// False to take the clip as it is, without its mirror image.
    #[serde(default = "yes")]
    pub mirror: bool,
}

fn yes() -> bool {
    true
}

fn one() -> f32 {
    1.0
}

/// A stretch of training with its own weights of reward.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// Samples of this phase: ticks of all characters together.
    pub samples: u64,
    /// Weight of the task reward; the style's is one less this. Where skills are trained together, a factor on the weight
    /// in the last phase of each skill's own recipe.
    pub task: f32,
    /// Height of the hills of the wavy ground that three of four episodes take place on, metres; zero for flat ground.
    #[serde(default)]
    pub terrain_metres: f32,
    /// Standard deviation of every action in this phase, where it is another than `ppo.deviation`: less towards the end
    /// shows the policy, and its judges, what it is like without noise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation: Option<f32>,
    /// Share of episodes that start limp in this phase, where it is another than `environment.start.ragdoll`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ragdoll: Option<f32>,
    /// Ticks of an episode in this phase, where they are others than `environment.episode_ticks`: short ones keep a skill
    /// without a fall rule near its clips.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub episode_ticks: Option<u32>,
    /// Weight of imitation in this phase, where it is another than `environment.imitation`; the style's is what task and
    /// imitation leave.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imitation: Option<f32>,
    /// Weight of the squared distance between the mean action and what motors would need to follow the imitated clip: a
    /// start for the policy that exploration alone is slow to find. The divergence of updates is not steered meanwhile.
    #[serde(default)]
    pub guide: f32,
    /// Cost of a failure in this phase, where it is another than `environment.fall_cost`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fall_cost: Option<f32>,
    /// Share of episodes that start before a failure in this phase, where it is another than `environment.start.mishap`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mishap: Option<f32>,
    /// True for a phase of a recipe with an edge that keeps to the skill itself: first it is learned, then the way to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alone: Option<bool>,
    /// Share of the time without noise in this phase, where it is another than `environment.quiet`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quiet: Option<f32>,
    /// Share of episodes that start in other clips in this phase, where it is another than `environment.start.other`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other: Option<f32>,
}

/// Why a recipe can't be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecipeError {
    /// The file can't be read.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is no recipe.
    #[error("{}: {message}", path.display())]
    Toml {
        /// The file.
        path: PathBuf,
        /// What was expected and found, with its line.
        message: String,
    },
    /// A field has a value that makes no sense.
    #[error("{}: expected {expected} in {field}, found {found}", path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// The field.
        field: &'static str,
        /// What it should hold.
        expected: &'static str,
        /// What it holds.
        found: String,
    },
}

impl Recipe {
    /// Reads and checks a recipe.
    ///
    /// # Errors
    /// When the file can't be read, has unknown or missing fields, or a value out of its range.
    pub fn load(path: &Path) -> Result<Self, RecipeError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| RecipeError::Io { path: path.to_owned(), source })?;
        Self::parse(path, &text)
    }

    /// Parses and checks the text of a recipe; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`Recipe::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, RecipeError> {
        let wrong = |e: toml::de::Error| RecipeError::Toml { path: path.to_owned(), message: e.to_string() };
        let recipe: Self = toml::from_str(text).map_err(wrong)?;
        for (holds, field, expected, found) in recipe.checks() {
            if !holds {
                return Err(RecipeError::Field { path: path.to_owned(), field, expected, found });
            }
        }
        Ok(recipe)
    }

    /// Samples of all phases.
    #[must_use]
    pub fn total_samples(&self) -> u64 {
        self.phases.iter().map(|p| p.samples).sum()
    }

    /// The environment as the phase that is on after `samples` samples has it.
    #[must_use]
    pub fn environment_at(&self, samples: u64) -> EnvironmentConfig {
        let (phase, mut now) = (self.phase_at(samples).1, self.environment.clone());
        now.episode_ticks = phase.episode_ticks.unwrap_or(now.episode_ticks);
        now.imitation = phase.imitation.unwrap_or(now.imitation);
        now.start.ragdoll = phase.ragdoll.unwrap_or(now.start.ragdoll);
        now.fall_cost = phase.fall_cost.unwrap_or(now.fall_cost);
        now.start.mishap = phase.mishap.unwrap_or(now.start.mishap);
        now.start.other = phase.other.unwrap_or(now.start.other);
        now.alone = phase.alone.unwrap_or(now.alone);
        now.quiet = phase.quiet.unwrap_or(now.quiet);
        now
    }

    /// The phase that is on after `samples` samples; the last one at the end.
    #[must_use]
    pub fn phase_at(&self, samples: u64) -> (usize, &Phase) {
        let mut end = 0;
        for (index, phase) in self.phases.iter().enumerate() {
            end += phase.samples;
            if samples < end {
                return (index, phase);
            }
        }
        (self.phases.len() - 1, &self.phases[self.phases.len() - 1])
    }
}
