//! Compiles the module, binds it to JavaScript, and lays the page out with names that change with their contents.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

use crate::workspace::{Workspace, output_of, run as run_command};

const TARGET: &str = "wasm32-unknown-unknown";
const MODULE: &str = "policy_space_web";
const BINDER: &str = "wasm-bindgen";

/// Least version of wasm-opt. 108, Debian's, mixes the tables of the module up, and it does not start.
const LEAST_WASM_OPT: u32 = 132;

/// The folder of the page, below the root.
const FOLDER: &str = "out/web";

/// Builds everything and returns the folder of the page.
///
/// # Errors
/// When a tool is missing or fails, or a file can't be read or written.
pub fn page(workspace: &Workspace, small: bool) -> Result<PathBuf> {
    let module = compile(workspace)?;
    let binder = binder(workspace)?;
    let bound = workspace.target().join("web-bound");
    let mut bind = workspace.command(&binder);
    bind.args(["--target", "web", "--no-typescript", "--out-name", MODULE, "--out-dir"])
        .arg(&bound)
        .arg(&module);
    run_command(&mut bind)?;
    let wasm = bound.join(format!("{MODULE}_bg.wasm"));
    if small {
        shrink(workspace, &wasm)?;
    }
    let folder = workspace.root().join(FOLDER);
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("empty {}", folder.display()))?;
    }
    fs::create_dir_all(&folder).with_context(|| format!("create {}", folder.display()))?;
    lay_out(workspace, &bound, &folder)?;
    Ok(folder)
}

/// The module, as cargo leaves it.
fn compile(workspace: &Workspace) -> Result<PathBuf> {
    run_command(Command::new("rustup").args(["--quiet", "target", "add", TARGET]))?;
    let mut cargo = workspace.cargo();
    cargo.args(["build", "--locked", "--release", "--target", TARGET, "--manifest-path", "web/Cargo.toml"]);
    // What the other workspace built for wasm32 is of use here.
    cargo.arg("--target-dir").arg(workspace.target());
    run_command(&mut cargo)?;
    Ok(workspace.target().join(TARGET).join("release").join(format!("{MODULE}.wasm")))
}

/// The binding generator, of exactly the version of the crate, in third_party/tools.
fn binder(workspace: &Workspace) -> Result<PathBuf> {
    let lock = workspace.root().join("web/Cargo.lock");
    let text = fs::read_to_string(&lock).with_context(|| format!("read {}", lock.display()))?;
    let version = locked_version(&text, BINDER)
        .with_context(|| format!("expected the package {BINDER} in {}, found none", lock.display()))?;
    let tools = workspace.third_party().join("tools");
    let program = tools.join("bin").join(format!("{BINDER}{}", std::env::consts::EXE_SUFFIX));
    let found = || output_of(Command::new(&program).arg("--version")).unwrap_or_default();
    if program.is_file() && found().split_whitespace().nth(1) == Some(version) {
        return Ok(program);
    }
    eprintln!("xtask: installing {BINDER} {version} in third_party/tools; this takes some minutes, once");
    let mut install = workspace.cargo();
    install.args(["install", "wasm-bindgen-cli", "--version", version, "--root"]).arg(&tools);
    install.arg("--target-dir").arg(workspace.target().join("tools"));
    run_command(&mut install)?;
    ensure!(
        found().split_whitespace().nth(1) == Some(version),
        "{BINDER} {version} was installed and can't run"
    );
    Ok(program)
}

/// The version of a package in a lock file.
fn locked_version<'a>(lock: &'a str, package: &str) -> Option<&'a str> {
    let mut lines = lock.lines().skip_while(|line| *line != format!("name = \"{package}\""));
    lines.next()?;
    lines.next()?.strip_prefix("version = \"")?.strip_suffix('"')
}

/// The number in what `wasm-opt --version` says.
fn wasm_opt_version(said: &str) -> Option<u32> {
    said.split_whitespace().find_map(|word| word.parse().ok())
}

