//! `cargo xtask onnx`: exports the shipped pack as ONNX models and compares ONNX Runtime and tract with policy-core.
//!
//! Both libraries are in the workspace `benches/peers`, which takes minutes to compile, so that this is no part of the checks.

use anyhow::Result;

use crate::setup;
use crate::workspace::{Workspace, run as run_command};

/// The pack that is exported.
const PACK: &str = "assets/humanoid.pack.safetensors";

/// Exports and compares.
///
/// # Errors
/// When ONNX Runtime can't be fetched, something does not build, or a model differs.
pub fn run(workspace: &Workspace) -> Result<()> {
    let library = setup::onnx_runtime(workspace)?;
    let folder = workspace.target().join("onnx");
    run_command(
        workspace
            .cargo()
            .args(["run", "--quiet", "-p", "trainer", "--", "export", PACK, "--onnx"])
            .arg(&folder),
    )?;
    eprintln!("xtask: building ONNX Runtime's bindings and tract; the first time this takes some minutes");
    run_command(
        workspace
            .cargo()
            .args(["test", "--manifest-path", "benches/peers/Cargo.toml", "--no-default-features"])
            .args(["--features", "onnx", "--test", "exported", "--", "--nocapture"])
            .env("CARGO_TARGET_DIR", workspace.target().join("peers"))
            .env("ORT_DYLIB_PATH", library)
            .env("POLICY_SPACE_ONNX", &folder)
            .env("POLICY_SPACE_PACK", workspace.root().join(PACK)),
    )
}
