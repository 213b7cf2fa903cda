//! `cargo xtask determinism`: one fixed run of 20 s, built in several ways and for several processors; the hashes of its
//! states have to be equal.
//!
//! The run is the example `determinism` of `lockstep`, the only place where Rapier's `enhanced-determinism` is turned on.

mod report;
mod ways;

use anyhow::{Result, ensure};
use clap::Args;

use self::report::{Outcome, Report};
use self::ways::WAYS;
use crate::workspace::Workspace;

/// Arguments of `cargo xtask determinism`.
#[derive(Debug, Args)]
pub struct DeterminismArgs {
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
    /// Characters in the run, 1 to 8.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8))]
    players: u8,
    /// Only these, such as --only debug,wasm32; each of them has to run.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
}

/// Builds and runs every way, and compares.
///
/// # Errors
/// When a way can't be built or run, is unknown, or two ways end in different states.
pub fn run(workspace: &Workspace, arguments: &DeterminismArgs) -> Result<()> {
    let names = WAYS.map(|way| way.name);
    for name in &arguments.only {
        ensure!(names.contains(&name.as_str()), "expected one of {}, found {name}", names.join(", "));
    }
    let mut report = Report::default();
    for way in
        WAYS.iter().filter(|way| arguments.only.is_empty() || arguments.only.iter().any(|n| n == way.name))
    {
        let needed = !arguments.only.is_empty();
        let lacks = (way.lacks)(workspace);
        if let Some(reason) = lacks {
            ensure!(!needed, "{}: {reason}", way.name);
            eprintln!("xtask: skipped {}: {reason}", way.name);
            report.outcomes.push(Outcome::skipped(way.name, reason));
            continue;
        }
        eprintln!("xtask: {}", way.name);
        for threads in way.threads {
            let text = (way.run)(workspace, arguments.players, *threads)?;
            let name =
                if *threads > 1 { format!("{}, {threads} threads", way.name) } else { way.name.into() };
            report.outcomes.push(Outcome::of(&name, &text)?);
        }
    }
    if arguments.json {
        println!("{}", report.json());
    } else {
        print!("{}", report.table());
    }
    report.check()
}
