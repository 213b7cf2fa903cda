//! The course of a search: which weights are next, and what was found.

use std::collections::BTreeMap;

use anyhow::{Error, Result};
use evaluation::Section;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Cma, Search};

/// Weights and offsets are rounded to thousandths before they are measured: what is found can then be written down.
const STEPS_PER_UNIT: f64 = 1000.0;

/// What is tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Weight of each policy.
    pub weights: Vec<f64>,
    /// Offset of each joint of the posture, radians.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub posture: BTreeMap<String, f64>,
}

/// What was tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Weights and posture.
    #[serde(flatten)]
    pub candidate: Candidate,
    /// What they cost; sections that were not measured cost what they did in the best trial then.
    pub cost: f64,
    /// The number of each aim; missing at the end where the trial was given up.
    pub measured: Vec<Option<f64>>,
}

/// A search under way.
#[derive(Clone, Debug)]
pub struct Searcher {
    search: Search,
    start: Candidate,
    cma: Cma,
    best: Option<Trial>,
    tries: usize,
}

impl Searcher {
    /// Begins at the weights and the posture of the search.
    #[must_use]
    pub fn new(search: Search, seed: u64) -> Self {
        let weights = match search.weights.is_empty() {
            true => vec![1.0 / search.of.len() as f64; search.of.len()],
            false => search.weights.clone(),
        };
        // Weights add up to 1, so the first one follows from the others.
        let mean = weights[1..].iter().chain(search.posture.values()).copied().collect();
        let cma = Cma::new(mean, search.spread, seed);
        let start = Candidate { weights, posture: search.posture.clone() };
        Self { search, start, cma, best: None, tries: 0 }
    }

    /// The best trial so far.
    #[must_use]
    pub fn best(&self) -> Option<&Trial> {
        self.best.as_ref()
    }

    /// Trials so far.
    #[must_use]
    pub fn tries(&self) -> usize {
        self.tries
    }

    /// Tries the next candidate. `measure` gives the report of a section with it.
    ///
    /// # Errors
    /// When `measure` fails, or a report lacks the number of an aim.
    pub fn go_on(&mut self, mut measure: impl FnMut(&Candidate, Section) -> Result<Value>) -> Result<Trial> {
        // Asked of a copy: what fails leaves the search as it was.
        let mut cma = self.cma.clone();
        let candidate = self.candidate(&cma.ask());
        let pull = self.search.pull * candidate.apart(&self.start);
        let mut numbers = vec![None; self.search.aims.len()];
        let mut costs = vec![None; self.search.aims.len()];
        let known = |costs: &[Option<f64>]| pull + costs.iter().flatten().sum::<f64>();
        for section in self.search.sections() {
            if self.best.as_ref().is_some_and(|best| known(&costs) > best.cost) {
                break;
            }
            let report = measure(&candidate, section)?;
            for (index, aim) in self.search.aims.iter().enumerate() {
                if aim.section == section.name() {
                    let number = aim.find(&report).map_err(Error::msg)?;
                    (numbers[index], costs[index]) = (number, Some(aim.cost(number)));
                }
            }
        }
        let as_best = |index: usize| {
            let best = self.best.as_ref()?;
            Some(self.search.aims[index].cost(*best.measured.get(index)?))
        };
        let unknown = (0..costs.len()).filter(|index| costs[*index].is_none()).filter_map(as_best);
        let cost = known(&costs) + unknown.sum::<f64>();
        let trial = Trial { candidate, cost, measured: numbers };
        cma.tell(cost);
        self.cma = cma;
        self.keep(&trial);
        Ok(trial)
    }

    /// Takes a trial that an earlier run of this search has made.
    ///
    /// # Errors
    /// When it is not the one that comes next: what was expected, and what was found.
    pub fn replay(&mut self, trial: &Trial) -> std::result::Result<(), [String; 2]> {
        let expected = self.candidate(&self.cma.clone().ask());
        if trial.candidate != expected || trial.measured.len() != self.search.aims.len() {
            return Err([expected.to_string(), trial.candidate.to_string()]);
        }
        self.cma.ask();
        self.cma.tell(trial.cost);
        self.keep(trial);
        Ok(())
    }

    fn keep(&mut self, trial: &Trial) {
        self.tries += 1;
        if self.best.as_ref().is_none_or(|best| trial.cost < best.cost) {
            self.best = Some(trial.clone());
        }
    }

    /// The candidate of the numbers that were drawn.
    fn candidate(&self, drawn: &[f64]) -> Candidate {
        let round = |number: f64| (number * STEPS_PER_UNIT).round() / STEPS_PER_UNIT;
        let drawn: Vec<f64> = drawn.iter().map(|number| round(*number)).collect();
        let (others, offsets) = drawn.split_at(self.start.weights.len() - 1);
        let first = round(1.0 - others.iter().sum::<f64>());
        Candidate {
            weights: std::iter::once(first).chain(others.iter().copied()).collect(),
            posture: self.start.posture.keys().cloned().zip(offsets.iter().copied()).collect(),
        }
    }
}

