//! A run on disk: `runs/<skill>/` with the recipe, the seed, metrics and checkpoints; and the loop that fills it.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use physics_bridge::Model;

use crate::checkpoint::{Checkpoint, Trained, write_atomically};
use crate::clip::{ClipError, ClipFolder};
use crate::env::{Demonstrations, Normalisers};
use crate::plot;
use crate::recipe::Recipe;
use crate::training::{IterationReport, Parent, Training};

/// Where everything a run reads and writes is.
#[derive(Clone, Debug)]
pub struct Workplace {
    /// Folder of recipes.
    pub recipes: PathBuf,
    /// Folder of runs.
    pub runs: PathBuf,
    /// Folder of clips.
    pub clips: ClipFolder,
    /// The character.
    pub model: Model,
    /// The graph's normalisers.
    pub normalisers: Normalisers,
}

/// Columns of `metrics.csv`.
pub const METRICS: &str = "samples,secs,rate,style,task,reward,speed_error,episode_ticks,failed,kl,actor_rate,\
                           value_error,clipped,discriminator_accuracy,cross_entropy,squared_gradient,distance";

/// Iterations between checkpoints.
const CHECKPOINT_EVERY: u64 = 25;

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
            let ready = |r: &Recipe| r.parent.as_ref().is_none_or(|p| ordered.iter().any(|o| o.skill == *p));
            let Some(skill) = left.values().find(|r| ready(r)).map(|r| r.skill.clone()) else {
                let names: Vec<_> = left.keys().cloned().collect();
                bail!("expected every parent to have a recipe, and no circle; found none for {}", names.join(", "));
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

    /// The clips of a recipe, ready to learn from.
    ///
    /// # Errors
    /// When a clip is missing or wrong.
    pub fn demonstrations(&self, recipe: &Recipe) -> Result<Demonstrations> {
        let mut clips = Vec::new();
        for clip in &recipe.clips {
            clips.push((self.clips.load(&clip.name)?, clip.share));
        }
        Ok(Demonstrations::from_clips(&clips, &self.model, &self.normalisers.frame)?)
    }

    fn parent(&self, recipe: &Recipe) -> Result<Option<Parent>> {
        let Some(skill) = &recipe.parent else { return Ok(None) };
        let path = self.checkpoint(skill);
        let checkpoint = Checkpoint::load(&path)
            .with_context(|| format!("{} starts from {skill}, which is not trained yet", recipe.skill))?;
        let network = |role: &str| checkpoint.network(role, &path).map(|t| t.network.clone());
        Ok(Some(Parent {
            actor: network("actor")?,
            critic: network("critic")?,
            discriminator: network("discriminator")?,
            demonstrations: self.demonstrations(&self.recipe(skill)?)?,
        }))
    }

    /// Makes a run ready: from its checkpoint with `resume` and if there is one, else from the start.
    ///
    /// # Errors
    /// When something that it needs is missing or wrong.
    pub fn prepare(&self, recipe: Recipe, seed: u64, resume: bool) -> Result<Run> {
        let folder = self.runs.join(&recipe.skill);
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        let path = self.checkpoint(&recipe.skill);
        let earlier = if resume && path.exists() { Some(Checkpoint::load(&path)?) } else { None };
        let demonstrations = self.demonstrations(&recipe)?;
        let parent = self.parent(&recipe)?;
        let starts = match &recipe.environment.start.clips[..] {
            [] => parent.as_ref().map(|p| p.demonstrations.clone()),
            names => {
                let clips = names.iter().map(|n| Ok((self.clips.load(n)?, 1.0)));
                let clips = clips.collect::<Result<Vec<_>, ClipError>>()?;
                Some(Demonstrations::from_clips(&clips, &self.model, &self.normalisers.frame)?)
            }
        };
        // A resumed run must not meet the same episodes again.
        let seed_now = seed.wrapping_add(earlier.as_ref().map_or(0, |c| c.progress.samples));
        let text = toml::to_string(&recipe).context("cannot write the recipe")?;
        let mut training =
            Training::new(recipe, &self.model, self.normalisers.clone(), (demonstrations, starts), parent, seed_now);
        let secs = match earlier {
            Some(checkpoint) => restore(&mut training, &checkpoint, &path)?,
            None => {
                write_atomically(&folder.join("recipe.toml"), text.as_bytes())?;
                write_atomically(&folder.join("seed.txt"), format!("{seed}\n").as_bytes())?;
                write_atomically(&folder.join("metrics.csv"), format!("{METRICS}\n").as_bytes())?;
                0.0
            }
        };
        Ok(Run { training, folder, seed, secs, iterations: 0 })
    }
}

