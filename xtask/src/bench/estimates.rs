//! Reads what criterion measured: the median of a benchmark, and how many elements one iteration handled.
//!
//! A benchmark lies in the folder of its own name or, when a group holds nothing else, one folder deeper.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use crate::workspace::Workspace;

/// The median of one benchmark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Nanoseconds for one iteration.
    pub median_ns: f64,
    /// Elements that one iteration handles, where the benchmark says so.
    pub elements: Option<u64>,
}

/// A folder below `target` for one run's measurements, emptied first: no figure of an earlier run can be taken for one
/// of this run.
///
/// # Errors
/// When what is left of an earlier run cannot be removed.
pub fn emptied(workspace: &Workspace, name: &str) -> Result<PathBuf> {
    let home = workspace.target().join(name);
    if home.exists() {
        fs::remove_dir_all(&home).with_context(|| format!("remove {}", home.display()))?;
    }
    Ok(home)
}

/// The estimate of the benchmark `name` below criterion's folder.
///
/// # Errors
/// When there is none, several, or one that cannot be read.
pub fn read(home: &Path, name: &str) -> Result<Estimate> {
    let found = measured_below(&home.join(name))?;
    match found.as_slice() {
        [one] => read_folder(one),
        [] => bail!("criterion measured no `{name}` (looked in {})", home.display()),
        several => bail!("expected one benchmark `{name}`, found {}", several.len()),
    }
}

/// The estimates of all benchmarks in the group `name`, by their own names, sorted.
///
/// # Errors
/// When the group cannot be read.
pub fn read_group(home: &Path, name: &str) -> Result<Vec<(String, Estimate)>> {
    let mut estimates = Vec::new();
    for folder in measured_below(&home.join(name))? {
        let function = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        estimates.push((function, read_folder(&folder)?));
    }
    Ok(estimates)
}

/// The folders of benchmarks: this one, or those directly below.
fn measured_below(folder: &Path) -> Result<Vec<PathBuf>> {
    let is_measured = |folder: &Path| folder.join("new/estimates.json").is_file();
    if is_measured(folder) {
        return Ok(vec![folder.to_path_buf()]);
    }
    let mut found = Vec::new();
    if folder.is_dir() {
        for entry in fs::read_dir(folder).with_context(|| format!("list {}", folder.display()))? {
            let path = entry?.path();
            if is_measured(&path) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn read_folder(folder: &Path) -> Result<Estimate> {
    let estimates = read_json(&folder.join("new/estimates.json"))?;
    let median_ns = estimates["median"]["point_estimate"]
        .as_f64()
        .with_context(|| format!("{}: expected a median, found none", folder.display()))?;
    ensure!(median_ns.is_finite() && median_ns > 0.0, "{}: median of {median_ns} ns", folder.display());
    let benchmark = read_json(&folder.join("new/benchmark.json"))?;
    Ok(Estimate { median_ns, elements: benchmark["throughput"]["Elements"].as_u64() })
}

fn read_json(path: &Path) -> Result<Value> {
    let text = fs::read_to_string(path).with_context(|| format!("read {}", path.display()))?;
    serde_json::from_str(&text).with_context(|| format!("parse {}", path.display()))
}

/// Writes what criterion would write for one benchmark.
#[cfg(test)]
pub fn pretend(home: &Path, benchmark: &str, median_ns: f64, elements: Option<u64>) {
    let folder = home.join(benchmark).join("new");
    fs::create_dir_all(&folder).unwrap();
    let estimates = serde_json::json!({ "median": { "point_estimate": median_ns } });
    fs::write(folder.join("estimates.json"), estimates.to_string()).unwrap();
    let throughput = elements.map(|count| serde_json::json!({ "Elements": count }));
    fs::write(folder.join("benchmark.json"), serde_json::json!({ "throughput": throughput }).to_string())
        .unwrap();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn a_benchmark_is_found_by_name_or_alone_in_its_group() {
        let home = ScratchFolder::new("estimates");
        pretend(home.path(), "tick", 2500.5, None);
        pretend(home.path(), "batched/256", 51200.0, Some(256));
        assert_eq!(read(home.path(), "tick").unwrap(), Estimate { median_ns: 2500.5, elements: None });
        assert_eq!(read(home.path(), "batched").unwrap().elements, Some(256));
    }

    #[test]
    fn none_and_several_are_errors() {
        let home = ScratchFolder::new("estimates-errors");
        assert!(read(home.path(), "tick").unwrap_err().to_string().contains("no `tick`"));
        pretend(home.path(), "tick/a", 1.0, None);
        pretend(home.path(), "tick/b", 1.0, None);
        assert!(read(home.path(), "tick").unwrap_err().to_string().contains("found 2"));
        let names: Vec<String> =
            read_group(home.path(), "tick").unwrap().into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["a", "b"]);
    }

    #[test]
    fn a_median_of_nothing_is_an_error() {
        let home = ScratchFolder::new("estimates-zero");
        pretend(home.path(), "tick", 0.0, None);
        assert!(read(home.path(), "tick").is_err());
        fs::write(home.path().join("tick/new/estimates.json"), "{\"median\":").unwrap();
        assert!(read(home.path(), "tick").is_err());
    }
}
