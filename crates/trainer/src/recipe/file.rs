//! The file of a recipe: TOML tables that are overlaid before they become a configuration.

use std::path::Path;

use clips::{Clip, ClipError, ClipFolder, Leap};
use files::quoted;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::{Phase, Recipe, RecipeError};
use crate::toml_file::{self, TomlFileError};

/// Folder of the characters' files, beside the recipes.
const CHARACTERS: &str = "characters";

/// A clip and how often it is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClipShare {
    /// Name of the clip's file, without its ending.
    pub name: String,
    /// Its share among the clips of the recipe.
    #[serde(default = "one")]
    pub share: f32,
    /// False to take the clip as it is, without its mirror image.
    #[serde(default = "yes")]
    pub mirror: bool,
    /// First and last second of the clip that count; the whole clip when there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<[f32; 2]>,
    /// True for a cycle that is alike to both sides, made of the clip and its mirror image.
    #[serde(default, skip_serializing_if = "is_false")]
    pub symmetric: bool,
    /// Seconds for which its last pose is held at its end. Then it no longer begins anew.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold_seconds: Option<f32>,
    /// True to play it backwards: walking ahead becomes walking back.
    #[serde(default, skip_serializing_if = "is_false")]
    pub reversed: bool,
    /// How fast it is played.
    #[serde(default = "one")]
    pub pace: f32,
    /// Speed of steps to the left that are made of its first pose, metres per second; none for the clip itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side_steps_mps: Option<f32>,
    /// True for a punch that is made of its first pose.
    #[serde(default, skip_serializing_if = "is_false")]
    pub punch: bool,
    /// The flight of a run that becomes a leap, in seconds of the clip at its pace.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leap: Option<Leap>,
}

impl ClipShare {
    /// The whole clip of this name and its mirror image.
    #[must_use]
    pub fn whole(name: &str) -> Self {
        let name = name.to_owned();
        Self {
            name,
            share: 1.0,
            mirror: true,
            seconds: None,
            symmetric: false,
            hold_seconds: None,
            reversed: false,
            pace: 1.0,
            side_steps_mps: None,
            punch: false,
            leap: None,
        }
    }

    /// The clip from its folder, cut to the seconds that count, and what is made of it.
    ///
    /// # Errors
    /// When the clip is missing or wrong, or shorter than those seconds.
    pub fn load(&self, folder: &ClipFolder) -> Result<Clip, ClipError> {
        self.made_of(folder.load(&self.name)?)
    }

    /// What counts of a clip, and what is made of it.
    ///
    /// # Errors
    /// When the clip is shorter than the seconds that count, or its limbs or its flight are not those that are needed for what is made of it.
    pub fn made_of(&self, mut clip: Clip) -> Result<Clip, ClipError> {
        if let Some(seconds) = self.seconds {
            clip = clip.excerpt(seconds)?;
        }
        if let Some(mps) = self.side_steps_mps {
            clip = clip.side_steps(mps)?;
        }
        if self.punch {
            clip = clip.punch()?;
        }
        if self.symmetric {
            clip = clip.symmetric()?;
        }
        if self.reversed {
            clip = clip.reversed();
        }
        if self.pace != 1.0 {
            clip = clip.at_pace(self.pace)?;
        }
        if let Some(leap) = &self.leap {
            clip = clip.leap(leap)?;
        }
        match self.hold_seconds {
            Some(seconds) => clip.held(seconds),
            None => Ok(clip),
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_false(value: &bool) -> bool {
    !value
}

fn yes() -> bool {
    true
}

fn one() -> f32 {
    1.0
}

/// A recipe as its file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RecipeFile {
    skill: String,
    character: Option<String>,
    parent: Option<String>,
    variant_of: Option<String>,
    #[serde(default)]
    edge: bool,
    #[serde(default)]
    paths: Vec<Vec<String>>,
    #[serde(default)]
    halfway: Vec<[String; 2]>,
    #[serde(default)]
    clips: Vec<ClipShare>,
    phases: Vec<PhaseFile>,
    #[serde(default)]
    environment: Table,
    #[serde(default)]
    ppo: Table,
    #[serde(default)]
    discriminator: Table,
}

/// A phase as its file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PhaseFile {
    samples: u64,
    #[serde(default)]
    environment: Table,
    #[serde(default)]
    ppo: Table,
    #[serde(default)]
    discriminator: Table,
}

/// What the recipes of one body share.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct CharacterFile {
    environment: Table,
    ppo: Table,
    discriminator: Table,
}

/// Parses a recipe and overlays its tables.
pub(super) fn parse(path: &Path, text: &str) -> Result<Recipe, RecipeError> {
    let recipe: RecipeFile = toml_file::parse(path, text)?;
    let character = match &recipe.character {
        Some(name) if is_plain(name) => {
            let folder = path.parent().unwrap_or(Path::new(".")).join(CHARACTERS);
            let path = folder.join(format!("{name}.toml"));
            toml_file::parse(&path, &toml_file::read_text(&path)?)?
        }
        Some(name) => {
            let (field, expected) = ("character", "lower-case letters, digits and underscores");
            return Err(RecipeError::Field { path: path.to_owned(), field, expected, found: quoted(name) });
        }
        None => CharacterFile::default(),
    };
    let layers = |of: fn(&CharacterFile) -> &Table, own: &Table| overlaid(of(&character), own);
    let environment = layers(|c| &c.environment, &recipe.environment);
    let ppo = layers(|c| &c.ppo, &recipe.ppo);
    let discriminator = layers(|c| &c.discriminator, &recipe.discriminator);
    let mut phases = Vec::with_capacity(recipe.phases.len());
    for (index, phase) in recipe.phases.iter().enumerate() {
        let at = |section: &str, own: &Table| {
            if own.is_empty() { section.to_owned() } else { format!("phases[{index}].{section}") }
        };
        phases.push(Phase {
            samples: phase.samples,
            environment: section(
                path,
                &at("environment", &phase.environment),
                &environment,
                &phase.environment,
            )?,
            ppo: section(path, &at("ppo", &phase.ppo), &ppo, &phase.ppo)?,
            discriminator: section(
                path,
                &at("discriminator", &phase.discriminator),
                &discriminator,
                &phase.discriminator,
            )?,
        });
    }
    let RecipeFile { skill, parent, variant_of, edge, paths, halfway, clips, .. } = recipe;
    Ok(Recipe { skill, parent, variant_of, edge, paths, halfway, clips, phases })
}

/// True for lower-case letters, digits and underscores, at most 64: names that are safe as file names.
#[must_use]
pub fn is_plain(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    !name.is_empty() && name.len() <= 64 && name.chars().all(plain)
}

/// A section of the configuration with a phase's table over it.
fn section<T: DeserializeOwned>(
    path: &Path,
    name: &str,
    base: &Table,
    over: &Table,
) -> Result<T, TomlFileError> {
    T::deserialize(Value::Table(overlaid(base, over)))
        .map_err(|e| TomlFileError::toml(path, format!("{name}: {}", quoted(e.message()))))
}

/// The fields of `base` and `over`; where both have one, that of `over`. Tables are overlaid field by field.
fn overlaid(base: &Table, over: &Table) -> Table {
    let mut all = base.clone();
    for (name, value) in over {
        let merged = match (all.get(name), value) {
            (Some(Value::Table(below)), Value::Table(above)) => Value::Table(overlaid(below, above)),
            _ => value.clone(),
        };
        all.insert(name.clone(), merged);
    }
    all
}
