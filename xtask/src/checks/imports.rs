//! Which crate may import which, checked against `cargo metadata`.
//!
//! The rules are those of `ARCHITECTURE.md`. They are data: a new crate needs a line in [`RULES`], and a
//! dependency that only one crate may have needs one in [`OWNED`]. `deny.toml` repeats the second half for
//! cargo-deny. This check needs nothing installed and sees development dependencies too.

use std::collections::{HashMap, HashSet};

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::workspace::{Workspace, output_of};

/// A crate of the workspace and the crates of the workspace that it may import.
struct Rule {
    name: &'static str,
    may_import: &'static [&'static str],
    /// Further ones for its tests, examples and benchmarks.
    may_test_with: &'static [&'static str],
}

const fn rule(
    name: &'static str,
    may_import: &'static [&'static str],
    may_test_with: &'static [&'static str],
) -> Rule {
    Rule { name, may_import, may_test_with }
}

const RULES: &[Rule] = &[
    rule("policy-core", &[], &[]),
    rule("policy-space-gamepad", &["policy-core"], &[]),
    rule("physics-bridge", &["policy-core"], &[]),
    rule("physics-rapier", &["policy-core"], &[]),
    rule("policy-capi", &["policy-core"], &[]),
    rule("files", &[], &[]),
    rule("pca", &[], &[]),
    rule("replay", &["policy-core"], &[]),
    rule("playground", &["policy-core", "random"], &[]),
    rule("lockstep", &["policy-core", "physics-rapier", "playground", "replay"], &[]),
    rule("rollback", &["lockstep"], &[]),
    rule("physics", &["policy-core", "physics-bridge", "physics-rapier"], &[]),
    rule("random", &["policy-core"], &["physics-bridge"]),
    rule("clips", &["policy-core", "physics-bridge", "files"], &[]),
    rule(
        "evaluation",
        &["policy-core", "physics", "physics-bridge", "clips", "random", "pca", "playground"],
        &[],
    ),
    rule(
        "trainer",
        &["policy-core", "physics", "physics-bridge", "clips", "random", "files", "evaluation"],
        &[],
    ),
    rule(
        "viewer",
        &[
            "policy-core",
            "physics",
            "physics-bridge",
            "policy-space-gamepad",
            "files",
            "pca",
            "playground",
            "random",
            "replay",
        ],
        &[],
    ),
    rule(
        "integration-tests",
        &[
            "policy-core",
            "policy-space-gamepad",
            "physics-bridge",
            "physics-rapier",
            "clips",
            "trainer",
            "viewer",
        ],
        &[],
    ),
    rule("xtask", &[], &[]),
];

/// A dependency from outside that belongs to some crates alone. A name that ends in `*` stands for a family.
struct Owned {
    dependency: &'static str,
    owners: &'static [&'static str],
    why: &'static str,
}

