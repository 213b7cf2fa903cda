//! Every check that CI runs, quick ones first. All of them run, whatever fails; a table says how each ended.

pub mod bevy;
mod c_interface;
mod definitions;
mod deny;
pub mod imports;
mod publish;
mod steps;
pub mod words;

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Result;

pub use publish::{PUBLISH, PUBLISH_ALL};
pub use steps::{ALL, C_INTERFACE, DENY};

use crate::workspace::Workspace;

/// How a check ended that could be started.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// It ran and found nothing.
    Passed,
    /// It cannot run on this machine, for this reason.
    Skipped(String),
}

/// One check: a name and what it does.
#[derive(Clone, Copy)]
pub struct Step {
    name: &'static str,
    run: fn(&Workspace) -> Result<Verdict>,
}

/// How one check ended, and how long it took.
struct Outcome {
    name: &'static str,
    result: Result<Verdict, String>,
    elapsed: Duration,
}

impl Outcome {
    fn failed(&self, strict: bool) -> bool {
        match self.result {
            Ok(Verdict::Passed) => false,
            Ok(Verdict::Skipped(_)) => strict,
            Err(_) => true,
        }
    }
}

/// Runs checks; the exit code says whether one failed. With `strict` a skipped check counts as failed.
pub fn run(workspace: &Workspace, steps: &[Step], strict: bool) -> ExitCode {
    let outcomes: Vec<Outcome> = steps.iter().map(|step| run_step(workspace, step)).collect();
    eprint!("{}", table(&outcomes, strict));
    if outcomes.iter().any(|outcome| outcome.failed(strict)) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn run_step(workspace: &Workspace, step: &Step) -> Outcome {
    eprintln!("\nxtask: {}", step.name);
    let start = Instant::now();
    let result = (step.run)(workspace).map_err(|error| format!("{error:#}"));
    match &result {
        Ok(Verdict::Passed) => {}
        Ok(Verdict::Skipped(reason)) => eprintln!("xtask: SKIPPED {}: {reason}", step.name),
        Err(message) => eprintln!("xtask: FAILED {}: {message}", step.name),
    }
    Outcome { name: step.name, result, elapsed: start.elapsed() }
}

fn table(outcomes: &[Outcome], strict: bool) -> String {
    let mut text = String::from("\nxtask: checks\n");
    for outcome in outcomes {
        let (word, note) = match &outcome.result {
            Ok(Verdict::Passed) => ("passed", ""),
            Ok(Verdict::Skipped(reason)) => ("skipped", reason.as_str()),
            Err(message) => ("FAILED", message.lines().next().unwrap_or_default()),
        };
        let line = format!("  {word:8} {:6.1} s  {:32} {note}", outcome.elapsed.as_secs_f64(), outcome.name);
        text.push_str(line.trim_end());
        text.push('\n');
    }
    let failed = outcomes.iter().filter(|outcome| outcome.failed(strict)).count();
    let total: Duration = outcomes.iter().map(|outcome| outcome.elapsed).sum();
    let skipped = outcomes.iter().filter(|outcome| matches!(outcome.result, Ok(Verdict::Skipped(_)))).count();
    let verdict = match (failed, skipped) {
        (0, 0) => "all checks passed".to_owned(),
        (0, skipped) => format!("{skipped} skipped, all others passed"),
        (failed, _) => format!("{failed} failed"),
    };
    text.push_str(&format!("  {verdict}, {:.0} s\n", total.as_secs_f64()));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(name: &'static str, result: Result<Verdict, String>) -> Outcome {
        Outcome { name, result, elapsed: Duration::from_millis(1500) }
    }

    #[test]
    fn a_skipped_check_fails_only_when_strict() {
        let skipped = outcome("deny", Ok(Verdict::Skipped("not installed".into())));
        assert!(!skipped.failed(false));
        assert!(skipped.failed(true));
        assert!(outcome("fmt", Err("no".into())).failed(false));
        assert!(!outcome("fmt", Ok(Verdict::Passed)).failed(true));
    }

    #[test]
    fn the_table_names_each_check_and_how_it_ended() {
        let outcomes = [
            outcome("formatting", Ok(Verdict::Passed)),
            outcome("cargo-deny", Ok(Verdict::Skipped("not installed".into()))),
            outcome("tests", Err("`cargo test` failed\nmore".into())),
        ];
        let text = table(&outcomes, false);
        assert!(text.contains("passed      1.5 s  formatting\n"), "{text}");
        assert!(text.contains("skipped") && text.contains("not installed"));
        assert!(text.contains("FAILED") && text.contains("`cargo test` failed\n"));
        assert!(text.ends_with("1 failed, 4 s\n"), "{text}");
        assert!(table(&outcomes[..2], false).ends_with("1 skipped, all others passed, 3 s\n"));
        assert!(table(&outcomes[..1], false).ends_with("all checks passed, 2 s\n"));
    }
}
