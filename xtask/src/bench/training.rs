//! `bench training`: one gradient step of the recipes' networks in the trainer and in two training libraries, with one
//! thread and with one for every core.
//!
//! The contract with `benches/peers/benches/training.rs`: a group for each of [`JOBS`], in it a benchmark `trainer` and
//! one for each library.

use std::path::Path;
use std::thread::available_parallelism;

use anyhow::{Context, Result, ensure};
use serde_json::{Map, Value, json};

use super::estimates::{emptied, read_group};
use super::peers::{self, Peers, quiet};
use crate::workspace::{Workspace, run};

/// The half of `benches/peers` that trains.
const PEERS: Peers = Peers { feature: "training", bench: "training" };

const JOBS: [&str; 4] = ["critic", "actor", "discriminator", "discriminator_with_penalty"];

/// The one that the others are compared with.
const OWN: &str = "trainer";

/// Measures and collects the figures.
///
/// # Errors
/// When the benchmark cannot be built or run, or a figure is missing.
pub fn measure(workspace: &Workspace) -> Result<Map<String, Value>> {
    peers::build(workspace, &PEERS)?;
    let home = emptied(workspace, "bench-training")?;
    let cores = available_parallelism().context("count the cores")?.get();
    let mut figures = Map::new();
    for (prefix, threads) in [("one_thread", 1), ("all_threads", cores)] {
        let home = home.join(prefix);
        run(quiet(peers::bench(workspace, &PEERS, threads).env("CRITERION_HOME", &home)))?;
        add_figures(&home, prefix, &mut figures)?;
    }
    figures.insert("threads".to_owned(), json!(cores));
    Ok(figures)
}

/// Adds `<prefix>_ms` and `<prefix>_ratio`, by job and library; the ratio is to the trainer's time.
fn add_figures(home: &Path, prefix: &str, figures: &mut Map<String, Value>) -> Result<()> {
    let (mut times, mut ratios) = (Map::new(), Map::new());
    for job in JOBS {
        let group = read_group(home, job)?;
        let own = group.iter().find(|(name, _)| name == OWN);
        let (_, own) = own.with_context(|| format!("criterion measured no `{job}/{OWN}`"))?;
        ensure!(group.len() > 1, "expected libraries beside `{job}/{OWN}`, found none");
        let of = |figure: fn(f64, f64) -> f64| -> Map<String, Value> {
            let figure = |ns| json!((figure(ns, own.median_ns) * 1000.0).round() / 1000.0);
            group.iter().map(|(name, estimate)| (name.clone(), figure(estimate.median_ns))).collect()
        };
        times.insert(job.to_owned(), Value::Object(of(|ns, _| ns / 1e6)));
        ratios.insert(job.to_owned(), Value::Object(of(|ns, own| ns / own)));
    }
    figures.insert(format!("{prefix}_ms"), Value::Object(times));
    figures.insert(format!("{prefix}_ratio"), Value::Object(ratios));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::estimates::pretend;
    use crate::workspace::ScratchFolder;

    #[test]
    fn times_are_milliseconds_and_ratios_to_the_trainer() {
        let home = ScratchFolder::new("training-figures");
        for job in JOBS {
            pretend(home.path(), &format!("{job}/trainer"), 2e6, None);
            pretend(home.path(), &format!("{job}/candle"), 5e6, None);
        }
        let mut figures = Map::new();
        add_figures(home.path(), "one_thread", &mut figures).unwrap();
        assert_eq!(figures["one_thread_ms"]["actor"], json!({ "trainer": 2.0, "candle": 5.0 }));
        assert_eq!(figures["one_thread_ratio"]["critic"], json!({ "trainer": 1.0, "candle": 2.5 }));
    }

    #[test]
    fn a_job_without_the_trainer_or_without_a_library_is_an_error() {
        let home = ScratchFolder::new("training-errors");
        pretend(home.path(), "critic/candle", 5e6, None);
        let message = add_figures(home.path(), "one_thread", &mut Map::new()).unwrap_err().to_string();
        assert!(message.contains("`critic/trainer`"), "{message}");
        std::fs::remove_dir_all(home.path().join("critic")).unwrap();
        pretend(home.path(), "critic/trainer", 2e6, None);
        let message = add_figures(home.path(), "one_thread", &mut Map::new()).unwrap_err().to_string();
        assert!(message.contains("found none"), "{message}");
    }
}
