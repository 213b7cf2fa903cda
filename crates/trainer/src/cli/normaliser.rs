//! `trainer normaliser`: one mean and deviation for the whole graph, from the clips of all recipes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use clips::ClipFolder;
use physics_bridge::Model;
use trainer::env::Normalisers;
use trainer::normaliser_file;
use trainer::recipe::Recipe;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Another file of normalisers to compare with.
    #[arg(long)]
    compare: Option<PathBuf>,
    /// Clips to use instead of those of the recipes.
    #[arg(long, value_delimiter = ',')]
    clips: Vec<String>,
}

/// Computes and writes the normalisers.
pub(crate) fn run(
    model: &Model,
    folder: &ClipFolder,
    recipes: &Path,
    path: &Path,
    arguments: &Arguments,
) -> Result<()> {
    let mut names: BTreeSet<String> = arguments.clips.iter().cloned().collect();
    if names.is_empty() {
        for entry in
            std::fs::read_dir(recipes).with_context(|| format!("cannot read {}", recipes.display()))?
        {
            let file = entry?.path();
            if file.extension().is_some_and(|e| e == "toml") {
                names.extend(Recipe::load(&file)?.clips.into_iter().map(|c| c.name));
            }
        }
    }
    ensure!(!names.is_empty(), "expected recipes with clips in {}, found none", recipes.display());
    let clips = names.iter().map(|n| folder.load(n)).collect::<Result<Vec<_>, _>>()?;
    let ours = Normalisers::from_clips(&clips, model)?;
    say(format_args!("{} clips: {}", clips.len(), names.into_iter().collect::<Vec<_>>().join(", ")))?;
    if let Some(other) = &arguments.compare {
        let other = normaliser_file::load(other, model.skeleton())?;
        for (name, a, b) in
            [("observation", &ours.observation, &other.observation), ("frame", &ours.frame, &other.frame)]
        {
            let worst =
                |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            let ratios = a.deviation().iter().zip(b.deviation()).map(|(a, b)| (a / b).ln().abs());
            say(format_args!(
                "{name}: means differ by at most {:.4}, deviations by a factor of at most {:.4}",
                worst(a.mean(), b.mean()),
                ratios.fold(0.0, f32::max).exp()
            ))?;
        }
    }
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent)?;
    }
    normaliser_file::save(path, &ours)?;
    say(format_args!("wrote {}", path.display()))?;
    Ok(())
}
