//! `trainer`: trains skills, measures them and binds them into a character pack.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use physics_bridge::Model;
use trainer::clip::ClipFolder;
use trainer::env::Normalisers;
use trainer::normaliser_file;
use trainer::run::Workplace;

mod cli;

/// Trains skills, measures them and binds them into a character pack.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Folder of clips; also by the variable POLICY_SPACE_MOTIONS.
    #[arg(long, global = true)]
    motions: Option<PathBuf>,
    /// Folder of recipes.
    #[arg(long, global = true, default_value = "assets/recipes")]
    recipes: PathBuf,
    /// Folder of runs.
    #[arg(long, global = true, default_value = "runs")]
    runs: PathBuf,
    /// The character.
    #[arg(long, global = true, default_value = "assets/humanoid.xml")]
    model: PathBuf,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Trains a skill, or all of them in the order of the graph.
    Train(cli::train::Arguments),
    /// Computes the normalisers of the whole graph from the clips of all recipes.
    Normaliser(cli::normaliser::Arguments),
    /// Binds trained skills into a character pack.
    Pack(cli::pack::Arguments),
    /// Measures a pack: survival, speed, get-up, roll, pushes.
    Evaluate(cli::evaluate::Arguments),
    /// Prints the cost of a control step beside that of larger networks.
    Compare(cli::compare::Arguments),
    /// Principal components of visited states and of parameters.
    Pca(cli::pca::Arguments),
    /// Fits a clip, tells how well it fits, and writes its poses.
    View(cli::view::Arguments),
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    match &arguments.verb {
        Verb::Train(train) => cli::train::run(&arguments.workplace()?, train),
        Verb::Pack(verb) => {
            cli::pack::run(&arguments.model()?, &arguments.normalisers()?, &arguments.runs, verb)
        }
        Verb::Evaluate(verb) => {
            let clips = arguments.clips().ok();
            cli::evaluate::run(&arguments.model()?, &arguments.recipes, clips.as_ref(), verb)
        }
        Verb::Compare(verb) => cli::compare::run(verb),
        Verb::Pca(verb) => cli::pca::run(&arguments.model()?, verb),
        Verb::View(verb) => cli::view::run(&arguments.model()?, || arguments.clips(), verb),
        Verb::Normaliser(verb) => {
            let (model, clips) = (arguments.model()?, arguments.clips()?);
            cli::normaliser::run(&model, &clips, &arguments.recipes, &arguments.normaliser_path(), verb)
        }
    }
}

impl Arguments {
    fn model(&self) -> Result<Model> {
        Ok(Model::load(&self.model)?)
    }

    fn clips(&self) -> Result<ClipFolder> {
        Ok(ClipFolder::from_argument(self.motions.clone())?)
    }

    fn normaliser_path(&self) -> PathBuf {
        self.runs.join("normaliser.safetensors")
    }

    fn normalisers(&self) -> Result<Normalisers> {
        normaliser_file::load(&self.normaliser_path())
            .context("run `trainer normaliser` first: all skills share one normaliser")
    }

    fn workplace(&self) -> Result<Workplace> {
        Ok(Workplace {
            recipes: self.recipes.clone(),
            runs: self.runs.clone(),
            clips: self.clips()?,
            model: self.model()?,
            normalisers: self.normalisers()?,
        })
    }
}
