//! Searches: the weights of an average of policies, and its posture, found by measuring packs.
//!
//! Training leads a policy to what is rewarded. Means of policies of one family, also with weights below zero, are policies too, and some are
//! better by a measure that no reward has. So are policies whose joint targets are off by a little ([`Posture`]). A search draws weights and
//! offsets by CMA-ES, puts each mean into a pack, and measures what its aims name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use evaluation::stress::{CaseList, GroundList};
use evaluation::trial::GaitList;
use evaluation::{Chosen, Named, Section};
use files::quoted;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::average::Averaging;
use crate::posture::Posture;
use crate::toml_file::{self, TomlFileError};

mod cma;
mod searcher;

pub use cma::Cma;
pub use searcher::{Candidate, Searcher, Trial};

/// What is searched, and for what.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Search {
    /// Policy of the pack that each mean takes the place of.
    pub replaces: String,
    /// Runs or kept checkpoints to average, as an [average](crate::lineage::AverageStep) has them.
    pub of: Vec<String>,
    /// Skill whose policy a run gives that trained several skills together.
    #[serde(default)]
    pub policy: Option<String>,
    /// Weights to begin with, adding up to 1; equal ones by default.
    #[serde(default)]
    pub weights: Vec<f64>,
    /// Joints whose targets get an offset, and the offset to begin with, radians, as [`Posture`] has them; none by default.
    #[serde(default)]
    pub posture: BTreeMap<String, f64>,
    /// Standard deviation of the weights, and of the offsets in radians, of the first candidates.
    #[serde(default = "spread")]
    pub spread: f64,
    /// Cost of each unit by which weights and offsets differ from those at the beginning, in the sum over all.
    #[serde(default)]
    pub pull: f64,
    /// Gaits to measure, as `trainer evaluate --gaits`; all by default.
    #[serde(default)]
    pub gaits: Vec<String>,
    /// Grounds to measure, as `trainer evaluate --grounds`; all by default.
    #[serde(default)]
    pub grounds: Vec<String>,
    /// Bodies and worlds that differ from training to measure, as `trainer evaluate --cases`; all by default.
    #[serde(default)]
    pub cases: Vec<String>,
    /// Characters in every measure, as `trainer evaluate --characters`.
    #[serde(default)]
    pub characters: Option<u16>,
    /// What is to be reached. Sections are measured in the order in which they first come here.
    pub aims: Vec<Aim>,
}

fn spread() -> f64 {
    0.03
}

/// A number of the evaluation, and what it is to be.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Aim {
    /// Section of the evaluation that measures it.
    pub section: String,
    /// Where it is in the report: keys, or indices of a list, with dots between them, as `push_torso.run.left_newton`.
    pub measure: String,
    /// The largest number that costs nothing.
    #[serde(default)]
    pub at_most: Option<f64>,
    /// The smallest one.
    #[serde(default)]
    pub at_least: Option<f64>,
    /// Beyond that, this much costs 1.
    pub scale: f64,
}

/// What a number costs that is missing from a report, as that of a character that always falls.
const MISSING_COST: f64 = 100.0;

impl Aim {
    /// What a number costs; 0 where it is as it should be.
    #[must_use]
    pub fn cost(&self, number: Option<f64>) -> f64 {
        let Some(number) = number else { return MISSING_COST };
        let above = self.at_most.map_or(0.0, |most| number - most);
        let below = self.at_least.map_or(0.0, |least| least - number);
        above.max(below).max(0.0) / self.scale
    }

    /// The number in a report; `None` where it is null.
    ///
    /// # Errors
    /// When the report has nothing there: what it has instead.
    pub fn find(&self, report: &Value) -> Result<Option<f64>, String> {
        let (mut at, mut rest) = (report, self.measure.as_str());
        while !rest.is_empty() {
            let key = key_of(at, rest);
            let next = match at {
                Value::Object(map) => map.get(key),
                Value::Array(list) => key.parse::<usize>().ok().and_then(|index| list.get(index)),
                _ => None,
            };
            at = next.ok_or_else(|| {
                let there = match at {
                    Value::Object(map) => map.keys().cloned().collect::<Vec<_>>().join(", "),
                    Value::Array(list) => format!("a list of {}", list.len()),
                    other => other.to_string(),
                };
                format!("{}: expected {key} in the report, found {}", self.measure, quoted(&there))
            })?;
            rest = rest[key.len()..].trim_start_matches('.');
        }
        match at {
            Value::Null => Ok(None),
            Value::Number(number) => Ok(number.as_f64()),
            other => {
                let found = quoted(&other.to_string());
                Err(format!("{}: expected a number in the report, found {found}", self.measure))
            }
        }
    }
}

