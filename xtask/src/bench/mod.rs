//! The benchmarks, each as a table for people or as one JSON object for programs.
//!
//! With `--json` nothing but that object goes to stdout; what cargo and criterion say goes to stderr.

mod engines;
mod estimates;
mod peers;
mod policy;
mod training;

use anyhow::{Context, Result, ensure};
use clap::{Args, Subcommand};
use serde_json::{Map, Value};

use crate::setup::{self, Purpose};
use crate::workspace::{Workspace, output_of};

/// Arguments of `cargo xtask bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    #[command(subcommand)]
    subject: Subject,
}

/// The subjects of benchmarks.
#[derive(Debug, Subcommand)]
enum Subject {
    /// Nanoseconds to evaluate a policy, blend, tick and save, beside four inference libraries on the same network.
    Policy {
        /// Print one JSON object: evaluate_ns, fused_ns, cached_ns, batched_ns_per_character, tick_ns, pack_load_ms,
        /// pack_bytes, save_ns, restore_ns, save_bytes_ns, restore_bytes_ns, peers_ns.
        #[arg(long)]
        json: bool,
        /// Leave the other libraries out; building them the first time takes many minutes.
        #[arg(long)]
        no_peers: bool,
    },
    /// Milliseconds of a gradient step in the trainer's networks, beside two training libraries on the same networks.
    Training {
        /// Print one JSON object: one_thread_ms, one_thread_ratio, all_threads_ms, all_threads_ratio, threads.
        #[arg(long)]
        json: bool,
    },
    /// How many characters run in real time on all cores.
    Crowd {
        /// Print one JSON object: characters_realtime, bare_mujoco_characters, policy_share.
        #[arg(long)]
        json: bool,
    },
    /// How much faster than real time 64 characters and 200 props share one world on one core, and how many characters
    /// apart run in real time on all cores.
    World {
        /// Print one JSON object: realtime_factor, step_ms, characters_apart_realtime, build_ms, touching, and
        /// milliseconds a step of MuJoCo's stages.
        #[arg(long)]
        json: bool,
    },
    /// Microseconds of a physics step in Rapier and in MuJoCo, and of the Bevy plug-in's tick with 1 and 20 characters.
    Engines {
        /// Print one JSON object: rapier_step_us, mujoco_step_us, bevy_tick_us_1, bevy_tick_us_20.
        #[arg(long)]
        json: bool,
    },
    /// How many frames a second are drawn off screen.
    Frame {
        /// Print one JSON object: fps_1, fps_100, adapter.
        #[arg(long)]
        json: bool,
    },
}

/// Measures one subject.
///
/// # Errors
/// When the set-up, the build or the measurement fails, or a figure that was promised is missing.
pub fn run(workspace: &Workspace, arguments: &BenchArgs) -> Result<()> {
    setup::prepare(workspace, Purpose::Demo, true)?;
    let (json, figures) = match arguments.subject {
        Subject::Policy { json, no_peers } => (json, policy::measure(workspace, !no_peers)?),
        Subject::Training { json } => (json, training::measure(workspace)?),
        Subject::Engines { json } => (json, engines::measure(workspace)?),
        Subject::Crowd { json } => {
            let promised = ["characters_realtime", "bare_mujoco_characters", "policy_share"];
            (json, demo_bench(workspace, "bench-crowd", &promised)?)
        }
        Subject::World { json } => (json, world_bench(workspace)?),
        Subject::Frame { json } => {
            (json, demo_bench(workspace, "bench-frame", &["fps_1", "fps_100", "adapter"])?)
        }
    };
    if json {
        println!("{}", Value::Object(figures));
    } else {
        print!("{}", table(&figures));
    }
    Ok(())
}

/// Runs a benchmark of the demo and checks that it returns the promised figures.
fn demo_bench(workspace: &Workspace, verb: &str, promised: &[&str]) -> Result<Map<String, Value>> {
    let arguments = ["run", "--release", "-p", "viewer", "--bin", "policy-space", "--", verb, "--json"];
    let text = output_of(workspace.cargo().args(arguments))?;
    parse_figures(&text, promised).with_context(|| format!("read what `policy-space {verb} --json` wrote"))
}

/// Runs the benchmark of physics-bridge's shared world and checks that it returns the promised figures.
fn world_bench(workspace: &Workspace) -> Result<Map<String, Value>> {
    let arguments = ["bench", "-p", "physics-bridge", "--bench", "world", "--", "--json"];
    let text = output_of(workspace.cargo().args(arguments))?;
    parse_figures(&text, &["realtime_factor", "step_ms", "characters_apart_realtime"])
        .context("read what the benchmark `world` wrote")
}

fn parse_figures(text: &str, promised: &[&str]) -> Result<Map<String, Value>> {
    let figures: Map<String, Value> =
        serde_json::from_str(text.trim()).context("expected one JSON object")?;
    for name in promised {
        ensure!(figures.contains_key(*name), "expected the figure `{name}`, found none");
    }
    Ok(figures)
}

/// Figures as lines of name and value; an object inside is indented below its name.
fn table(figures: &Map<String, Value>) -> String {
    let mut text = String::new();
    for (name, value) in figures {
        match value {
            Value::Object(inner) => {
                text.push_str(&format!("{name}\n"));
                for line in table(inner).lines() {
                    text.push_str(&format!("  {line}\n"));
                }
            }
            Value::String(word) => text.push_str(&format!("{name:28} {word:>12}\n")),
            Value::Number(number) => {
                let number = number.as_f64().unwrap_or(f64::NAN);
                text.push_str(&format!("{name:28} {number:12.3}\n"));
            }
            other => text.push_str(&format!("{name:28} {other:>12}\n")),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn figures_that_were_promised_must_be_there() {
        let promised = ["fps_1", "adapter"];
        let figures = parse_figures("{\"fps_1\": 31.5, \"adapter\": \"llvmpipe\"}\n", &promised).unwrap();
        assert_eq!(figures["fps_1"], 31.5);
        let message = parse_figures("{\"fps_1\": 31.5}", &promised).unwrap_err().to_string();
        assert!(message.contains("`adapter`"), "{message}");
    }

    #[test]
    fn two_objects_or_talk_are_refused() {
        assert!(parse_figures("{} {}", &[]).is_err());
        assert!(parse_figures("measuring ...\n{}", &[]).is_err());
    }

    #[test]
    fn the_table_indents_what_is_inside() {
        let figures = json!({ "tick_ns": 2500.0, "peers_ns": { "tract": 5000.0 }, "adapter": "llvmpipe" });
        let text = table(figures.as_object().unwrap());
        assert!(text.contains("tick_ns                          2500.000\n"), "{text}");
        assert!(text.contains("peers_ns\n  tract "), "{text}");
    }
}