fn shrink(workspace: &Workspace, wasm: &Path) -> Result<()> {
    let said = output_of(Command::new("wasm-opt").arg("--version")).unwrap_or_default();
    let version = wasm_opt_version(&said);
    if version.is_none_or(|version| version < LEAST_WASM_OPT) {
        let found = version.map_or("none".to_owned(), |version| version.to_string());
        eprintln!(
            "xtask: expected wasm-opt {LEAST_WASM_OPT} or later (npm's package binaryen), found {found}; the module stays larger"
        );
        return Ok(());
    }
    let small = wasm.with_extension("small");
    let features =
        ["bulk-memory", "mutable-globals", "sign-ext", "nontrapping-float-to-int", "reference-types"];
    let mut shrink = workspace.command("wasm-opt");
    // No fast arithmetic: the bits are the point.
    shrink.args(["-O2", "--strip-debug"]).args(features.map(|name| format!("--enable-{name}")));
    shrink.arg(wasm).arg("-o").arg(&small);
    run_command(&mut shrink)?;
    fs::rename(&small, wasm).with_context(|| format!("replace {}", wasm.display()))
}

/// Writes the page: every file but `index.html` has a hash of its contents in its name.
fn lay_out(workspace: &Workspace, bound: &Path, folder: &Path) -> Result<()> {
    let root = workspace.root();
    let mut files = Map::new();
    let put = |from: &Path, stem: &str, ending: &str| -> Result<Value> {
        let bytes = fs::read(from).with_context(|| format!("read {}", from.display()))?;
        let digest: String =
            Sha256::digest(&bytes).iter().take(8).map(|byte| format!("{byte:02x}")).collect();
        let name = format!("{stem}.{digest}.{ending}");
        fs::write(folder.join(&name), &bytes).with_context(|| format!("write {name}"))?;
        Ok(json!({"path": format!("./{name}"), "bytes": bytes.len()}))
    };
    files.insert("code".into(), put(&bound.join(format!("{MODULE}.js")), "policy-space", "js")?);
    files.insert("wasm".into(), put(&bound.join(format!("{MODULE}_bg.wasm")), "policy-space", "wasm")?);
    files.insert("pack".into(), put(&root.join("assets/humanoid.pack.safetensors"), "humanoid", "pack")?);
    files.insert("mesh".into(), put(&root.join("assets/humanoid.glb"), "humanoid", "glb")?);
    let page = root.join("web/page");
    let script = put(&page.join("page.js"), "page", "js")?;
    let style = put(&page.join("style.css"), "style", "css")?;
    let path = |file: &Value| file["path"].as_str().unwrap_or_default().to_owned();
    let template = page.join("index.html");
    let html = fs::read_to_string(&template).with_context(|| format!("read {}", template.display()))?;
    let html = html
        .replace("\"STYLE\"", &format!("\"{}\"", path(&style)))
        .replace("\"PAGE\"", &format!("\"{}\"", path(&script)))
        .replace(">FILES<", &format!(">{}<", Value::Object(files)));
    fs::write(folder.join("index.html"), html).context("write index.html")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_of_wasm_opt_is_read() {
        assert_eq!(wasm_opt_version("wasm-opt version 108"), Some(108));
        assert_eq!(wasm_opt_version("wasm-opt version 132 (version_132)"), Some(132));
        assert_eq!(wasm_opt_version(""), None);
    }

    #[test]
    fn the_version_of_the_binding_generator_is_read() {
        let lock = "[[package]]\nname = \"wasm-bindgen\"\nversion = \"0.2.130\"\n\n[[package]]\nname = \"x\"\nversion = \"1\"\n";
        assert_eq!(locked_version(lock, "wasm-bindgen"), Some("0.2.130"));
        assert_eq!(locked_version(lock, "y"), None);
    }
}
