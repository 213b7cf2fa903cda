//! Every check that CI runs, quick ones first. All of them run, whatever fails; a table says how each ended.

pub mod deny;
pub mod imports;
mod steps;

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::workspace::Workspace;

/// How the checks are to be run.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    /// A check that cannot run here counts as failed.
    pub strict: bool,
    /// Install cargo-deny when it is missing.
    pub install_deny: bool,
}

/// How a check ended that could be started.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// It ran and found nothing.
    Passed,
    /// It cannot run on this machine, for this reason.
    Skipped(String),
}

/// One check: a name and what it does.
struct Step {
    name: &'static str,
    run: fn(&Workspace, Options) -> Result<Verdict>,
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

/// Runs all checks; the exit code says whether one failed.
pub fn run(workspace: &Workspace, options: Options) -> ExitCode {
    let outcomes: Vec<Outcome> = steps::STEPS.iter().map(|step| run_step(workspace, step, options)).collect();
    eprint!("{}", table(&outcomes, options.strict));
    if outcomes.iter().any(|outcome| outcome.failed(options.strict)) {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

fn run_step(workspace: &Workspace, step: &Step, options: Options) -> Outcome {
    eprintln!("\nxtask: {}", step.name);
    let start = Instant::now();
    let result = (step.run)(workspace, options).map_err(|error| format!("{error:#}"));
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
    let verdict = if failed == 0 { "all checks passed".to_owned() } else { format!("{failed} failed") };
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
    }
}