const fn owned(dependency: &'static str, owners: &'static [&'static str], why: &'static str) -> Owned {
    Owned { dependency, owners, why }
}

const DRAWS: &str = "only viewer draws";

const OWNED: &[Owned] = &[
    owned(
        "mujoco-rs",
        &["physics-bridge", "integration-tests"],
        "only physics-bridge speaks to the physics engine",
    ),
    owned("rapier3d*", &["physics-rapier"], "only physics-rapier speaks to Rapier"),
    owned("hidapi", &["policy-space-gamepad"], "only gamepad speaks to devices"),
    owned("gilrs*", &["policy-space-gamepad"], "only gamepad speaks to devices"),
    owned("cpal", &["viewer"], "only viewer plays sounds"),
    owned("wgpu*", &["viewer"], DRAWS),
    owned("winit", &["viewer"], DRAWS),
    owned("egui*", &["viewer"], DRAWS),
    owned("gltf", &["viewer"], DRAWS),
    owned("gemm", &["trainer"], "only trainer learns"),
    owned("ggrs", &["rollback"], "only the example speaks to a network"),
    owned("bevy*", &[], "only engines/bevy knows Bevy, in a workspace of its own"),
];

/// Crates of the workspace below which, at any depth, none of these may lie.
const NEVER_BELOW: &[(&str, &[&str])] = &[
    ("xtask", &["mujoco-rs"]),
    ("playground", &["mujoco-rs", "rapier3d", "wgpu", "winit"]),
    ("lockstep", &["mujoco-rs", "wgpu", "winit", "hidapi", "gilrs", "ggrs"]),
    ("policy-core", &["mujoco-rs", "hidapi", "gilrs", "wgpu", "winit", "egui", "gltf", "bevy"]),
    ("evaluation", &["wgpu", "winit", "egui", "gemm"]),
    ("trainer", &["wgpu", "winit", "egui"]),
];

/// Checks the workspace.
///
/// # Errors
/// When cargo cannot describe the workspace or a rule is broken; the message names every breach.
pub fn check(workspace: &Workspace) -> Result<()> {
    let text = output_of(workspace.cargo().args(["metadata", "--format-version", "1"]))?;
    let metadata: Value = serde_json::from_str(&text).context("read what cargo metadata says")?;
    let breaches = breaches(&metadata)?;
    if breaches.is_empty() {
        return Ok(());
    }
    bail!("{} forbidden imports:\n    {}", breaches.len(), breaches.join("\n    "))
}

/// Every broken rule, in words.
fn breaches(metadata: &Value) -> Result<Vec<String>> {
    let members: HashSet<&str> =
        array(metadata, "workspace_members")?.iter().filter_map(Value::as_str).collect();
    let packages = array(metadata, "packages")?;
    let is_member = |package: &&Value| members.contains(package["id"].as_str().unwrap_or_default());
    let member_names: HashSet<&str> =
        packages.iter().filter(is_member).filter_map(|package| package["name"].as_str()).collect();
    let mut found = Vec::new();
    for package in packages.iter().filter(is_member) {
        let name = text(package, "name")?;
        let Some(rule) = RULES.iter().find(|rule| rule.name == name) else {
            found.push(format!("{name} has no rule; add one to xtask/src/checks/imports.rs"));
            continue;
        };
        for dependency in array(package, "dependencies")? {
            let imported = text(dependency, "name")?;
            let for_tests = dependency["kind"] == "dev";
            let breach = if member_names.contains(imported) && !dependency["path"].is_null() {
                internal_breach(rule, imported, for_tests)
            } else {
                external_breach(name, imported)
            };
            found.extend(breach);
        }
    }
    found.extend(buried(metadata, packages)?);
    found.sort();
    found.dedup();
    Ok(found)
}

fn internal_breach(rule: &Rule, imported: &str, for_tests: bool) -> Option<String> {
    let allowed =
        rule.may_import.contains(&imported) || (for_tests && rule.may_test_with.contains(&imported));
    (!allowed && rule.name != imported).then(|| format!("{} imports {imported}", rule.name))
}

fn external_breach(name: &str, imported: &str) -> Option<String> {
    let owned = OWNED.iter().find(|owned| matches(owned.dependency, imported))?;
    (!owned.owners.contains(&name)).then(|| format!("{name} imports {imported}: {}", owned.why))
}

fn matches(pattern: &str, name: &str) -> bool {
    match pattern.strip_suffix('*') {
        Some(family) => name.starts_with(family),
        None => name == pattern,
    }
}

/// What lies at any depth below a crate although it must not. Development dependencies do not count.
fn buried(metadata: &Value, packages: &[Value]) -> Result<Vec<String>> {
    let names: HashMap<&str, &str> = packages
        .iter()
        .filter_map(|package| Some((package["id"].as_str()?, package["name"].as_str()?)))
        .collect();
    let mut below: HashMap<&str, Vec<&str>> = HashMap::new();
    for node in array(&metadata["resolve"], "nodes")? {
        let children = array(node, "deps")?.iter().filter(|dep| is_used_at_run_time(dep));
        below.insert(text(node, "id")?, children.filter_map(|dep| dep["pkg"].as_str()).collect());
    }
    let mut found = Vec::new();
    for (name, forbidden) in NEVER_BELOW {
        let Some(start) = names.iter().find(|(_, candidate)| *candidate == name).map(|(id, _)| *id) else {
            continue;
        };
        let mut reached = HashSet::from([start]);
        let mut open = vec![start];
        while let Some(id) = open.pop() {
            open.extend(below.get(id).into_iter().flatten().filter(|child| reached.insert(child)));
        }
        let reached: HashSet<&str> = reached.iter().filter_map(|id| names.get(id).copied()).collect();
        let breaches = forbidden.iter().filter(|dependency| reached.contains(**dependency));
        found.extend(breaches.map(|dependency| format!("{name} has {dependency} somewhere below it")));
    }
    Ok(found)
}

/// Whether a resolved dependency is more than one for tests, examples and benchmarks.
fn is_used_at_run_time(dependency: &Value) -> bool {
    match dependency["dep_kinds"].as_array() {
        Some(kinds) => kinds.iter().any(|kind| kind["kind"] != "dev"),
        None => true,
    }
}

fn array<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>> {
    value[key].as_array().with_context(|| format!("cargo metadata: expected a list `{key}`, found none"))
}

fn text<'a>(value: &'a Value, key: &str) -> Result<&'a str> {
    value[key].as_str().with_context(|| format!("cargo metadata: expected a text `{key}`, found none"))
}

#[cfg(test)]
#[path = "imports_tests.rs"]
mod tests;
