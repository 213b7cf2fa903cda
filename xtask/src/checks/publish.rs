//! What a release needs and `cargo xtask test` leaves out, because it compiles Rapier and Bevy anew: crates that can be
//! published, the oldest direct dependencies, and the Bevy plug-in without its features.

use std::fs;

use anyhow::{Context, Result, ensure};

use super::{Step, Verdict, bevy};
use crate::workspace::{Workspace, copy_folder, output_of, run};

/// The crates that are published, each after those that it needs: name and folder.
const CRATES: [(&str, &str); 4] = [
    ("policy-core", "crates/policy-core"),
    ("policy-space-gamepad", "crates/gamepad"),
    ("physics-bridge", "crates/physics-bridge"),
    ("physics-rapier", "crates/physics-rapier"),
];

/// Those that do not need Bevy.
pub const PUBLISH: &[Step] = &[DRY_RUN, OLDEST, BEVY_DRY_RUN];

/// All of them.
pub const PUBLISH_ALL: &[Step] = &[DRY_RUN, OLDEST, BEVY_DRY_RUN, BEVY_PLAIN];

const DRY_RUN: Step = Step { name: "cargo publish --dry-run", run: dry_run };
const OLDEST: Step = Step { name: "oldest direct dependencies", run: oldest };
const BEVY_DRY_RUN: Step = Step { name: "engines/bevy: publish --dry-run", run: bevy_dry_run };
const BEVY_PLAIN: Step = Step { name: "engines/bevy: no features", run: bevy_plain };

/// Packs every crate and builds it from its package.
fn dry_run(workspace: &Workspace) -> Result<Verdict> {
    let mut publish = workspace.cargo();
    publish.args(["publish", "--dry-run", "--allow-dirty"]);
    run(publish.args(CRATES.iter().flat_map(|(name, _)| ["-p", *name])))?;
    Ok(Verdict::Passed)
}

/// Compiles the packages with the oldest versions of what they depend on that their manifests allow.
fn oldest(workspace: &Workspace) -> Result<Verdict> {
    let folder = workspace.target().join("oldest");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("remove {}", folder.display()))?;
    }
    let version = version_of(workspace)?;
    for (name, _) in CRATES {
        let package = format!("{name}-{version}");
        let from = workspace.target().join("package").join(&package);
        ensure!(
            from.join("Cargo.toml").is_file(),
            "expected the package of {name} in {}, found none: the dry run makes it",
            from.display()
        );
        copy_folder(&from, &folder.join(&package))?;
    }
    let manifest = folder.join("Cargo.toml");
    fs::write(&manifest, manifest_of_packages(&version)).with_context(|| manifest.display().to_string())?;
    // The option is unstable. The variable lets the cargo that is there take it.
    let mut resolve = workspace.cargo();
    resolve.env("RUSTC_BOOTSTRAP", "1").args(["-Zdirect-minimal-versions", "generate-lockfile"]);
    run(resolve.arg("--manifest-path").arg(&manifest))?;
    let mut check = workspace.cargo();
    check.args(["check", "--locked", "--workspace", "--lib", "--bins", "--target-dir"]);
    run(check.arg(workspace.target()).arg("--manifest-path").arg(&manifest))?;
    Ok(Verdict::Passed)
}

/// Packs the plug-in. What it needs of this workspace is not on the registry before it is published, so the folders of
/// those crates stand in for it; the package is built by [`bevy_plain`] and not here.
fn bevy_dry_run(workspace: &Workspace) -> Result<Verdict> {
    let channel = bevy::provided(workspace)?;
    let mut publish = bevy::cargo(workspace, &channel);
    publish.args(["publish", "--dry-run", "--allow-dirty", "--no-verify"]);
    // A patch that nothing needs would be written into its lock file.
    for (name, folder) in CRATES.into_iter().filter(|(name, _)| *name != "policy-space-gamepad") {
        let folder = workspace.root().join(folder).display().to_string().replace('\\', "/");
        publish.args(["--config", &format!("patch.crates-io.{name}.path=\"{folder}\"")]);
    }
    run(&mut publish)?;
    Ok(Verdict::Passed)
}

/// Builds and tests the plug-in as a game gets it by default: without MuJoCo, without anything else. The other checks
/// turn MuJoCo on.
fn bevy_plain(workspace: &Workspace) -> Result<Verdict> {
    let channel = bevy::provided(workspace)?;
    run(bevy::cargo(workspace, &channel).args(["test", "--locked", "--lib", "--tests"]))?;
    Ok(Verdict::Passed)
}

/// The version of the workspace, as cargo names packages.
fn version_of(workspace: &Workspace) -> Result<String> {
    let mut metadata = workspace.cargo();
    metadata.args(["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: serde_json::Value =
        serde_json::from_str(&output_of(&mut metadata)?).context("read what cargo metadata wrote")?;
    let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
    let first = packages.iter().find(|package| package["name"] == CRATES[0].0);
    let version = first.and_then(|package| package["version"].as_str());
    Ok(version.with_context(|| format!("expected the version of {}, found none", CRATES[0].0))?.to_owned())
}

/// A workspace of packages that take each other for published.
fn manifest_of_packages(version: &str) -> String {
    let members: Vec<String> = CRATES.iter().map(|(name, _)| format!("\"{name}-{version}\"")).collect();
    let patches = CRATES.iter().map(|(name, _)| format!("{name} = {{ path = \"{name}-{version}\" }}\n"));
    format!(
        "[workspace]\nresolver = \"3\"\nmembers = [{}]\n\n[patch.crates-io]\n{}",
        members.join(", "),
        patches.collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crate_that_may_be_published_is_checked() {
        let workspace = Workspace::find().unwrap();
        let mut found = Vec::new();
        for entry in fs::read_dir(workspace.root().join("crates")).unwrap() {
            let manifest = fs::read_to_string(entry.unwrap().path().join("Cargo.toml")).unwrap();
            let name = manifest.lines().find_map(|line| line.strip_prefix("name = \"")).unwrap();
            if !manifest.contains("\npublish") {
                found.push(name.split('"').next().unwrap().to_owned());
            }
        }
        found.sort();
        let mut listed = CRATES.map(|(name, _)| name.to_owned());
        listed.sort();
        assert_eq!(found, listed);
    }

    #[test]
    fn packages_make_a_workspace() {
        let text = manifest_of_packages("1.2.3");
        assert!(text.contains("members = [\"policy-core-1.2.3\", \"policy-space-gamepad-1.2.3\","), "{text}");
        assert!(text.ends_with("physics-rapier = { path = \"physics-rapier-1.2.3\" }\n"), "{text}");
    }
}
