//! Where recipes, runs, clips and kept checkpoints are, and how a run is made ready from them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clips::{ClipError, ClipFolder};
use physics_bridge::Model;

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::env::{Demonstrations, Normalisers};
use crate::recipe::{ClipShare, Recipe};
use crate::run::{CHECKPOINT, Existing, Loaded, METRICS, METRICS_FILE, Run, RunFolder, newest_checkpoint};
use crate::training::Training;

mod restore;

use restore::{restore, skill_alone};

/// Seed of a run that is given none.
const DEFAULT_SEED: u64 = 1;

/// What a new run begins with.
#[derive(Debug)]
pub enum Start {
    /// The networks of the recipe's parents, or of the skill that it is a variant of, or random ones.
    Parents,
    /// The networks of this checkpoint; its path is named in errors. Of a run that trained several
    /// skills together, the networks of the recipe's skill.
    From {
        /// The checkpoint and its path.
        checkpoint: (Checkpoint, PathBuf),
        /// Samples that count as taken: a policy that can walk may begin in a later phase.
        samples: u64,
    },
    /// The whole state of this checkpoint.
    Continue((Checkpoint, PathBuf)),
}

/// Where everything a run reads and writes is.
#[derive(Clone, Debug)]
pub struct Workspace {
    /// Folder of recipes.
    pub recipes: PathBuf,
    /// Folder of runs.
    pub runs: PathBuf,
    /// Folder of slim checkpoints that came with the project: what a run starts from when it has none of its own.
    pub kept: PathBuf,
    /// Folder of clips.
    pub clips: ClipFolder,
    /// The character.
    pub model: Model,
    /// The graph's normalisers.
    pub normalisers: Normalisers,
    /// Run to take parents from that were trained together, before any other; usually none.
    pub parents: Option<String>,
}

impl Workspace {
    /// The recipe of a skill.
    ///
    /// # Errors
    /// When there is none or it can't be used.
    pub fn recipe(&self, skill: &str) -> Result<Recipe> {
        let path = self.recipes.join(format!("{skill}.toml"));
        let recipe = Recipe::load(&path)?;
        if recipe.skill != skill {
            bail!("{}: expected the recipe of {skill}, found that of {}", path.display(), recipe.skill);
        }
        Ok(recipe)
    }

    /// All recipes of the folder, parents before children.
    ///
    /// # Errors
    /// When a recipe can't be used, or a parent has none.
    pub fn recipes_in_order(&self) -> Result<Vec<Recipe>> {
        let mut left = BTreeMap::new();
        let folder = std::fs::read_dir(&self.recipes)
            .with_context(|| format!("cannot read {}", self.recipes.display()))?;
        for entry in folder {
            let path = entry?.path();
            if path.extension().is_some_and(|e| e == "toml") {
                let recipe = Recipe::load(&path)?;
                left.insert(recipe.skill.clone(), recipe);
            }
        }
        let mut ordered: Vec<Recipe> = Vec::new();
        while !left.is_empty() {
            let ready = |r: &Recipe| {
                let hand_over =
                    r.first().environment.reset.hand_over.iter().map(|hand_over| &hand_over.skill);
                let skills = r.parent.iter().chain(&r.variant_of).chain(r.paths.iter().flatten());
                let played = r.needs_trained().iter().copied();
                let mut needed = skills.chain(hand_over).map(String::as_str).chain(played);
                needed.all(|p| ordered.iter().any(|o| o.skill == p))
            };
            let Some(skill) = left.values().find(|r| ready(r)).map(|r| r.skill.clone()) else {
                let names: Vec<_> = left.keys().cloned().collect();
                bail!(
                    "expected every parent to have a recipe, and no circle; found none for {}",
                    names.join(", ")
                );
            };
            ordered.extend(left.remove(&skill));
        }
        Ok(ordered)
    }

    /// Path of a skill's checkpoint.
    #[must_use]
    pub fn checkpoint(&self, skill: &str) -> PathBuf {
        self.runs.join(skill).join(CHECKPOINT)
    }

    /// The newest checkpoint of a skill's run, else the kept one.
    ///
    /// # Errors
    /// When a checkpoint is there and can't be read.
    pub fn newest(&self, skill: &str) -> Result<Option<CheckpointFile>, CheckpointError> {
        newest_or_kept(&self.runs, &self.kept, skill)
    }

    /// As [`Workspace::newest`], where there has to be one.
    pub(crate) fn required(&self, name: &str) -> Result<CheckpointFile> {
        self.newest(name)?.with_context(|| {
            let [runs, kept] = [self.runs.display(), self.kept.display()];
            format!("expected a run or a kept checkpoint named {name}, found none in {runs} and {kept}")
        })
    }

    /// The clips of a recipe, ready to learn from.
    ///
    /// # Errors
    /// When a clip is missing or wrong.
    pub fn demonstrations(&self, recipe: &Recipe) -> Result<Demonstrations> {
        self.clips_ready(&recipe.clips)
    }

    /// Clips, ready to learn from.
    pub(crate) fn clips_ready(&self, named: &[ClipShare]) -> Result<Demonstrations> {
        let clips = named.iter().map(|clip| Ok((clip.load(&self.clips)?, clip.share, clip.mirror)));
        let clips = clips.collect::<Result<Vec<_>, ClipError>>()?;
        Ok(Demonstrations::from_clips(&clips, &self.model, &self.normalisers.frame)?)
    }