impl std::fmt::Display for Candidate {
    /// As `trainer average` takes them.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let weights: Vec<String> = self.weights.iter().map(f64::to_string).collect();
        write!(f, "weights {}", weights.join(","))?;
        let posture: Vec<String> =
            self.posture.iter().map(|(joint, offset)| format!("{joint}={offset}")).collect();
        if posture.is_empty() { Ok(()) } else { write!(f, ", posture {}", posture.join(",")) }
    }
}

impl Candidate {
    /// Sum of the differences between the numbers of two candidates of one search.
    fn apart(&self, other: &Self) -> f64 {
        let numbers = |of: &Self| of.weights.iter().chain(of.posture.values()).copied().collect::<Vec<f64>>();
        numbers(self).iter().zip(numbers(other)).map(|(a, b)| (a - b).abs()).sum()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use serde_json::json;

    use super::super::tests::TEXT;
    use super::*;

    fn searcher(seed: u64) -> Searcher {
        Searcher::new(Search::parse(Path::new("x"), TEXT).unwrap(), seed)
    }

    /// A made-up evaluation: the pose is best at weights of 0.5, -0.2, 0.7, and pushes are borne there.
    fn report(candidate: &Candidate, section: Section) -> Result<Value> {
        let off: f64 = candidate.weights.iter().zip([0.5, -0.2, 0.7]).map(|(w, best)| (w - best).abs()).sum();
        Ok(match section {
            Section::Motion => {
                json!({ "pose_error_m": { "run": 0.1 + 0.1 * off }, "motion": { "run": { "speed_mps": 2.5 } } })
            }
            _ => json!({ "push_torso": { "run": { "left_newton": 350.0 - 100.0 * off } } }),
        })
    }

    #[test]
    fn it_finds_weights_that_reach_its_aims() {
        let mut searcher = searcher(1);
        let mut measured = [0, 0];
        for _ in 0..600 {
            let trial = searcher.go_on(|candidate, section| {
                measured[usize::from(section == Section::Pushes)] += 1;
                report(candidate, section)
            });
            let sum: f64 = trial.unwrap().candidate.weights.iter().sum();
            assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        }
        let best = searcher.best().unwrap();
        assert!(best.cost < 0.1, "{best:?}");
        assert!((best.candidate.weights[1] + 0.2).abs() < 0.02, "{best:?}");
        // What is worse already is not measured further.
        assert!(measured[0] == 600 && measured[1] < 500, "{measured:?}");
    }

    #[test]
    fn a_posture_is_searched_beside_the_weights() {
        let text =
            TEXT.replacen("gaits", "posture = { abdomen_y = 0.1, neck_y = 0.0 }\npull = 1.0\ngaits", 1);
        let mut searcher = Searcher::new(Search::parse(Path::new("x"), &text).unwrap(), 5);
        let leaning = |candidate: &Candidate, section| {
            let mut report = report(candidate, section)?;
            if section == Section::Motion {
                let off = (candidate.posture["abdomen_y"] - 0.15).abs();
                report["pose_error_m"]["run"] = json!(0.1 + off);
            }
            Ok(report)
        };
        let first = searcher.go_on(leaning).unwrap();
        let line = serde_json::to_string(&first).unwrap();
        assert_eq!(serde_json::from_str::<Trial>(&line).unwrap(), first, "{line}");
        (0..600).for_each(|_| _ = searcher.go_on(leaning).unwrap());
        let best = searcher.best().unwrap();
        assert!((best.candidate.posture["abdomen_y"] - 0.15).abs() < 0.01, "{best:?}");
        assert!(best.cost < 0.3 * first.cost, "{first:?} {best:?}");
    }

    #[test]
    fn it_goes_on_where_an_earlier_run_stopped() {
        let (mut whole, mut first) = (searcher(2), searcher(2));
        let trials: Vec<Trial> = (0..30).map(|_| whole.go_on(report).unwrap()).collect();
        for trial in &trials[..17] {
            first.replay(trial).unwrap();
        }
        let rest: Vec<Trial> = (17..30).map(|_| first.go_on(report).unwrap()).collect();
        assert_eq!(rest, trials[17..]);
        assert_eq!((first.best(), first.tries()), (whole.best(), 30));
        let [expected, found] = searcher(3).replay(&trials[1]).unwrap_err();
        assert!(expected.contains("0.33") && found != expected, "{expected} {found}");
    }

    #[test]
    fn what_fails_leaves_the_search_as_it_was() {
        let mut searcher = searcher(4);
        searcher.go_on(report).unwrap();
        let failed = searcher.go_on(|_, _| Err(Error::msg("no")));
        assert_eq!(failed.unwrap_err().to_string(), "no");
        let missing = searcher.go_on(|_, _| Ok(json!({})));
        assert!(missing.unwrap_err().to_string().contains("pose_error_m"));
        assert_eq!(searcher.tries(), 1);
        searcher.go_on(report).unwrap();
        assert_eq!(searcher.tries(), 2);
    }
}
