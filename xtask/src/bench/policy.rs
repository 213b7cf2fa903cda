//! `bench policy`: policy-core's own benchmarks, then the peers', in one run on one machine.
//!
//! The contract with `crates/policy-core/benches/{policy,tick,state}.rs`: benchmarks, or groups of one, named
//! `evaluate`, `fused`, `cached`, `batched`, `tick`, `pack_load`, `save`, `restore`, `save_bytes` and `restore_bytes`;
//! one iteration of `batched` evaluates [`BATCH`] characters, unless its throughput names another number of elements.
//! `pack_load` loads [`PACK`]. The peers are the group `peers` of `benches/peers`,
//! one benchmark each.

use std::path::Path;

use anyhow::{Context, Result};
use serde_json::{Map, Value, json};

use super::estimates::{Estimate, emptied, read, read_group};
use super::peers::{self, Peers, quiet};
use crate::setup;
use crate::workspace::{Workspace, run};

/// The half of `benches/peers` that evaluates the policy.
const PEERS: Peers = Peers { feature: "inference", bench: "peers" };

/// The pack that is loaded, in the workspace's root.
const PACK: &str = "assets/humanoid.pack.safetensors";

/// Characters in one iteration of `batched`.
const BATCH: u64 = 256;

/// Measures and collects the figures.
///
/// # Errors
/// When a benchmark cannot be built or run, or a figure is missing.
pub fn measure(workspace: &Workspace, with_peers: bool) -> Result<Map<String, Value>> {
    let home = emptied(workspace, "bench-policy")?;
    if with_peers {
        peers::build(workspace, &PEERS)?;
    }
    let own = ["bench", "-p", "policy-core", "--bench", "policy", "--bench", "tick", "--bench", "state"];
    run(quiet(workspace.cargo().args(own).env("CRITERION_HOME", &home)))?;
    if with_peers {
        let library = setup::onnx_runtime(workspace)?;
        // One thread for everybody; some libraries would wake a pool for a job of microseconds.
        let mut peers = peers::bench(workspace, &PEERS, 1);
        run(quiet(peers.env("CRITERION_HOME", &home).env("ORT_DYLIB_PATH", library)))?;
    }
    let mut figures = figures(&home)?;
    let pack = workspace.root().join(PACK);
    let pack = std::fs::metadata(&pack).with_context(|| format!("find {}", pack.display()))?;
    figures.insert("pack_bytes".to_owned(), json!(pack.len()));
    Ok(figures)
}

/// The figures of everything that was measured below criterion's folder.
fn figures(home: &Path) -> Result<Map<String, Value>> {
    let mut figures = Map::new();
    for name in ["evaluate", "fused", "cached", "tick", "save", "restore", "save_bytes", "restore_bytes"] {
        figures.insert(format!("{name}_ns"), rounded(read(home, name)?.median_ns));
    }
    figures.insert("batched_ns_per_character".to_owned(), rounded(per_character(read(home, "batched")?)));
    let load_ms = read(home, "pack_load")?.median_ns / 1e6;
    figures.insert("pack_load_ms".to_owned(), json!((load_ms * 1000.0).round() / 1000.0));
    let peers = read_group(home, "peers")?.into_iter();
    let peers: Map<String, Value> =
        peers.map(|(name, estimate)| (name, rounded(estimate.median_ns))).collect();
    figures.insert("peers_ns".to_owned(), Value::Object(peers));
    Ok(figures)
}

fn per_character(estimate: Estimate) -> f64 {
    estimate.median_ns / estimate.elements.filter(|count| *count > 0).unwrap_or(BATCH) as f64
}

/// Tenths of a nanosecond: more digits than a clock has.
fn rounded(nanoseconds: f64) -> Value {
    json!((nanoseconds * 10.0).round() / 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::estimates::pretend;
    use crate::workspace::ScratchFolder;

    fn measured(name: &str) -> ScratchFolder {
        let home = ScratchFolder::new(name);
        for (benchmark, median) in [
            ("evaluate", 776.04),
            ("fused", 1911.0),
            ("cached", 790.0),
            ("tick", 2600.0),
            ("pack_load", 9_123_456.0),
            ("save", 120.0),
            ("restore", 150.0),
            ("save_bytes", 900.0),
            ("restore_bytes", 1100.0),
        ] {
            pretend(home.path(), benchmark, median, None);
        }
        pretend(home.path(), "batched/256", 256.0 * 300.0, Some(256));
        home
    }

    #[test]
    fn every_figure_is_there_under_its_agreed_name() {
        let home = measured("policy-figures");
        pretend(home.path(), "peers/tract", 4973.0, None);
        pretend(home.path(), "peers/onnxruntime", 3477.0, None);
        let expected = json!({
            "evaluate_ns": 776.0,
            "fused_ns": 1911.0,
            "cached_ns": 790.0,
            "batched_ns_per_character": 300.0,
            "tick_ns": 2600.0,
            "pack_load_ms": 9.123,
            "save_ns": 120.0,
            "restore_ns": 150.0,
            "save_bytes_ns": 900.0,
            "restore_bytes_ns": 1100.0,
            "peers_ns": { "onnxruntime": 3477.0, "tract": 4973.0 },
        });
        assert_eq!(Value::Object(figures(home.path()).unwrap()), expected);
    }

    #[test]
    fn without_peers_their_object_is_empty() {
        let home = measured("policy-no-peers");
        assert_eq!(figures(home.path()).unwrap()["peers_ns"], json!({}));
    }

    #[test]
    fn the_size_of_a_batch_is_the_agreed_one_unless_it_is_named() {
        let of = |elements| per_character(Estimate { median_ns: 5120.0, elements });
        assert_eq!((of(None), of(Some(512))), (20.0, 10.0));
    }

    #[test]
    fn a_missing_figure_is_an_error() {
        let home = measured("policy-errors");
        std::fs::remove_dir_all(home.path().join("cached")).unwrap();
        assert!(figures(home.path()).unwrap_err().to_string().contains("`cached`"));
    }
}
