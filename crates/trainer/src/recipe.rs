//! Recipes: one TOML file for each skill, saying all that a run depends on but its seed.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::amp::DiscriminatorConfig;
use crate::env::EnvironmentConfig;
use crate::ppo::PpoConfig;

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

    fn checks(&self) -> Vec<(bool, &'static str, &'static str, String)> {
        let (env, ppo, disc) = (&self.environment, &self.ppo, &self.discriminator);
        let plain = |s: &str| {
            !s.is_empty() && s.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        };
        let unit = |x: f32| (0.0..=1.0).contains(&x);
        let positive = |x: f32| x.is_finite() && x > 0.0;
        let ordered = |[a, b]: [f32; 2]| a.is_finite() && b.is_finite() && 0.0 <= a && a <= b;
        vec![
            (plain(&self.skill), "skill", "lower-case letters, digits and underscores", self.skill.clone()),
            (!self.edge || self.parent.is_some(), "edge", "a parent beside it", "none".into()),
            (
                self.clips.is_empty() != self.paths.is_empty(),
                "clips",
                "at least one clip, or paths instead",
                format!("{} clips and {} paths", self.clips.len(), self.paths.len()),
            ),
            (
                self.paths.is_empty() || self.parent.is_none(),
                "parent",
                "none beside paths",
                self.parent.clone().unwrap_or_default(),
            ),
            (
                self.paths.iter().all(|p| p.len() > 1),
                "paths",
                "at least two skills in each",
                format!("{:?}", self.paths),
            ),
            (
                self.clips.iter().all(|c| positive(c.share)),
                "clips.share",
                "positive shares",
                format!("{:?}", self.clips),
            ),
            (
                self.phases
                    .iter()
                    .all(|p| p.terrain_metres == 0.0 || (0.01..=0.5).contains(&p.terrain_metres)),
                "phases.terrain_metres",
                "0, or 0.01 to 0.5",
                format!("{:?}", self.phases),
            ),
            (
                env.push_secs >= 0.0 && (0.0..=5000.0).contains(&env.push_newton),
                "environment.push_secs and push_newton",
                "a time of at least 0, and 0 to 5000 newton",
                format!("{} and {}", env.push_secs, env.push_newton),
            ),
            (!self.phases.is_empty(), "phases", "at least one phase", "none".into()),
            (
                self.phases.iter().all(|p| unit(p.task)),
                "phases.task",
                "a weight in [0, 1]",
                format!("{:?}", self.phases),
            ),
            (
                (1..=65_536).contains(&env.characters),
                "environment.characters",
                "1 to 65536",
                env.characters.to_string(),
            ),
            ((1..=1024).contains(&env.steps), "environment.steps", "1 to 1024", env.steps.to_string()),
            (
                env.episode_ticks > 0 && self.phases.iter().all(|p| p.episode_ticks != Some(0)),
                "episode_ticks",
                "at least 1",
                "0".into(),
            ),
            (env.speed_mps.is_finite(), "environment.speed_mps", "a finite speed", env.speed_mps.to_string()),
            (
                ordered(env.target_metres),
                "environment.target_metres",
                "least and most distance",
                format!("{:?}", env.target_metres),
            ),
            (
                ordered(env.target_secs),
                "environment.target_secs",
                "least and most time",
                format!("{:?}", env.target_secs),
            ),
            (
                [env.stop, env.stick, env.jump, env.start.other, env.start.anywhere, env.start.ragdoll]
                    .into_iter()
                    .all(unit),
                "environment.stop, stick, jump and start",
                "shares in [0, 1]",
                format!("{}, {}, {} and {:?}", env.stop, env.stick, env.jump, env.start),
            ),
            (
                ordered(env.edge_sweep_secs)
                    && env.edge_sweep_secs[0] > 0.0
                    && (0.0..60.0).contains(&env.edge_secs),
                "environment.edge_sweep_secs and edge_secs",
                "least and most time above 0, and 0 to 60 s",
                format!("{:?} and {}", env.edge_sweep_secs, env.edge_secs),
            ),
            ((0.0..1.0).contains(&ppo.gamma), "ppo.gamma", "a discount in [0, 1)", ppo.gamma.to_string()),
            (unit(ppo.gae_lambda), "ppo.gae_lambda", "a discount in [0, 1]", ppo.gae_lambda.to_string()),
            (positive(ppo.deviation), "ppo.deviation", "a positive deviation", ppo.deviation.to_string()),
            (
                self.phases.iter().all(|p| p.deviation.is_none_or(positive) && p.ragdoll.is_none_or(unit)),
                "phases.deviation and ragdoll",
                "a positive deviation and a share in [0, 1]",
                format!("{:?}", self.phases),
            ),
            (
                ppo.epochs > 0 && ppo.minibatch > 0,
                "ppo.epochs and minibatch",
                "at least 1",
                format!("{} and {}", ppo.epochs, ppo.minibatch),
            ),
            (
                positive(ppo.actor_rate) && positive(ppo.critic_rate),
                "ppo.actor_rate and critic_rate",
                "positive rates",
                format!("{} and {}", ppo.actor_rate, ppo.critic_rate),
            ),
            (
                ppo.regularisation >= 0.0,
                "ppo.regularisation",
                "a weight of at least 0",
                ppo.regularisation.to_string(),
            ),
            (
                !ppo.critic_hidden.is_empty() && !disc.hidden.is_empty(),
                "hidden",
                "at least one hidden layer",
                "none".into(),
            ),
            (
                disc.rows > 0 && disc.replay > 0,
                "discriminator.rows and replay",
                "at least 1",
                format!("{} and {}", disc.rows, disc.replay),
            ),
        ]
    }

    /// Samples of all phases.
    #[must_use]
    pub fn total_samples(&self) -> u64 {
        self.phases.iter().map(|p| p.samples).sum()
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
