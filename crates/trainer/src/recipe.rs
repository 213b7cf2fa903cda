//! Recipes: one TOML file for each skill, with all that a run depends on but its seed.
//!
//! A phase overlays one configuration: it overrides any field of `environment`, `ppo` and `discriminator` by the same names.
//! Below the recipe's own fields lie those of the character, a file that the recipes of one body share.

use std::path::{Path, PathBuf};

use files::quoted;
use serde::Serialize;

use crate::amp::DiscriminatorConfig;
use crate::env::{EnvironmentConfig, MET};
use crate::ppo::PpoConfig;
use crate::toml_file::{self, TomlFileError};

mod checks;
mod file;
mod ranges;

pub use file::{ClipShare, is_plain};

/// How one skill is trained, or several of them together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recipe {
    /// Name of the skill: node of the graph, folder of the run.
    pub skill: String,
    /// Skill it starts from and is pulled towards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
    /// Skill that it is a variant of: a run of this recipe starts from that skill's networks, in a run of its own or one that trained
    /// several skills together, and is pulled towards nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variant_of: Option<String>,
    /// True to train the whole straight line from the parent, not only its end.
    pub edge: bool,
    /// Paths of skills that are trained together, each from its own run and with its own clips. Such a recipe has no parent
    /// and no clips, and its name is that of the run.
    pub paths: Vec<Vec<String>>,
    /// Edges of those paths whose middle has a style of its own: the faster skill's clip half-way to the slower one's pose.
    /// Without it the middle is scored by both ends, and stopping and going by turns suits both.
    pub halfway: Vec<[String; 2]>,
    /// Demonstration clips.
    pub clips: Vec<ClipShare>,
    /// Phases in order, at least one.
    pub phases: Vec<Phase>,
}

/// A stretch of training with its own configuration, complete.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Phase {
    /// Samples of this phase: ticks of all environments together.
    pub samples: u64,
    /// The environment.
    pub environment: EnvironmentConfig,
    /// The policy's optimisation.
    pub ppo: PpoConfig,
    /// The discriminator's.
    pub discriminator: DiscriminatorConfig,
}

/// Why a recipe can't be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecipeError {
    /// The file can't be read, or its fields are not those expected.
    #[error(transparent)]
    File(#[from] TomlFileError),
    /// A number is out of its range.
    #[error("{}: expected {least} to {most} in {field}, found {found}", path.display())]
    Range {
        /// The file.
        path: PathBuf,
        /// The field, as `phases[1].ppo.gamma`.
        field: String,
        /// Its least value.
        least: f64,
        /// Its largest value.
        most: f64,
        /// What it holds.
        found: f64,
    },
    /// Fields don't fit together.
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
        Self::parse(path, &toml_file::read_text(path)?)
    }

    /// Parses and checks the text of a recipe. `path` is named in errors, and the character's file lies beside it.
    ///
    /// # Errors
    /// As [`Recipe::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, RecipeError> {
        let recipe = file::parse(path, text)?;
        recipe.check_ranges(path)?;
        for (holds, field, expected, found) in recipe.checks() {
            if !holds {
                let found = quoted(&found);
                return Err(RecipeError::Field { path: path.to_owned(), field, expected, found });
            }
        }
        Ok(recipe)
    }

    /// Samples of all phases.
    #[must_use]
    pub fn total_samples(&self) -> u64 {
        self.phases.iter().fold(0, |sum, phase| sum.saturating_add(phase.samples))
    }

    /// Drops what comes after so many samples, if that is before the end.
    pub fn stop_at(&mut self, samples: u64) {
        let mut left = samples.max(1);
        self.phases.retain_mut(|phase| {
            let keep = left > 0;
            phase.samples = phase.samples.min(left);
            left -= phase.samples;
            keep
        });
    }

    /// Index of the phase after `samples` samples; the last one at the end.
    #[must_use]
    pub fn phase_at(&self, samples: u64) -> usize {
        let mut end = 0_u64;
        let after = self.phases.iter().position(|phase| {
            end = end.saturating_add(phase.samples);
            samples < end
        });
        after.unwrap_or(self.phases.len() - 1)
    }

    /// The first phase.
    #[must_use]
    pub fn first(&self) -> &Phase {
        // A recipe without phases is refused.
        &self.phases[0]
    }

    /// The last phase: the settings that a skill ends with.
    #[must_use]
    pub fn last(&self) -> &Phase {
        // A recipe without phases is refused.
        &self.phases[self.phases.len() - 1]
    }

    /// Trained gaits that drive a character in one of its phases, one that is met or one until a skill starts in play, and the field
    /// that needs them; `None` where there is neither.
    pub(crate) fn driven_by(&self) -> Option<(&'static str, &'static [&'static str])> {
        let any =
            |needs: fn(&EnvironmentConfig) -> bool| self.phases.iter().any(|phase| needs(&phase.environment));
        let in_play = self.phases.iter().find_map(|phase| phase.environment.reset.in_play);
        if let Some(in_play) = in_play {
            Some(("environment.reset.in_play", in_play.out_of.played()))
        } else if any(|environment| environment.meetings.share > 0.0) {
            Some(("environment.meetings", &MET))
        } else {
            None
        }
    }

    /// Those of them that have to be trained before. Variants play with each other, so a variant plays with those that there are.
    pub(crate) fn needs_trained(&self) -> &'static [&'static str] {
        match self.driven_by() {
            None => &[],
            Some(_) if self.variant_of.is_some() => &MET,
            Some((_, names)) => names,
        }
    }
}

#[cfg(test)]
#[path = "recipe_tests.rs"]
mod tests;
