//! Doing the steps of a lineage.

use std::path::Path;

use anyhow::{Context, Result, bail};
use serde::Serialize;

use super::{AverageStep, Lineage, STEP_FILE, Step, TrainStep};
use crate::average::average;
use crate::posture::Posture;
use crate::recipe::Recipe;
use crate::run::{Existing, Run, RunError, RunFolder, holds_a_run, newest_checkpoint};
use crate::toml_file;
use crate::workspace::{Start, Workspace};

impl Lineage {
    /// Does the steps in order. `train` is called with each run that has samples left to take, and returns false to stop there.
    /// With [`Existing::Resume`] finished steps are skipped and an unfinished one continues. With [`Existing::Overwrite`] the runs of
    /// all steps are deleted first.
    ///
    /// # Errors
    /// When a run is there with [`Existing::Refuse`], a run was made by another step, or a step fails.
    pub fn execute(
        &self,
        workspace: &Workspace,
        existing: Existing,
        mut train: impl FnMut(&mut Run) -> Result<bool>,
    ) -> Result<()> {
        for folder in self.steps.iter().map(|step| workspace.runs.join(step.run())) {
            if existing == Existing::Refuse && holds_a_run(&folder) {
                return Err(RunError::Exists { folder }.into());
            }
        }
        if existing == Existing::Overwrite {
            self.check_ready(workspace)?;
            // All at once: one that is interrupted and resumed must not take what an earlier execution left for its own.
            RunFolder::clear_all(self.steps.iter().map(|step| workspace.runs.join(step.run())))?;
        }
        for (index, step) in self.steps.iter().enumerate() {
            let at = || format!("steps[{index}], {}", step.run());
            let going = match step {
                Step::Train(step) => self.train(step, workspace, existing, &mut train).with_context(at)?,
                Step::Average(step) => {
                    average_runs(step, workspace, existing).with_context(at).map(|()| true)?
                }
            };
            if !going {
                break;
            }
        }
        Ok(())
    }

    /// Refuses a lineage that lacks a recipe or a kept checkpoint.
    fn check_ready(&self, workspace: &Workspace) -> Result<()> {
        for step in &self.steps {
            if let Step::Train(step) = step {
                workspace.recipe(&step.recipe)?;
            }
        }
        self.kept.iter().try_for_each(|name| workspace.required(name).map(|_| ()))
    }

    fn train(
        &self,
        step: &TrainStep,
        workspace: &Workspace,
        existing: Existing,
        train: &mut impl FnMut(&mut Run) -> Result<bool>,
    ) -> Result<bool> {
        let name = step.run.as_deref().unwrap_or(&step.recipe);
        let folder = workspace.runs.join(name);
        let mut recipe = workspace.recipe(&step.recipe)?;
        if let Some(samples) = step.samples {
            recipe.stop_at(samples);
        }
        let stamp = stamp(&Step::Train(step.clone()), Some(&recipe))?;
        let there = holds_a_run(&folder) && existing == Existing::Resume;
        if there {
            check_stamp(&folder, &stamp)?;
            let samples = newest_checkpoint(&folder)?.map_or(0, |loaded| loaded.checkpoint.progress.samples);
            if samples >= recipe.total_samples() {
                return Ok(true);
            }
        }
        let start = match (&step.from, &step.continues) {
            (Some(from), _) => Start::From {
                checkpoint: workspace.required(from)?,
                samples: step.from_samples.unwrap_or_default(),
            },
            (_, Some(continues)) => Start::Continue(workspace.required(continues)?),
            _ => Start::Parents,
        };
        let workspace = &Workspace { parents: step.parents.clone(), ..workspace.clone() };
        let seed = step.seed.unwrap_or(self.seed);
        let existing = if existing == Existing::Resume && !there { Existing::Refuse } else { existing };
        let mut run = workspace.prepare_named(name, recipe, Some(seed), existing, start)?;
        run.folder.write(STEP_FILE, &stamp)?;
        if !train(&mut run)? {
            return Ok(false);
        }
        Ok(run.is_done())
    }
}

/// Makes the run of an average, unless it is there.
fn average_runs(step: &AverageStep, workspace: &Workspace, existing: Existing) -> Result<()> {
    let path = workspace.runs.join(&step.run);
    let stamp = stamp(&Step::Average(step.clone()), None)?;
    if existing == Existing::Resume && newest_checkpoint(&path)?.is_some() {
        return check_stamp(&path, &stamp);
    }
    let checkpoints = step.of.iter().map(|name| workspace.required(name)).collect::<Result<Vec<_>>>()?;
    let posture = Posture::of(workspace.model.skeleton(), &step.posture)?;
    let mean = average(&checkpoints, step.averaging(posture.as_ref()))?;
    let folder =
        RunFolder::open(path, if existing == Existing::Resume { Existing::Refuse } else { existing })?;
    folder.clear()?;
    folder.write(STEP_FILE, &stamp)?;
    Ok(folder.save(&mean)?)
}

/// What a run's folder says about the step that made it: the step, and the recipe as it was.
pub(super) fn stamp(step: &Step, recipe: Option<&Recipe>) -> Result<String> {
    #[derive(Serialize)]
    struct Stamp<'a> {
        step: &'a Step,
        #[serde(skip_serializing_if = "Option::is_none")]
        recipe: Option<&'a Recipe>,
    }
    toml::to_string(&Stamp { step, recipe }).context("cannot write the step")
}

pub(super) fn check_stamp(folder: &Path, stamp: &str) -> Result<()> {
    let path = folder.join(STEP_FILE);
    let found = toml_file::read_text(&path)?;
    if found != stamp {
        bail!("{}: expected the step of this plan with its recipe as it is, found another", path.display());
    }
    Ok(())
}
