//! What the ways came to, and whether they agree.

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

/// What one way came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    name: String,
    result: std::result::Result<Ran, String>,
}

/// A run: the hash after each second, and the time that it took.
#[derive(Clone, Debug, PartialEq)]
struct Ran {
    hashes: Vec<String>,
    last: String,
    seconds: f64,
    /// What happened in it; `None` for a module that does not say.
    complete: Option<bool>,
}

impl Outcome {
    /// A way that this machine can't go.
    pub fn skipped(name: &str, reason: String) -> Self {
        Self { name: name.into(), result: Err(reason) }
    }

    /// What a run printed.
    ///
    /// # Errors
    /// When it printed something else.
    pub fn of(name: &str, text: &str) -> Result<Self> {
        let value: Value =
            serde_json::from_str(text).with_context(|| format!("{name}: expected one JSON object"))?;
        let texts = |value: &Value| -> Option<Vec<String>> {
            value.as_array()?.iter().map(|hash| hash.as_str().map(str::to_owned)).collect()
        };
        let read = || {
            let told = ["rolled", "fell", "got_up"].map(|key| value[key].as_bool());
            Some(Ran {
                hashes: texts(&value["hashes"])?,
                last: value["hash"].as_str()?.to_owned(),
                seconds: value["seconds"].as_f64()?,
                complete: told.into_iter().try_fold(true, |all, one| one.map(|one| all && one)),
            })
        };
        let ran = read().with_context(|| format!("{name}: expected hashes and seconds, found {text}"))?;
        ensure!(!ran.hashes.is_empty(), "{name}: expected at least one hash, found none");
        Ok(Self { name: name.into(), result: Ok(ran) })
    }
}

/// All of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// In the order in which they ran.
    pub outcomes: Vec<Outcome>,
}

impl Report {
    fn ran(&self) -> impl Iterator<Item = (&str, &Ran)> {
        self.outcomes.iter().filter_map(|o| Some((o.name.as_str(), o.result.as_ref().ok()?)))
    }

    /// Passes when at least two ways ran, all of them have the same hash after every second, and the run had a roll, a fall
    /// and a get-up in it.
    ///
    /// # Errors
    /// Else; names the first second in which two ways differ.
    pub fn check(&self) -> Result<()> {
        let mut ran = self.ran();
        let Some((first_name, first)) = ran.next() else { bail!("expected ways that run here, found none") };
        let mut others = 0;
        for (name, other) in ran {
            others += 1;
            if let Some(second) = first.hashes.iter().zip(&other.hashes).position(|(a, b)| a != b) {
                let (expected, found) = (&first.hashes[second], &other.hashes[second]);
                bail!(
                    "after second {}: expected the state {expected} of {first_name}, found {found} in {name}",
                    second + 1
                );
            }
            ensure!(
                first.last == other.last && first.hashes.len() == other.hashes.len(),
                "{name} ends otherwise"
            );
        }
        ensure!(others > 0, "expected two ways to compare, found {first_name} alone");
        for (name, ran) in self.ran() {
            ensure!(
                ran.complete != Some(false),
                "{name}: expected a roll, a fall and a get-up, found not all"
            );
        }
        Ok(())
    }

    /// One JSON object.
    pub fn json(&self) -> String {
        let ways: Vec<Value> = self
            .outcomes
            .iter()
            .map(|outcome| match &outcome.result {
                Ok(ran) => json!({"name": outcome.name, "hash": ran.last, "seconds": ran.seconds}),
                Err(reason) => json!({"name": outcome.name, "skipped": reason}),
            })
            .collect();
        json!({"equal": self.check().is_ok(), "ways": ways}).to_string()
    }

    /// A table for people.
    pub fn table(&self) -> String {
        let mut text = String::new();
        for outcome in &self.outcomes {
            text += &match &outcome.result {
                Ok(ran) => format!("{:22} {}  {:6.1} s\n", outcome.name, ran.last, ran.seconds),
                Err(reason) => format!("{:22} skipped: {reason}\n", outcome.name),
            };
        }
        text + if self.check().is_ok() { "all equal after every second\n" } else { "NOT EQUAL\n" }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(name: &str, hashes: &[&str]) -> Outcome {
        let last = hashes.last().unwrap();
        let text = json!({"hash": last, "seconds": 1.5, "hashes": hashes}).to_string();
        Outcome::of(name, &text).unwrap()
    }

    #[test]
    fn equal_ways_pass_and_the_first_difference_is_named() {
        let mut report = Report { outcomes: vec![outcome("debug", &["a", "b", "c"])] };
        assert!(report.check().unwrap_err().to_string().contains("alone"));
        report.outcomes.push(Outcome::skipped("arm64", "no emulator".into()));
        report.outcomes.push(outcome("wasm32", &["a", "b", "c"]));
        report.check().unwrap();
        assert!(report.table().contains("skipped: no emulator") && report.json().contains("\"equal\":true"));
        report.outcomes.push(outcome("release", &["a", "x", "c"]));
        let said = report.check().unwrap_err().to_string();
        assert!(said.contains("after second 2") && said.contains("found x in release"), "{said}");
        assert!(report.table().ends_with("NOT EQUAL\n"));
    }

    #[test]
    fn a_run_without_a_get_up_does_not_pass() {
        let text = r#"{"hash": "a", "seconds": 1.0, "hashes": ["a"], "rolled": true, "fell": true, "got_up": false}"#;
        let lazy = Outcome::of("debug", text).unwrap();
        let report = Report { outcomes: vec![lazy, outcome("wasm32", &["a"])] };
        assert!(report.check().unwrap_err().to_string().contains("get-up"));
        assert!(Outcome::of("debug", "{}").is_err() && Outcome::of("debug", "no").is_err());
    }
}
