//! Lineages: plans of runs in order, with recipes, starts and averages, so that a pack can be made again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use files::quoted;

use crate::average::Averaging;
use crate::posture::Posture;
use crate::toml_file::{self, TomlFileError};

mod execute;

/// File in a run's folder that says which step of a lineage made it.
pub const STEP_FILE: &str = "lineage.toml";

/// Most steps of one.
const MOST_STEPS: usize = 1000;

/// Runs in order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lineage {
    /// Seed of the runs that name none.
    #[serde(default = "one")]
    pub seed: u64,
    /// Kept checkpoints, by name, that steps start from.
    #[serde(default)]
    pub kept: Vec<String>,
    /// What to do, in this order.
    pub steps: Vec<Step>,
}

fn one() -> u64 {
    1
}

/// A step of a lineage. Each makes one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// Trains a recipe.
    Train(TrainStep),
    /// Averages policies.
    Average(AverageStep),
}

/// A training.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainStep {
    /// Name of the recipe.
    pub recipe: String,
    /// Name of the run; the recipe's by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<String>,
    /// Run whose networks it starts from. Without it, and without `continues`, it starts from the runs of the recipe's parents.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// Samples that count as taken when it starts from another run, so that it begins in a later phase; 0 by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_samples: Option<u64>,
    /// Run that trained the recipe's parent together with others, to start from instead of the parent's own run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parents: Option<String>,
    /// Run whose state it continues, samples included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continues: Option<String>,
    /// Samples at which it stops, if before the recipe's end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<u64>,
    /// Seed, if another than the lineage's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

/// A mean of policies, as [`Averaging`] has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AverageStep {
    /// Name of the run that it makes.
    pub run: String,
    /// Runs to average; all but the policies comes from the first one.
    pub of: Vec<String>,
    /// Weight of each run, adding up to 1; equal ones by default.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub weights: Vec<f64>,
    /// Skills whose policies stay as they are in the first one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub except: Vec<String>,
    /// Skill whose policy a run gives that trained several skills together, where the first one trained a skill alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy: Option<String>,
    /// Offsets of joint targets that the mean gets, radians, as [`Posture`] has them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub posture: BTreeMap<String, f64>,
}

impl AverageStep {
    fn averaging<'a>(&'a self, posture: Option<&'a Posture>) -> Averaging<'a> {
        let Self { weights, except, policy, .. } = self;
        Averaging { weights, except, policy: policy.as_deref(), posture }
    }
}

/// Why a lineage can't be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LineageError {
    /// The file can't be read, or its fields are not those expected.
    #[error(transparent)]
    File(#[from] TomlFileError),
    /// A step can't be done.
    #[error("{}: steps[{step}]: expected {expected}, found {found}", path.display())]
    Step {
        /// The file.
        path: PathBuf,
        /// Index of the step.
        step: usize,
        /// What it should say.
        expected: String,
        /// What it says.
        found: String,
    },
}

impl Step {
    /// Name of the run that it makes.
    #[must_use]
    pub fn run(&self) -> &str {
        match self {
            Self::Train(train) => train.run.as_deref().unwrap_or(&train.recipe),
            Self::Average(average) => &average.run,
        }
    }

    /// Runs that it reads by name.
    fn reads(&self) -> Vec<&String> {
        match self {
            Self::Train(train) => train.from.iter().chain(&train.continues).chain(&train.parents).collect(),
            Self::Average(average) => average.of.iter().collect(),
        }
    }
}

impl Lineage {
    /// Reads and checks a lineage.
    ///
    /// # Errors
    /// When the file can't be read, has unknown or missing fields, or a step reads a run that no earlier step makes.
    pub fn load(path: &Path) -> Result<Self, LineageError> {
        Self::parse(path, &toml_file::read_text(path)?)
    }

    /// Parses and checks the text of a lineage; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`Lineage::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, LineageError> {
        let lineage: Self = toml_file::parse(path, text)?;
        let wrong = |step, expected: &str, found: String| {
            let (expected, found) = (expected.to_owned(), quoted(&found));
            LineageError::Step { path: path.to_owned(), step, expected, found }
        };
        if lineage.steps.len() > MOST_STEPS {
            return Err(wrong(MOST_STEPS, "at most 1000 steps", lineage.steps.len().to_string()));
        }
        let mut made: BTreeSet<&str> = lineage.kept.iter().map(String::as_str).collect();
        for (index, step) in lineage.steps.iter().enumerate() {
            if let Some(name) = step.reads().into_iter().find(|name| !made.contains(name.as_str())) {
                return Err(wrong(index, "a run that an earlier step makes, or a kept one", name.clone()));
            }
            if !crate::recipe::is_plain(step.run()) {
                return Err(wrong(
                    index,
                    "a run of lower-case letters, digits and underscores",
                    step.run().into(),
                ));
            }
            if !made.insert(step.run()) {
                return Err(wrong(index, "a run that no other step makes", step.run().into()));
            }
            match step {
                Step::Train(TrainStep { from: Some(from), continues: Some(_), .. }) => {
                    return Err(wrong(index, "`from` or `continues`", format!("both, from {from}")));
                }
                Step::Train(TrainStep { from: None, from_samples: Some(samples), .. }) => {
                    return Err(wrong(index, "`from` beside `from_samples`", samples.to_string()));
                }
                Step::Train(TrainStep { samples: Some(0), .. }) => {
                    return Err(wrong(index, "at least one sample", "0".into()));
                }
                Step::Average(average) => {
                    if let Err([expected, found]) = average.averaging(None).check(average.of.len()) {
                        return Err(wrong(index, &expected, found));
                    }
                }
                _ => {}
            }
        }
        Ok(lineage)
    }
}

#[cfg(test)]
#[path = "lineage_tests.rs"]
mod tests;
