//! Names: items and fields are called what the field calls them. Files that are too long to read are reported.
//!
//! [`WORDS`] lists names that a reader from this field would not look for, with the ones to use. Only definitions
//! count (types, functions, modules, fields, variants), never prose or calls. [`PENDING`] lists what is still there.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::definitions::{Definition, Kind, definitions};
use crate::workspace::Workspace;

/// Folders that are checked.
const FOLDERS: [&str; 2] = ["crates", "engines"];

/// Most lines of a source file. The aim is 250.
const MOST_LINES: usize = 400;

/// A name that is not to be used.
struct Word {
    /// Lower-case words of the name, joined by `_`; of a type `GoodName` as `good_name`.
    name: &'static str,
    /// What to use instead.
    instead: &'static str,
    reach: Reach,
    /// Only below this folder; empty for everywhere.
    below: &'static str,
}

/// Which definitions a word is looked for in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reach {
    /// A definition with the word in its name, so also `CourseNode` for `course`; a function of exactly this name.
    Part,
    /// A definition of exactly this name.
    Whole,
    /// A type of exactly this name.
    Type,
    /// A field of exactly this name. As a word of its own it is sound elsewhere.
    Field,
}

const fn word(name: &'static str, instead: &'static str, reach: Reach) -> Word {
    Word { name, instead, reach, below: "" }
}

const fn below(folder: &'static str, name: &'static str, instead: &'static str) -> Word {
    Word { name, instead, reach: Reach::Field, below: folder }
}

const TRAINER: &str = "crates/trainer/";
const PPO: &str = "crates/trainer/src/ppo/";

const WORDS: &[Word] = &[
    word("course", "PolicyGraph", Reach::Part),
    word("place", "GraphPosition", Reach::Type),
    word("judge", "Discriminator", Reach::Part),
    word("judges", "Discriminators", Reach::Part),
    word("judged", "scored", Reach::Part),
    word("mishap", "pre-failure reset", Reach::Part),
    word("draw_start", "reference-state initialisation", Reach::Whole),
    word("moment", "clip phase", Reach::Type),
    word("likeness", "tracking error", Reach::Part),
    word("lost_metres", "early-termination threshold", Reach::Whole),
    below(TRAINER, "guide", "behaviour-cloning weight"),
    below(TRAINER, "quiet", "deterministic intervals"),
    below(TRAINER, "surprise", "td_error"),
    below(TRAINER, "average", "ema"),
    below(TRAINER, "gradient_norm", "max_grad_norm"),
    below(TRAINER, "divergence", "kl"),
    below(PPO, "deviation", "action_std"),
    below(PPO, "rate", "learning_rate"),
    below(PPO, "characters", "num_envs"),
    below(PPO, "steps", "horizon"),
    word("workplace", "Workspace", Reach::Part),
    word("ingredient", "TrainedSkill", Reach::Part),
    word("subject", "EvalCharacter", Reach::Whole),
    word("rise", "assist_rise", Reach::Field),
    word("recover", "auto_recover", Reach::Field),
    word("keep_blends", "cache_blends", Reach::Whole),
    word("set_up", "reset", Reach::Whole),
    word("take_up", "load_state", Reach::Whole),
    word("dump", "replay file", Reach::Part),
    word("desk", "frame composer", Reach::Part),
];

/// What is not renamed yet: a word and the folder that may have it. Shrinks; nothing is added.
const PENDING: &[(&str, &str)] = &[];

/// Checks names, and reports long files without failing.
///
/// # Errors
/// When a file cannot be read or uses one of [`WORDS`]. The message names every line.
pub fn check(workspace: &Workspace) -> Result<()> {
    let mut found = Vec::new();
    for folder in FOLDERS {
        for path in sources(&workspace.root().join(folder))? {
            let text = fs::read_to_string(&path).with_context(|| format!("read {}", path.display()))?;
            let shown =
                path.strip_prefix(workspace.root()).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            if let Some(report) = too_long(&shown, &text) {
                eprintln!("xtask: {report}");
            }
            found.extend(complaints(&shown, &text));
        }
    }
    if found.is_empty() {
        return Ok(());
    }
    bail!("{} names to change:\n    {}", found.len(), found.join("\n    "))
}

