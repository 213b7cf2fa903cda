//! Tests of the import rules, on made-up metadata.

use serde_json::{Value, json};

use super::*;

/// Metadata of a workspace: members with their dependencies as `(name, kind)`, and foreign packages below them.
fn metadata(members: &[(&str, &[(&str, &str)])], foreign: &[(&str, &[&str])]) -> Value {
    let member_names: Vec<&str> = members.iter().map(|(name, _)| *name).collect();
    let kind = |kind: &str| if kind == "normal" { Value::Null } else { json!(kind) };
    let mut packages = Vec::new();
    let mut nodes = Vec::new();
    for (name, dependencies) in members {
        let declared = dependencies.iter().map(|(dependency, of)| {
            let path = member_names.contains(dependency).then(|| format!("/made/up/{dependency}"));
            json!({ "name": dependency, "kind": kind(of), "path": path })
        });
        packages.push(json!({ "id": name, "name": name, "dependencies": declared.collect::<Vec<_>>() }));
        let resolved = dependencies
            .iter()
            .map(|(dependency, of)| json!({ "pkg": dependency, "dep_kinds": [{ "kind": kind(of) }] }));
        nodes.push(json!({ "id": name, "deps": resolved.collect::<Vec<_>>() }));
    }
    for (name, dependencies) in foreign {
        packages.push(json!({ "id": name, "name": name, "dependencies": [] }));
        let resolved = dependencies.iter().map(|pkg| json!({ "pkg": pkg, "dep_kinds": [{ "kind": null }] }));
        nodes.push(json!({ "id": name, "deps": resolved.collect::<Vec<_>>() }));
    }
    json!({ "workspace_members": member_names, "packages": packages, "resolve": { "nodes": nodes } })
}

#[test]
fn the_architecture_as_drawn_has_no_breach() {
    let metadata = metadata(
        &[
            ("policy-core", &[("glam", "normal"), ("criterion", "dev")]),
            ("policy-space-gamepad", &[("policy-core", "normal"), ("hidapi", "normal")]),
            ("physics-bridge", &[("policy-core", "normal"), ("mujoco-rs", "normal")]),
            ("pca", &[]),
            ("evaluation", &[("policy-core", "normal"), ("physics-bridge", "normal"), ("pca", "normal")]),
            ("trainer", &[("evaluation", "normal"), ("gemm", "normal")]),
            ("viewer", &[("policy-core", "normal"), ("physics-bridge", "normal"), ("egui-wgpu", "normal")]),
            ("xtask", &[("clap", "normal")]),
        ],
        &[("mujoco-rs", &[]), ("clap", &[])],
    );
    assert_eq!(breaches(&metadata).unwrap(), [""; 0]);
}

#[test]
fn a_crate_of_the_workspace_is_imported_only_where_allowed() {
    let metadata = metadata(
        &[
            ("policy-core", &[("policy-space-gamepad", "normal")]),
            ("policy-space-gamepad", &[]),
            ("trainer", &[("viewer", "dev"), ("evaluation", "normal")]),
            ("evaluation", &[("trainer", "dev")]),
            ("viewer", &[("trainer", "normal")]),
            ("physics-rapier", &[("physics-bridge", "normal")]),
            ("physics-bridge", &[]),
        ],
        &[],
    );
    assert_eq!(
        breaches(&metadata).unwrap(),
        [
            "evaluation imports trainer",
            "physics-rapier imports physics-bridge",
            "policy-core imports policy-space-gamepad",
            "trainer imports viewer",
            "viewer imports trainer",
        ]
    );
}

#[test]
fn a_dependency_with_an_owner_is_refused_elsewhere_even_for_tests() {
    let metadata = metadata(
        &[
            ("trainer", &[("mujoco-rs", "dev"), ("egui_plot", "normal")]),
            ("policy-space-gamepad", &[("wgpu-core", "build")]),
        ],
        &[],
    );
    let found = breaches(&metadata).unwrap();
    assert_eq!(found.len(), 3, "{found:?}");
    assert_eq!(found[0], "policy-space-gamepad imports wgpu-core: only viewer draws");
    assert_eq!(found[2], "trainer imports mujoco-rs: only physics-bridge speaks to the physics engine");
}

#[test]
fn what_lies_deeper_is_found_too() {
    let below: &[(&str, &[&str])] =
        &[("helper", &["deeper"]), ("deeper", &["mujoco-rs"]), ("mujoco-rs", &[])];
    let found = breaches(&metadata(&[("xtask", &[("helper", "normal")])], below)).unwrap();
    assert_eq!(found, ["xtask has mujoco-rs somewhere below it"]);
    let for_tests = metadata(&[("policy-core", &[("helper", "dev")])], below);
    assert_eq!(breaches(&for_tests).unwrap(), [""; 0], "development dependencies do not count here");
}

#[test]
fn a_crate_without_a_rule_is_a_breach() {
    let found = breaches(&metadata(&[("newcomer", &[])], &[])).unwrap();
    assert_eq!(found, ["newcomer has no rule; add one to xtask/src/checks/imports.rs"]);
}

#[test]
fn metadata_without_packages_is_an_error() {
    let message = breaches(&json!({ "workspace_members": [] })).unwrap_err().to_string();
    assert!(message.contains("`packages`"), "{message}");
}