    /// Makes the run of a recipe ready and locks its folder. With [`Existing::Resume`] it continues from its newest checkpoint,
    /// or from the kept one; otherwise it starts anew. Without a seed it has that of the checkpoint that it continues, or 1.
    ///
    /// # Errors
    /// As [`Workspace::prepare_named`].
    pub fn prepare(&self, recipe: Recipe, seed: Option<u64>, existing: Existing) -> Result<Run> {
        let name = recipe.skill.clone();
        let continues = existing == Existing::Resume && !RunFolder::begins_anew(&self.runs.join(&name));
        let kept = if continues { self.newest(&name)? } else { None };
        let start = kept.map_or(Start::Parents, Start::Continue);
        self.prepare_named(&name, recipe, seed, existing, start)
    }

    /// As [`Workspace::prepare`]; a new run starts from the networks of the run `from`, or of its kept checkpoint. `samples` count
    /// as taken.
    ///
    /// # Errors
    /// As [`Workspace::prepare_named`], and when `from` has no checkpoint.
    pub fn prepare_from(
        &self,
        from: &str,
        samples: u64,
        recipe: Recipe,
        seed: Option<u64>,
        existing: Existing,
    ) -> Result<Run> {
        let name = recipe.skill.clone();
        let checkpoint = self.required(from)?;
        self.prepare_named(&name, recipe, seed, existing, Start::From { checkpoint, samples })
    }

    /// Makes a run of this name ready and locks its folder. With [`Existing::Resume`] and a run there it continues that; else
    /// it begins as `start` says. An existing run is deleted with [`Existing::Overwrite`] once the new one is ready.
    ///
    /// # Errors
    /// When a run is there and `existing` refuses it, another trainer holds the folder, or something that the run needs is
    /// missing or wrong.
    pub fn prepare_named(
        &self,
        name: &str,
        recipe: Recipe,
        seed: Option<u64>,
        existing: Existing,
        start: Start,
    ) -> Result<Run> {
        let text = toml::to_string(&recipe).context("cannot write the recipe")?;
        let folder = RunFolder::open(self.runs.join(name), existing)?;
        let own = if existing == Existing::Overwrite { None } else { folder.load()? };
        let mut notes = Vec::new();
        if let Some(holder) = folder.crashed() {
            notes.push(format!("the last trainer here ended without finishing: {holder}"));
        }
        if let Some(Loaded { torn: Some(error), path, .. }) = &own {
            notes.push(format!("{error}; continuing from {}", path.display()));
        }
        let start = match (&own, start, &recipe.variant_of) {
            (None, Start::Parents, Some(skill)) => {
                let checkpoint = self.trained(skill)?;
                let checkpoint = checkpoint
                    .with_context(|| format!("{name} is a variant of {skill}, which is not trained yet"))?;
                Start::From { checkpoint, samples: 0 }
            }
            (_, start, _) => start,
        };
        let begins = matches!((&own, &start), (None, Start::From { .. }));
        let anew = own.is_none() && !matches!(start, Start::Continue(_));
        let earlier = match (own, start) {
            (Some(Loaded { checkpoint, path, .. }), _) => Some((checkpoint, path)),
            (None, Start::Continue(earlier)) => Some(earlier),
            (None, Start::From { checkpoint: (mut checkpoint, path), samples }) => {
                if recipe.paths.is_empty() {
                    checkpoint = skill_alone(checkpoint, recipe.variant_of.as_ref().unwrap_or(&recipe.skill));
                }
                (checkpoint.progress.samples, checkpoint.progress.secs) = (samples, 0.0);
                Some((checkpoint, path))
            }
            (None, Start::Parents) => None,
        };
        let of_checkpoint =
            earlier.as_ref().filter(|_| !begins).map(|(checkpoint, _)| checkpoint.progress.seed);
        let seed = seed.or(of_checkpoint).unwrap_or(DEFAULT_SEED);
        // A resumed run must not meet the same episodes again.
        let seed_now = seed.wrapping_add(earlier.as_ref().map_or(0, |(c, _)| c.progress.samples));
        let parts = self.parts(&recipe, seed_now)?;
        let mut training = Training::new(recipe, &self.model, self.normalisers.clone(), parts, seed_now);
        let secs = match &earlier {
            Some((checkpoint, path)) => restore(&mut training, checkpoint, path, begins)?,
            None => 0.0,
        };
        if existing == Existing::Overwrite {
            folder.clear()?;
        }
        if earlier.is_none() || !folder.path().join(METRICS_FILE).exists() {
            folder.write(METRICS_FILE, &format!("{METRICS}\n"))?;
        }
        if anew {
            folder.begin_anew()?;
        }
        folder.cut_metrics(training.samples)?;
        folder.write("seed.txt", &format!("{seed}\n"))?;
        folder.write("recipe.toml", &text)?;
        Ok(Run::new(training, folder, seed, secs, notes))
    }
}

/// A checkpoint and its file.
pub type CheckpointFile = (Checkpoint, PathBuf);

/// The newest checkpoint of a skill's run in the folder `runs`, else the one in the folder `kept`.
///
/// # Errors
/// When a checkpoint is there and can't be read.
pub fn newest_or_kept(
    runs: &Path,
    kept: &Path,
    skill: &str,
) -> Result<Option<CheckpointFile>, CheckpointError> {
    if let Some(Loaded { checkpoint, path, .. }) = newest_checkpoint(&runs.join(skill))? {
        return Ok(Some((checkpoint, path)));
    }
    let kept = kept.join(format!("{skill}.safetensors"));
    let loaded = kept.exists().then(|| Checkpoint::load(&kept)).transpose()?;
    Ok(loaded.map(|checkpoint| (checkpoint, kept)))
}