/// The key that the rest of a measure begins with: one that is there, for keys have dots in them too, or what comes before the first dot.
fn key_of<'a>(at: &Value, rest: &'a str) -> &'a str {
    let ends = rest.match_indices('.').map(|(index, _)| index).chain([rest.len()]);
    let is_there = |key: &&str| matches!(at, Value::Object(map) if map.contains_key(*key));
    let first = rest.split('.').next().unwrap_or(rest);
    ends.map(|end| &rest[..end]).find(is_there).unwrap_or(first)
}

/// Why a search can't be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// The file can't be read, or its fields are not those expected.
    #[error(transparent)]
    File(#[from] TomlFileError),
    /// A field does not fit.
    #[error("{}: {field}: expected {expected}, found {found}", path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// The field.
        field: String,
        /// What it should say.
        expected: String,
        /// What it says.
        found: String,
    },
}

/// Field, what was expected and what was found.
type Wrong = (String, String, String);

/// Checks the names of a field.
fn check_names<L: Named>(field: &str, names: &[String]) -> Result<(), Wrong> {
    match names.iter().find(|name| Chosen::<L>::from_name(name).is_none()) {
        Some(name) => {
            let known = Chosen::<L>::names().join(", ");
            Err((field.to_owned(), format!("some of {known}"), name.clone()))
        }
        None => Ok(()),
    }
}

impl Search {
    /// Reads and checks a search.
    ///
    /// # Errors
    /// When the file can't be read, has unknown or missing fields, or a field does not fit.
    pub fn load(path: &Path) -> Result<Self, SearchError> {
        Self::parse(path, &toml_file::read_text(path)?)
    }

