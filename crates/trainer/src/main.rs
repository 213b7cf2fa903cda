//! `trainer`: trains skills, evaluates them and builds character packs.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use clips::ClipFolder;
use physics_bridge::Model;
use trainer::env::Normalisers;
use trainer::normaliser_file;
use trainer::workspace::{Workspace, newest_or_kept};

mod cli;

/// Trains skills, evaluates them and builds character packs.
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
    /// Folder of kept checkpoints, which runs start from when they have none of their own.
    #[arg(long, global = true, default_value = "assets/checkpoints")]
    kept: PathBuf,
    /// MJCF file of the character's body.
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
    /// Builds a character pack from trained skills.
    Pack(cli::pack::Arguments),
    /// Keeps slim checkpoints of runs, and the normaliser, to start other runs from.
    Keep(cli::keep::Arguments),
    /// Averages the policies of several checkpoints of one run.
    Average(cli::average::Arguments),
    /// Searches weights of an average of policies, and its posture, that reach what a file asks for.
    Search(cli::search::Arguments),
    /// Evaluates a pack: falls, speed, skills, response to the stick, pushes, terrain, encounters.
    Evaluate(cli::evaluate::Arguments),
    /// Prints the cost of a control step beside that of larger networks.
    Compare(cli::compare::Arguments),
    /// Principal components of visited states and of parameters.
    Pca(cli::pca::Arguments),
    /// Draws strips of each skill beside its clip.
    Strip(cli::strip::Arguments),
    /// Writes the policies and paths of a pack as ONNX models.
    Export(cli::export::Arguments),
    /// Puts policies from ONNX models into a pack.
    Import(cli::import::Arguments),
    /// Fits a clip, tells how well it fits, and writes its poses.
    View(cli::view::Arguments),
}

/// Runs a verb. Exit codes: 0 for success, 1 for an error, 2 for wrong arguments, 128 and the signal's number for a
/// training or a search that a signal stopped.
fn main() -> ExitCode {
    // A reader that closes the pipe ends the program quietly.
    sigpipe::reset();
    match run(&Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            cli::output::complain(&error);
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<ExitCode> {
    let done = match &arguments.verb {
        Verb::Train(train) => return cli::train::run(&arguments.workspace()?, train),
        Verb::Search(verb) => {
            let newest = |skill: &str| newest_or_kept(&arguments.runs, &arguments.kept, skill);
            let clips = arguments.clips().ok();
            return cli::search::run(&arguments.model()?, &arguments.recipes, clips.as_ref(), &newest, verb);
        }
        Verb::Pack(verb) => {
            let newest = |skill: &str| newest_or_kept(&arguments.runs, &arguments.kept, skill);
            let model = arguments.model()?;
            cli::pack::run(&model, &arguments.normalisers(&model)?, &newest, verb)
        }
        Verb::Keep(verb) => {
            let normalisers = arguments.normalisers(&arguments.model()?)?;
            cli::keep::run(&normalisers, &arguments.runs, &arguments.kept, verb)
        }
        Verb::Average(verb) => cli::average::run(|| arguments.model(), verb),
        Verb::Evaluate(verb) => {
            let clips = arguments.clips().ok();
            cli::evaluate::run(&arguments.model()?, &arguments.recipes, clips.as_ref(), verb)
        }
        Verb::Compare(verb) => cli::compare::run(verb),
        Verb::Pca(verb) => cli::pca::run(&arguments.model()?, verb),
        Verb::Export(verb) => cli::export::run(verb),
        Verb::Import(verb) => cli::import::run(verb),
        Verb::Strip(verb) => {
            cli::strip::run(&arguments.model()?, &arguments.recipes, &arguments.clips()?, verb)
        }
        Verb::View(verb) => cli::view::run(&arguments.model()?, || arguments.clips(), verb),
        Verb::Normaliser(verb) => {
            let (model, clips) = (arguments.model()?, arguments.clips()?);
            cli::normaliser::run(&model, &clips, &arguments.recipes, &arguments.normaliser_path(), verb)
        }
    };
    done.map(|()| ExitCode::SUCCESS)
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

    fn normalisers(&self, model: &Model) -> Result<Normalisers> {
        let (own, kept) = (self.normaliser_path(), self.kept.join("normaliser.safetensors"));
        normaliser_file::load(if own.exists() || !kept.exists() { &own } else { &kept }, model.skeleton())
            .context("run `trainer normaliser` first: all skills share one normaliser")
    }

    fn workspace(&self) -> Result<Workspace> {
        let model = self.model()?;
        Ok(Workspace {
            recipes: self.recipes.clone(),
            runs: self.runs.clone(),
            kept: self.kept.clone(),
            clips: self.clips()?,
            normalisers: self.normalisers(&model)?,
            model,
            parents: None,
        })
    }
}
