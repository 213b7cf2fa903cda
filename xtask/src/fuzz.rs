//! Runs the fuzz targets of `fuzz/`, one after the other.
//!
//! They need a nightly compiler, so they are no part of the checks.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::Value;

use crate::setup::{self, Purpose};
use crate::workspace::{Workspace, answers, output_of, run as run_command};

/// Arguments of `cargo xtask fuzz`.
#[derive(Debug, Args)]
pub struct FuzzArgs {
    /// The target to run; all of them when none is named.
    target: Option<String>,
    /// Minutes for each target.
    #[arg(long, default_value_t = 10.0)]
    minutes: f64,
}

/// Runs one target or all of them.
///
/// # Errors
/// When the tools are missing, the target is unknown, or a target found an input that breaks it.
pub fn run(workspace: &Workspace, arguments: &FuzzArgs) -> Result<()> {
    let targets = chosen(&targets(workspace)?, arguments.target.as_deref())?;
    let seconds = arguments.minutes * 60.0;
    ensure!((1.0..1e6).contains(&seconds), "expected minutes above 0, found {}", arguments.minutes);
    if !answers(Command::new("rustup").args(["run", "nightly", "cargo", "fuzz", "--version"])) {
        bail!(
            "fuzzing needs a nightly toolchain and cargo-fuzz:\n    rustup toolchain install nightly\n    \
             cargo install cargo-fuzz"
        );
    }
    setup::prepare(workspace, Purpose::Demo, false)?;
    for target in targets {
        eprintln!("xtask: fuzzing {target} for {} minutes", arguments.minutes);
        seed(workspace.root(), &target)?;
        // Whatever toolchain runs this program must not be forced upon the nightly cargo.
        run_command(
            workspace
                .command("rustup")
                .env_remove("RUSTUP_TOOLCHAIN")
                .env_remove("CARGO")
                .args(["run", "nightly", "cargo", "fuzz", "run", &target, "--"])
                .arg(format!("-max_total_time={seconds:.0}"))
                .arg(length_limit(&target)),
        )?;
    }
    Ok(())
}

/// The names of all targets: the binaries of `fuzz/Cargo.toml`.
fn targets(workspace: &Workspace) -> Result<Vec<String>> {
    let arguments = ["metadata", "--no-deps", "--format-version", "1", "--manifest-path", "fuzz/Cargo.toml"];
    let metadata = output_of(workspace.cargo().args(arguments))?;
    target_names(&metadata).context("read what cargo metadata says of fuzz/Cargo.toml")
}

fn target_names(metadata: &str) -> Result<Vec<String>> {
    let metadata: Value = serde_json::from_str(metadata)?;
    let targets = metadata["packages"][0]["targets"].as_array().context("it lists no targets")?;
    let is_binary =
        |target: &&Value| target["kind"].as_array().is_some_and(|kinds| kinds.contains(&"bin".into()));
    let names = targets.iter().filter(is_binary).filter_map(|target| target["name"].as_str());
    Ok(names.map(str::to_owned).collect())
}

/// Input of most targets is short, and bounds what one may take; some files are longer than 4 KiB.
fn length_limit(target: &str) -> &'static str {
    match target {
        "pack" => "-max_len=1000000",
        "manifest" | "replay" => "-max_len=65536",
        "gltf" | "mjcf" | "clip" => "-max_len=16384",
        "state" | "recipe" | "checkpoint" | "scene" => "-max_len=8192",
        _ => "-max_len=4096",
    }
}

