//! Compiles the module, binds it to JavaScript, and lays the page out with names that change with their contents.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

use super::shrink::shrink;
use crate::workspace::{Workspace, output_of, run as run_command};

const TARGET: &str = "wasm32-unknown-unknown";
const MODULE: &str = "policy_space_web";
const BINDER: &str = "wasm-bindgen";

/// Scripts of the page, in their order.
const SCRIPTS: [&str; 5] = ["start.js", "clock.js", "shown.js", "devices.js", "controls.js"];

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
    // Names of functions are a tenth of the module.
    bind.args(["--remove-name-section", "--remove-producers-section"]);
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
    install.args(["install", "--locked", "wasm-bindgen-cli", "--version", version, "--root"]).arg(&tools);
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
        let zipped = folder.join(format!("{name}.gz"));
        compress(&bytes, &zipped).with_context(|| format!("write {}", zipped.display()))?;
        Ok(json!({"path": format!("./{name}"), "bytes": bytes.len()}))
    };
    files.insert("code".into(), put(&bound.join(format!("{MODULE}.js")), "policy-space", "js")?);
    files.insert("wasm".into(), put(&bound.join(format!("{MODULE}_bg.wasm")), "policy-space", "wasm")?);
    files.insert("pack".into(), put(&root.join("assets/humanoid.pack.safetensors"), "humanoid", "pack")?);
    files.insert("mesh".into(), put(&root.join("assets/humanoid.glb"), "humanoid", "glb")?);
    let page = root.join("web/page");
    let joined = bound.join("page.js");
    fs::write(&joined, script(&page)?).with_context(|| format!("write {}", joined.display()))?;
    let script = put(&joined, "page", "js")?;
    let style = put(&page.join("style.css"), "style", "css")?;
    let path = |file: &Value| file["path"].as_str().unwrap_or_default().to_owned();
    let template = page.join("index.html");
    let html = fs::read_to_string(&template).with_context(|| format!("read {}", template.display()))?;
    let paths = [
        ("STYLE", path(&style)),
        ("PAGE", path(&script)),
        ("CODE", path(&files["code"])),
        ("WASM", path(&files["wasm"])),
        ("PACK", path(&files["pack"])),
        ("MESH", path(&files["mesh"])),
    ];
    let html = paths
        .iter()
        .fold(html, |html, (word, path)| html.replace(&format!("\"{word}\""), &format!("\"{path}\"")));
    let html = html.replace(">FILES<", &format!(">{}<", Value::Object(files)));
    fs::write(folder.join("index.html"), html).context("write index.html")
}

/// The scripts of the page as one.
fn script(page: &Path) -> Result<String> {
    SCRIPTS.iter().try_fold(String::new(), |text, name| {
        let path = page.join(name);
        Ok(text + &fs::read_to_string(&path).with_context(|| format!("read {}", path.display()))?)
    })
}

/// For servers that send compressed files as they lie there: compressing five megabytes for each visit takes a second.
fn compress(bytes: &[u8], path: &Path) -> std::io::Result<()> {
    let mut encoder = GzEncoder::new(fs::File::create(path)?, Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish().map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_of_the_binding_generator_is_read() {
        let lock = "[[package]]\nname = \"wasm-bindgen\"\nversion = \"0.2.130\"\n\n[[package]]\nname = \"x\"\nversion = \"1\"\n";
        assert_eq!(locked_version(lock, "wasm-bindgen"), Some("0.2.130"));
        assert_eq!(locked_version(lock, "y"), None);
    }
}