/// A report of a file that is longer than a file should be.
fn too_long(path: &str, text: &str) -> Option<String> {
    let lines = text.lines().count();
    (lines > MOST_LINES).then(|| format!("{path}: expected at most {MOST_LINES} lines, found {lines}"))
}

/// The names of one file that are not to be used, each with its line.
fn complaints(path: &str, text: &str) -> Vec<String> {
    if !path.ends_with(".rs") {
        return Vec::new();
    }
    let complaint = |definition: Definition<'_>| {
        let word = WORDS.iter().find(|word| applies(word, path, &definition))?;
        Some(format!("{path}:{}: `{}`; use {}", definition.line, definition.name, word.instead))
    };
    definitions(text).into_iter().filter_map(complaint).collect()
}

fn applies(word: &Word, path: &str, definition: &Definition<'_>) -> bool {
    let name = snake(definition.name);
    let is_pending =
        PENDING.iter().any(|(pending, folder)| *pending == word.name && path.starts_with(folder));
    let matches = match word.reach {
        Reach::Part if definition.kind != Kind::Function => name.split('_').any(|part| part == word.name),
        Reach::Part | Reach::Whole => name == word.name,
        Reach::Type => name == word.name && definition.name.starts_with(char::is_uppercase),
        Reach::Field => name == word.name && definition.kind == Kind::Field,
    };
    matches && path.starts_with(word.below) && !is_pending
}

/// `GoodName` and `GOOD_NAME` as `good_name`.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    let mut after_lower = false;
    for character in name.chars() {
        if character.is_uppercase() && after_lower {
            snake.push('_');
        }
        after_lower = character.is_lowercase() || character.is_ascii_digit();
        snake.extend(character.to_lowercase());
    }
    snake
}

/// All Rust and shader sources below a folder, sorted; none when it is not there.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        if !folder.is_dir() {
            continue;
        }
        for entry in fs::read_dir(&folder).with_context(|| format!("list {}", folder.display()))? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                open.push(path);
            } else if name.ends_with(".rs") || name.ends_with(".wgsl") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_with_a_word_of_the_list_is_found() {
        let text = "pub struct CourseNode {\n    pub lost_metres: f32,\n}\nfn set_up() {}\nmod judge;\n";
        let found = complaints("crates/trainer/src/env/course.rs", text);
        assert_eq!(found.len(), 4, "{found:?}");
        assert_eq!(found[0], "crates/trainer/src/env/course.rs:1: `CourseNode`; use PolicyGraph");
        assert!(found[1].contains(":2: `lost_metres`; use early-termination"), "{found:?}");
    }

    #[test]
    fn prose_calls_and_similar_names_are_left_alone() {
        let text = "//! The course of a judge's mishap.\nfn placement(place: f32) -> f32 {\n    set_up(place); let desk = Desk { rise: 1 };\n    desk\n}\nfn the_dump_is_read() {}\nstruct Rise { rising: f32 }\nfn rise() {}\n";
        assert_eq!(complaints("crates/viewer/src/a.rs", text), [""; 0]);
    }

    #[test]
    fn some_words_are_only_wrong_where_they_mean_something_else() {
        let text = "struct Config {\n    rate: f32,\n    deviation: f32,\n}\n";
        assert_eq!(complaints("crates/trainer/src/ppo/config.rs", text).len(), 2);
        assert_eq!(complaints("crates/policy-core/src/normaliser.rs", text), [""; 0]);
    }

    #[test]
    fn a_long_file_is_reported_with_its_length() {
        let text = "\n".repeat(MOST_LINES + 1);
        let report = too_long("crates/a.wgsl", &text);
        assert_eq!(report.as_deref(), Some("crates/a.wgsl: expected at most 400 lines, found 401"));
        assert_eq!(too_long("crates/a.wgsl", &text[1..]), None);
    }

    #[test]
    fn names_are_compared_word_by_word() {
        assert_eq!(snake("CourseNode"), "course_node");
        assert_eq!(snake("MOST_LINES"), "most_lines");
        assert_eq!(snake("set_up"), "set_up");
    }
}
