//! A run: `runs/<skill>/` with the recipe, the seed, metrics and checkpoints, and the iterations that fill it.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Instant;

use anyhow::{Context, Result};

mod error;
mod folder;
mod lock;

pub use error::RunError;
pub use folder::{
    CHECKPOINT, Existing, Loaded, METRICS_FILE, PREVIOUS, RunFolder, holds_a_run, newest_checkpoint,
};
pub use lock::{Holder, LOCK_FILE, RunLock};

use crate::checkpoint::{Checkpoint, Trained};
use crate::nn::Adam;
use crate::plot;
use crate::training::{IterationReport, Training};

/// Columns of `metrics.csv`.
pub const METRICS: &str = "samples,secs,rate,style,task,reward,speed_error,episode_ticks,failed,kl,learning_rate,\
                           value_error,clipped,discriminator_accuracy,cross_entropy,squared_gradient,distance,\
                           tracking,asymmetry";

/// Iterations between checkpoints.
const CHECKPOINT_EVERY: u64 = 25;

/// A run on its way.
#[derive(Debug)]
pub struct Run {
    /// What learns.
    pub training: Training,
    /// Where it is kept. The run holds the folder's lock.
    pub folder: RunFolder,
    /// Its seed.
    pub seed: u64,
    /// Wall-clock seconds spent.
    pub secs: f64,
    /// What the user should know about how it was made ready.
    pub notes: Vec<String>,
    iterations: u64,
}

impl Run {
    pub(crate) fn new(
        training: Training,
        folder: RunFolder,
        seed: u64,
        secs: f64,
        notes: Vec<String>,
    ) -> Self {
        Self { training, folder, seed, secs, notes, iterations: 0 }
    }

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
        self.check_finite()?;
        let rate = (self.training.samples - before) as f64 / secs;
        let path = self.folder.path().join(METRICS_FILE);
        let line = metrics_line(self.training.samples, self.secs, rate, &report);
        let append = || -> std::io::Result<()> {
            let mut file = std::fs::OpenOptions::new().append(true).create(true).open(&path)?;
            file.write_all(format!("{line}\n").as_bytes())
        };
        append().with_context(|| format!("cannot write {}", path.display()))?;
        if self.iterations.is_multiple_of(CHECKPOINT_EVERY) || self.is_done() {
            self.save()?;
        }
        Ok(report)
    }

    /// Refuses numbers that no checkpoint can hold, so that the one before stays the newest.
    fn check_finite(&mut self) -> Result<(), RunError> {
        let samples = self.training.samples;
        let is_finite = |numbers: &[f32]| numbers.iter().all(|number| number.is_finite());
        for (role, network, adam) in self.training.networks_mut() {
            let moments = adam.is_none_or(|adam| is_finite(&adam.mean) && is_finite(&adam.square));
            if !moments || !is_finite(&network.parameters) {
                return Err(RunError::NotFinite { role, samples });
            }
        }
        Ok(())
    }

    /// Writes a checkpoint.
    ///
    /// # Errors
    /// When the folder can't be written.
    pub fn save(&mut self) -> Result<()> {
        let training = &mut self.training;
        let mut networks = HashMap::new();
        for (role, network, adam) in training.networks_mut() {
            let adam = adam.map_or(Adam { mean: Vec::new(), square: Vec::new(), steps: 0 }, |a| a.clone());
            networks.insert(role, Trained { network: network.clone(), adam });
        }
        let progress = (self.seed, training.samples, self.secs);
        let (rate, rng) = (training.learner.learning_rate(), training.learner.rng);
        let mut checkpoint = Checkpoint::new(networks, progress, rate, rng);
        let rates = training.learning_rates_mut().into_iter();
        checkpoint.progress.learning_rates = rates.map(|(role, rate)| (role, *rate)).collect();
        self.folder.save(&checkpoint)?;
        let folder = self.folder.path();
        plot::draw(&folder.join(METRICS_FILE), &folder.join("metrics.svg"))
    }
}

fn metrics_line(samples: u64, secs: f64, rate: f64, report: &IterationReport) -> String {
    let (p, u, d) = (&report.episodes, &report.update, &report.discriminator);
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
        f64::from(report.learning_rate),
        f64::from(u.value_error),
        f64::from(u.clipped),
        f64::from(d.accuracy),
        f64::from(d.cross_entropy),
        f64::from(d.squared_gradient),
        report.distance,
        p.tracking / ticks,
        f64::from(u.asymmetry),
    ] {
        let _ = write!(line, ",{value:.6}");
    }
    line
}
