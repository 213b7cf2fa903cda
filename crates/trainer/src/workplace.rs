//! Where recipes, runs, clips and kept checkpoints are, and how a run is made ready from them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use physics_bridge::Model;

use crate::checkpoint::{Checkpoint, write_atomically};
use crate::clip::{ClipError, ClipFolder};
use crate::env::{Demonstrations, Normalisers};
use crate::recipe::Recipe;
use crate::run::{METRICS, Run};
use crate::training::{AVERAGE, PARENT_DISCRIMINATOR, Training};

/// Where everything a run reads and writes is.
#[derive(Clone, Debug)]
pub struct Workplace {
    /// Folder of recipes.
    pub recipes: PathBuf,
    /// Folder of runs.
    pub runs: PathBuf,
    /// Folder of slim checkpoints that came with the project: what a run goes on from when it has none of its own.
    pub kept: PathBuf,
    /// Folder of clips.
    pub clips: ClipFolder,
    /// The character.
    pub model: Model,
    /// The graph's normalisers.
    pub normalisers: Normalisers,
}

impl Workplace {
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
                let after = r.environment.start.after.iter().map(|after| &after.skill);
                let mut needed = r.parent.iter().chain(r.paths.iter().flatten()).chain(after);
                needed.all(|p| ordered.iter().any(|o| o.skill == *p))
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
        self.runs.join(skill).join("checkpoint.safetensors")
    }

    /// Path of the checkpoint to start from: the run's own, else the kept one.
    #[must_use]
    pub fn newest(&self, skill: &str) -> PathBuf {
        let (own, kept) = (self.checkpoint(skill), self.kept.join(format!("{skill}.safetensors")));
        if !own.exists() && kept.exists() { kept } else { own }
    }

    /// The clips of a recipe, ready to learn from.
    ///
    /// # Errors
    /// When a clip is missing or wrong.
    pub fn demonstrations(&self, recipe: &Recipe) -> Result<Demonstrations> {
        self.clips_ready(recipe.clips.iter().map(|clip| (clip.name.as_str(), clip.share, clip.mirror)))
    }

    /// Clips by name, share and whether their mirror images count too, ready to learn from.
    pub(crate) fn clips_ready<'a>(
        &self,
        named: impl Iterator<Item = (&'a str, f32, bool)>,
    ) -> Result<Demonstrations> {
        let clips = named.map(|(name, share, mirror)| Ok((self.clips.load(name)?, share, mirror)));
        let clips = clips.collect::<Result<Vec<_>, ClipError>>()?;
        Ok(Demonstrations::from_clips(&clips, &self.model, &self.normalisers.frame)?)
    }

    /// Makes a run ready: from its checkpoint with `resume` and if there is one, else from the start.
    ///
    /// # Errors
    /// When something that it needs is missing or wrong.
    pub fn prepare(&self, recipe: Recipe, seed: u64, resume: bool) -> Result<Run> {
        let folder = self.runs.join(&recipe.skill);
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        let path = self.newest(&recipe.skill);
        let earlier = if resume && path.exists() { Some(Checkpoint::load(&path)?) } else { None };
        // A resumed run must not meet the same episodes again.
        let seed_now = seed.wrapping_add(earlier.as_ref().map_or(0, |c| c.progress.samples));
        let text = toml::to_string(&recipe).context("cannot write the recipe")?;
        let parts = self.parts(&recipe, seed_now)?;
        let mut training = Training::new(recipe, &self.model, self.normalisers.clone(), parts, seed_now);
        let metrics = folder.join("metrics.csv");
        if earlier.is_none() || !metrics.exists() {
            write_atomically(&folder.join("seed.txt"), format!("{seed}\n").as_bytes())?;
            write_atomically(&metrics, format!("{METRICS}\n").as_bytes())?;
        }
        write_atomically(&folder.join("recipe.toml"), text.as_bytes())?;
        let secs = match earlier {
            Some(checkpoint) => restore(&mut training, &checkpoint, &path)?,
            None => 0.0,
        };
        Ok(Run::new(training, folder, seed, secs))
    }
}

/// Puts a checkpoint's networks into a training; returns the seconds spent before.
fn restore(training: &mut Training, checkpoint: &Checkpoint, path: &Path) -> Result<f64> {
    for (role, network, adam) in training.networks_mut() {
        // What a parent's style is like, or that between two skills, can be learned anew; a running mean begins where the
        // policy is.
        let actor = role.strip_suffix(AVERAGE).map(|before| format!("{before}actor"));
        let known = checkpoint.networks.contains_key(&role);
        if (role == PARENT_DISCRIMINATOR || role.contains('-')) && !known {
            continue;
        }
        let trained = checkpoint.network(actor.filter(|_| !known).as_deref().unwrap_or(&role), path)?;
        if trained.network.sizes() != network.sizes() {
            bail!(
                "{}: expected a {role} of sizes {:?}, found {:?}",
                path.display(),
                network.sizes(),
                trained.network.sizes()
            );
        }
        network.clone_from(&trained.network);
        if let Some(adam) = adam {
            adam.clone_from(&trained.adam);
        }
    }
    training.samples = checkpoint.progress.samples;
    training.learner.actors.iter_mut().for_each(|a| a.rate = checkpoint.progress.actor_rate);
    training.learner.rng = checkpoint.progress.rng;
    Ok(checkpoint.progress.secs)
}