/// A run on its way.
#[derive(Debug)]
pub struct Run {
    /// What learns.
    pub training: Training,
    /// Where it is kept.
    pub folder: PathBuf,
    /// Its seed.
    pub seed: u64,
    /// Wall-clock seconds spent.
    pub secs: f64,
    iterations: u64,
}

impl Run {
    /// True when all phases are over.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.training.samples >= self.training.recipe.total_samples()
    }

    /// One iteration; writes metrics, and now and then a checkpoint.
    ///
    /// # Errors
    /// When the folder can't be written, or a parameter is no longer finite.
    pub fn advance(&mut self) -> Result<IterationReport> {
        let (start, before) = (Instant::now(), self.training.samples);
        let report = self.training.iterate()?;
        let secs = start.elapsed().as_secs_f64();
        self.secs += secs;
        self.iterations += 1;
        if !self.training.learner.actor.parameters.iter().all(|p| p.is_finite()) {
            bail!("after {} samples: expected finite parameters, found others", self.training.samples);
        }
        let rate = (self.training.samples - before) as f64 / secs;
        let path = self.folder.join("metrics.csv");
        let mut file = std::fs::OpenOptions::new().append(true).create(true).open(&path)?;
        writeln!(file, "{}", metrics_line(self.training.samples, self.secs, rate, &report))?;
        if self.iterations.is_multiple_of(CHECKPOINT_EVERY) || self.is_done() {
            self.save()?;
        }
        Ok(report)
    }

    /// Writes a checkpoint.
    ///
    /// # Errors
    /// When the folder can't be written.
    pub fn save(&self) -> Result<()> {
        let training = &self.training;
        let mut networks = HashMap::new();
        let learner = &training.learner;
        let mut keep = |role: &str, network: &crate::nn::Network, adam: &crate::nn::Adam| {
            networks.insert(role.to_owned(), Trained { network: network.clone(), adam: adam.clone() });
        };
        keep("actor", &learner.actor, &learner.actor_adam);
        keep("critic", &learner.critic, &learner.critic_adam);
        keep("discriminator", &training.discriminator.network, &training.discriminator.adam);
        if let Some(parent) = &training.parent_discriminator {
            keep("parent_discriminator", &parent.network, &parent.adam);
        }
        let progress = (self.seed, training.samples, self.secs);
        let checkpoint = Checkpoint::new(networks, progress, learner.actor_rate, learner.rng);
        checkpoint.save(&self.folder.join("checkpoint.safetensors"))?;
        plot::draw(&self.folder.join("metrics.csv"), &self.folder.join("metrics.svg"))
    }
}

/// Puts a checkpoint's networks into a training; returns the seconds spent before.
fn restore(training: &mut Training, checkpoint: &Checkpoint, path: &Path) -> Result<f64> {
    let mut targets = vec![
        ("actor", &mut training.learner.actor, &mut training.learner.actor_adam),
        ("critic", &mut training.learner.critic, &mut training.learner.critic_adam),
        ("discriminator", &mut training.discriminator.network, &mut training.discriminator.adam),
    ];
    if let Some(parent) = &mut training.parent_discriminator {
        targets.push(("parent_discriminator", &mut parent.network, &mut parent.adam));
    }
    for (role, network, adam) in targets {
        let trained = checkpoint.network(role, path)?;
        if trained.network.sizes() != network.sizes() {
            bail!(
                "{}: expected a {role} of sizes {:?}, found {:?}",
                path.display(),
                network.sizes(),
                trained.network.sizes()
            );
        }
        network.clone_from(&trained.network);
        adam.clone_from(&trained.adam);
    }
    training.samples = checkpoint.progress.samples;
    training.learner.actor_rate = checkpoint.progress.actor_rate;
    training.learner.rng = checkpoint.progress.rng;
    Ok(checkpoint.progress.secs)
}

fn metrics_line(samples: u64, secs: f64, rate: f64, report: &IterationReport) -> String {
    let (p, u, d) = (&report.population, &report.update, &report.discriminator);
    let episodes = f64::from(p.episodes.max(1));
    let ticks = p.ticks.max(1) as f64;
    let mut line = format!("{samples},{secs:.1},{rate:.0}");
    for value in [
        f64::from(report.style),
        p.task / ticks,
        f64::from(report.reward),
        p.speed_error / ticks,
        p.episode_ticks as f64 / episodes,
        f64::from(p.failed) / episodes,
        f64::from(u.kl),
        f64::from(report.actor_rate),
        f64::from(u.value_error),
        f64::from(u.clipped),
        f64::from(d.accuracy),
        f64::from(d.cross_entropy),
        f64::from(d.squared_gradient),
        report.distance,
    ] {
        let _ = write!(line, ",{value:.6}");
    }
    line
}
