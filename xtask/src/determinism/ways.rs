//! The ways to build and run the fixed run.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::workspace::{Workspace, answers, output_of, run as run_command};

const PACK: &str = "assets/humanoid.pack.safetensors";
const WASM: &str = "wasm32-unknown-unknown";
const ARM: &str = "aarch64-unknown-linux-gnu";
const ARM_LINKER: &str = "aarch64-linux-gnu-gcc";
const ARM_EMULATOR: &str = "qemu-aarch64";
/// Where Debian's cross packages have the libraries of arm64.
const ARM_LIBRARIES: &str = "/usr/aarch64-linux-gnu";

/// Runs the module of `determinism_wasm` and prints what the program `determinism` prints.
const NODE_SCRIPT: &str = r"import fs from 'node:fs';
const [wasm, pack, players] = process.argv.slice(2);
const start = performance.now();
const { instance } = await WebAssembly.instantiate(fs.readFileSync(wasm), {});
const { memory, pack_memory, run, hash_high, hash_low } = instance.exports;
const bytes = fs.readFileSync(pack);
const at = pack_memory(bytes.length) >>> 0;
new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
const count = run(Number(players));
if (count < 1) throw new Error(`expected hashes, found ${count}`);
const hex = (n) => (n >>> 0).toString(16).padStart(8, '0');
const hashes = Array.from({ length: count }, (_, i) => hex(hash_high(i)) + hex(hash_low(i)));
const hash = hashes.pop();
console.log(JSON.stringify({ hash, seconds: (performance.now() - start) / 1000, hashes }));
";

/// One way.
pub struct Way {
    pub name: &'static str,
    /// Numbers of threads to run it with.
    pub threads: &'static [u8],
    /// Why this machine can't; `None` when it can.
    pub lacks: fn(&Workspace) -> Option<String>,
    /// Builds it, runs it with so many players and threads, and returns what it printed.
    pub run: fn(&Workspace, u8, u8) -> Result<String>,
}

/// All ways.
pub const WAYS: [Way; 5] = [
    Way { name: "debug", threads: &[1, 2], lacks: |_| None, run: |w, p, t| native(w, p, t, false) },
    Way { name: "release", threads: &[1, 2], lacks: |_| None, run: |w, p, t| native(w, p, t, true) },
    Way { name: "release-avx2", threads: &[1], lacks: lacks_avx2, run: with_avx2 },
    Way { name: "wasm32", threads: &[1], lacks: lacks_node, run: wasm },
    Way { name: "arm64", threads: &[1], lacks: lacks_arm, run: arm },
];

/// `cargo build` of the run; `example` is the program or the module.
fn build(workspace: &Workspace, example: &str, release: bool) -> Command {
    let mut cargo = workspace.cargo();
    cargo.args(["build", "--quiet", "-p", "lockstep", "--features", "deterministic", "--example", example]);
    if release {
        cargo.arg("--release");
    }
    cargo
}

fn program(mut command: Command, players: u8, threads: u8) -> Result<String> {
    command.arg(PACK).args(["--players", &players.to_string(), "--threads", &threads.to_string()]);
    output_of(&mut command)
}

fn native(workspace: &Workspace, players: u8, threads: u8, release: bool) -> Result<String> {
    run_command(&mut build(workspace, "determinism", release))?;
    let folder = if release { "release" } else { "debug" };
    let built = workspace.target().join(folder).join("examples").join(executable());
    program(workspace.command(built), players, threads)
}

fn executable() -> String {
    format!("determinism{}", std::env::consts::EXE_SUFFIX)
}

fn lacks_avx2(_: &Workspace) -> Option<String> {
    #[cfg(target_arch = "x86_64")]
    let there = std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    let there = false;
    (!there).then(|| "this processor has no AVX2".into())
}

/// A target folder of its own, or the flags would make cargo build everything else anew.
fn with_avx2(workspace: &Workspace, players: u8, threads: u8) -> Result<String> {
    let target = workspace.target().join("determinism-avx2");
    let mut cargo = build(workspace, "determinism", true);
    cargo.env("RUSTFLAGS", "-C target-feature=+avx2,+fma").env("CARGO_TARGET_DIR", &target);
    run_command(&mut cargo)?;
    program(workspace.command(target.join("release/examples").join(executable())), players, threads)
}

fn lacks_node(_: &Workspace) -> Option<String> {
    let there = answers(Command::new("node").arg("--version"));
    (!there).then(|| "expected Node.js as `node`, found none".into())
}

fn wasm(workspace: &Workspace, players: u8, _: u8) -> Result<String> {
    add_target(WASM)?;
    run_command(build(workspace, "determinism_wasm", true).args(["--target", WASM]))?;
    let module = workspace.target().join(WASM).join("release/examples/determinism_wasm.wasm");
    let script = scratch(workspace)?.join("determinism.mjs");
    fs::write(&script, NODE_SCRIPT).with_context(|| format!("write {}", script.display()))?;
    output_of(workspace.command("node").arg(script).arg(module).arg(PACK).arg(players.to_string()))
}

fn lacks_arm(_: &Workspace) -> Option<String> {
    let missing =
        [ARM_LINKER, ARM_EMULATOR].into_iter().find(|name| !answers(Command::new(name).arg("--version")));
    missing.map(|name| {
        format!("expected {name}, found none; Debian's packages gcc-aarch64-linux-gnu, libc6-dev-arm64-cross and qemu-user have it")
    })
}

fn arm(workspace: &Workspace, players: u8, threads: u8) -> Result<String> {
    add_target(ARM)?;
    let mut cargo = build(workspace, "determinism", true);
    cargo.args(["--target", ARM]).env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", ARM_LINKER);
    run_command(&mut cargo)?;
    let built = workspace.target().join(ARM).join("release/examples/determinism");
    let mut emulator = workspace.command(ARM_EMULATOR);
    emulator.args(["-L", ARM_LIBRARIES]).arg(built);
    program(emulator, players, threads)
}

/// The standard library of another target; quick when it is there.
fn add_target(target: &str) -> Result<()> {
    run_command(Command::new("rustup").args(["--quiet", "target", "add", target]))
}

fn scratch(workspace: &Workspace) -> Result<PathBuf> {
    let folder = workspace.root().join("out");
    fs::create_dir_all(&folder).with_context(|| format!("create {}", folder.display()))?;
    Ok(folder)
}