/// Starts a target's corpus with what the project ships: sound input is the best to mutate. `fuzz/seeds` has the corpora
/// that earlier runs found, minimised, where they are small.
fn seed(root: &Path, target: &str) -> Result<()> {
    let corpus = root.join("fuzz/corpus").join(target);
    fs::create_dir_all(&corpus).with_context(|| format!("create {}", corpus.display()))?;
    let mut shipped = Vec::new();
    let folders: &[(&str, &str)] = match target {
        // The small pack, whose tensors the target of manifests uses.
        "pack" | "manifest" => &[("tests/golden", "safetensors")],
        "script" => &[("assets/scripts", "ron")],
        "scene" => &[("assets/scenes", "ron")],
        "mjcf" => &[("tests/assets", "xml"), ("assets", "xml")],
        "recipe" => &[("assets/recipes", "toml"), ("assets/recipes/lineage", "toml")],
        "clip" => &[
            ("tests/hostile/seeds/clip", "json"),
            ("tests/hostile/seeds/clip", "txt"),
            ("tests/hostile/seeds/clip", "npy"),
        ],
        _ => &[],
    };
    for (folder, ending) in folders {
        shipped.extend(files_with_extension(&root.join(folder), ending)?);
    }
    let found = root.join("fuzz/seeds").join(target);
    if found.is_dir() {
        for entry in fs::read_dir(&found).with_context(|| format!("list {}", found.display()))? {
            shipped.push(entry?.path());
        }
    }
    for path in shipped {
        let mut bytes = fs::read(&path).with_context(|| format!("read {}", path.display()))?;
        if target == "manifest" && path.extension().is_some_and(|ending| ending == "safetensors") {
            bytes = manifest_of(&bytes).with_context(|| format!("{} is no pack", path.display()))?;
        }
        let seed = corpus.join(path.file_name().unwrap_or_default());
        fs::write(&seed, bytes).with_context(|| format!("write {}", seed.display()))?;
    }
    Ok(())
}

/// The manifest inside a pack: a safetensors file opens with the length of its JSON header, eight bytes.
fn manifest_of(pack: &[u8]) -> Option<Vec<u8>> {
    let (length, rest) = pack.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let header: Value = serde_json::from_slice(rest.get(..length)?).ok()?;
    Some(header["__metadata__"]["policy_space"].as_str()?.as_bytes().to_vec())
}

fn files_with_extension(folder: &Path, wanted: &str) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("list {}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == wanted) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn chosen(targets: &[String], asked: Option<&str>) -> Result<Vec<String>> {
    match asked {
        None => Ok(targets.to_vec()),
        Some(name) if targets.iter().any(|target| target == name) => Ok(vec![name.to_owned()]),
        Some(name) => bail!("no fuzz target {name}; there are: {}", targets.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn targets_are_the_binaries_of_the_package() {
        let metadata = r#"{"packages": [{"targets": [
            {"name": "pack", "kind": ["bin"]}, {"name": "checks", "kind": ["lib"]}, {"name": "script", "kind": ["bin"]}
        ]}]}"#;
        assert_eq!(target_names(metadata).unwrap(), ["pack", "script"]);
        assert!(target_names("{}").is_err());
    }

    #[test]
    fn sound_scripts_start_the_corpus() {
        let root = ScratchFolder::new("seeds");
        let scripts = root.path().join("assets/scripts");
        fs::create_dir_all(&scripts).unwrap();
        fs::write(scripts.join("walk.ron"), "(entries: [])").unwrap();
        fs::write(scripts.join("README.md"), "").unwrap();
        seed(root.path(), "script").unwrap();
        let corpus = root.path().join("fuzz/corpus/script");
        assert_eq!(fs::read_to_string(corpus.join("walk.ron")).unwrap(), "(entries: [])");
        assert!(!corpus.join("README.md").exists());
    }

    #[test]
    fn the_manifest_is_cut_out_of_a_pack() {
        let header = r#"{"__metadata__":{"policy_space":"{\"version\":1}"}}"#;
        let pack = [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), &[0; 8]].concat();
        assert_eq!(manifest_of(&pack).unwrap(), br#"{"version":1}"#);
        assert!(manifest_of(&pack[..20]).is_none());
        assert!(manifest_of(&[]).is_none());
        assert!(manifest_of(&[255; 16]).is_none());
    }

    #[test]
    fn an_unknown_target_is_refused_with_the_known_ones() {
        let known = ["pack".to_owned(), "script".to_owned()];
        assert_eq!(chosen(&known, None).unwrap(), known);
        assert_eq!(chosen(&known, Some("pack")).unwrap(), ["pack"]);
        assert!(chosen(&known, Some("pak")).unwrap_err().to_string().contains("pack, script"));
    }
}
