//! `trainer compare`: the paper's cost table.

use anyhow::Result;
use clap::Args;
use evaluation::compare::costs;
use trainer::training::POLICY_HIDDEN;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Blocks of 16 calls that are timed.
    #[arg(long, default_value_t = 2000)]
    repeats: usize,
}

/// Prints the table as Markdown.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    say(format_args!("| control step | networks | multiply-adds | microseconds |\n|---|---|---|---|"))?;
    for cost in costs(POLICY_HIDDEN, arguments.repeats)? {
        let widths = |n: &Vec<usize>| n.iter().map(ToString::to_string).collect::<Vec<_>>().join("-");
        let networks: Vec<String> = cost.networks.iter().map(widths).collect();
        let (name, count, time) = (&cost.name, cost.multiply_adds, cost.microseconds);
        say(format_args!("| {name} | {} | {count} | {time:.2} |", networks.join(" + ")))?;
    }
    Ok(())
}