    /// Parses and checks the text of a search; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`Search::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, SearchError> {
        let search: Self = toml_file::parse(path, text)?;
        let wrong = |(field, expected, found): Wrong| SearchError::Field {
            path: path.to_owned(),
            field,
            expected,
            found: quoted(&found),
        };
        search.check().map_err(wrong)?;
        Ok(search)
    }

    fn check(&self) -> Result<(), Wrong> {
        let err =
            |field: &str, expected: &str, found: String| Err((field.to_owned(), expected.to_owned(), found));
        if let Err([expected, found]) = self.averaging(&self.weights, None).check(self.of.len()) {
            return err("weights", &expected, found);
        }
        if !(self.spread > 0.0 && self.spread <= 1.0) {
            return err("spread", "a number above 0, at most 1", self.spread.to_string());
        }
        if !(self.pull >= 0.0 && self.pull.is_finite()) {
            return err("pull", "a number from 0 on", self.pull.to_string());
        }
        if self.characters == Some(0) {
            return err("characters", "at least one", "0".into());
        }
        check_names::<GaitList>("gaits", &self.gaits)?;
        check_names::<GroundList>("grounds", &self.grounds)?;
        check_names::<CaseList>("cases", &self.cases)?;
        if self.aims.is_empty() {
            return err("aims", "at least one", "none".into());
        }
        for (index, aim) in self.aims.iter().enumerate() {
            let field = |name: &str| format!("aims[{index}].{name}");
            if Section::from_name(&aim.section).is_none() {
                let names = Section::ALL.map(Section::name).join(", ");
                return err(&field("section"), &format!("one of {names}"), aim.section.clone());
            }
            if !(aim.scale > 0.0 && aim.scale.is_finite()) {
                return err(&field("scale"), "a number above 0", aim.scale.to_string());
            }
            let bounds: Vec<f64> = aim.at_most.iter().chain(&aim.at_least).copied().collect();
            if bounds.len() != 1 || !bounds[0].is_finite() {
                return err(&field("measure"), "at_most or at_least, a number", format!("{bounds:?}"));
            }
        }
        Ok(())
    }

    /// How the checkpoints are averaged with some weights and a posture.
    #[must_use]
    pub fn averaging<'a>(&'a self, weights: &'a [f64], posture: Option<&'a Posture>) -> Averaging<'a> {
        Averaging { weights, policy: self.policy.as_deref(), except: &[], posture }
    }

    /// The sections to measure, each once, in the order of the aims.
    #[must_use]
    pub fn sections(&self) -> Vec<Section> {
        let mut sections: Vec<Section> = Vec::new();
        for section in self.aims.iter().filter_map(|aim| Section::from_name(&aim.section)) {
            if !sections.contains(&section) {
                sections.push(section);
            }
        }
        sections
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) const TEXT: &str = r#"
replaces = "run"
of = ["a", "b", "c"]
gaits = ["run"]
aims = [
    { section = "motion", measure = "pose_error_m.run", at_most = 0.1, scale = 0.01 },
    { section = "pushes", measure = "push_torso.run.left_newton", at_least = 350.0, scale = 50.0 },
    { section = "motion", measure = "motion.run.speed_mps", at_least = 2.0, scale = 0.1 },
]
"#;

    fn parse(text: &str) -> Result<Search, SearchError> {
        Search::parse(Path::new("x.toml"), text)
    }

    #[test]
    fn aims_cost_what_is_missing_to_them() {
        let search = parse(TEXT).unwrap();
        assert_eq!(search.sections(), [Section::Motion, Section::Pushes]);
        let cost = |index: usize, number| search.aims[index].cost(number);
        assert_eq!([cost(0, Some(0.09)), cost(1, Some(350.0)), cost(1, Some(400.0))], [0.0; 3]);
        assert!((cost(0, Some(0.13)) - 3.0).abs() < 1e-9);
        assert!((cost(1, Some(250.0)) - 2.0).abs() < 1e-9);
        assert_eq!(cost(1, None), MISSING_COST);
    }

    #[test]
    fn measures_are_found_by_their_keys() {
        let report = serde_json::json!({
            "push_torso": { "run": { "left_newton": 375.0, "right_newton": null } },
            "straight": { "speed": [{ "reached_mps": 1.5 }] },
            "robustness": { "strength_x0.8": { "run": { "falls": 2 } } },
        });
        let find = |measure: &str| {
            let aim = Aim { measure: measure.into(), ..parse(TEXT).unwrap().aims[0].clone() };
            aim.find(&report)
        };
        assert_eq!(find("push_torso.run.left_newton"), Ok(Some(375.0)));
        assert_eq!(find("push_torso.run.right_newton"), Ok(None));
        assert_eq!(find("straight.speed.0.reached_mps"), Ok(Some(1.5)));
        assert_eq!(find("robustness.strength_x0.8.run.falls"), Ok(Some(2.0)), "a key with a dot");
        assert!(find("robustness.strength_x0.7.run.falls").unwrap_err().contains("expected strength_x0 in"));
        let wrong = find("push_torso.run.left").unwrap_err();
        assert!(wrong.contains("expected left in the report") && wrong.contains("right_newton"), "{wrong}");
        assert!(find("straight.speed.1.reached_mps").unwrap_err().contains("a list of 1"));
        assert!(find("push_torso.run").unwrap_err().contains("expected a number"));
    }

    #[test]
    fn the_searches_that_come_along_are_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/recipes/search");
        let files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
        assert!(!files.is_empty());
        for file in files {
            Search::load(&file).unwrap();
        }
    }

    #[test]
    fn what_does_not_fit_is_named() {
        for (from, to, named) in [
            ("of = [\"a\", \"b\", \"c\"]", "of = [\"a\"]", "weights: expected at least two"),
            ("gaits = [\"run\"]", "gaits = [\"hop\"]", "gaits: expected some of idle"),
            ("gaits = [\"run\"]", "weights = [1.0, 1.0, 1.0]", "weights: expected 3 weights"),
            ("gaits = [\"run\"]", "spread = 0.0", "spread: expected a number above 0"),
            ("gaits = [\"run\"]", "pull = -1.0", "pull: expected a number from 0 on"),
            ("gaits = [\"run\"]", "grounds = [\"moon\"]", "grounds: expected some of"),
            ("gaits = [\"run\"]", "cases = [\"drunk\"]", "cases: expected some of"),
            ("gaits = [\"run\"]", "stride = 1.0", "unknown field"),
            ("\"pushes\"", "\"kisses\"", "aims[1].section: expected one of paths"),
            ("scale = 50.0", "scale = 0.0", "aims[1].scale"),
            ("at_least = 350.0", "at_least = 350.0, at_most = 1.0", "aims[1].measure: expected at_most or"),
        ] {
            let error = parse(&TEXT.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(error.starts_with("x.toml") && error.contains(named), "{to}: {error}");
        }
    }
}
