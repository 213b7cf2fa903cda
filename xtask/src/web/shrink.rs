//! Makes the module small with wasm-opt: that on the path, or binaryen's from npm in third_party/tools.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::workspace::{Workspace, answers, output_of, run as run_command};

/// Least version of wasm-opt. 108, Debian's, mixes the tables of the module up, and it does not start.
const LEAST: u32 = 132;
/// npm's package that has it, for any machine with Node.js.
const PACKAGE: &str = "binaryen@132.0.0";

/// What the compiler may have used.
const FEATURES: [&str; 6] = [
    "bulk-memory",
    "bulk-memory-opt",
    "mutable-globals",
    "sign-ext",
    "nontrapping-float-to-int",
    "reference-types",
];

/// Shrinks a module in place. Without wasm-opt and npm it stays as it is, and that is said.
///
/// # Errors
/// When wasm-opt fails or the file can't be replaced.
pub fn shrink(workspace: &Workspace, wasm: &Path) -> Result<()> {
    let Some(program) = wasm_opt(workspace)? else {
        eprintln!(
            "xtask: expected wasm-opt {LEAST} or later, or npm to install {PACKAGE}, found neither; the module stays larger"
        );
        return Ok(());
    };
    let small = wasm.with_extension("small");
    let mut shrink = workspace.command(&program);
    // No fast arithmetic: the bits are the point.
    shrink.args(["-O2", "--strip-debug"]).args(FEATURES.map(|name| format!("--enable-{name}")));
    shrink.arg(wasm).arg("-o").arg(&small);
    run_command(&mut shrink)?;
    fs::rename(&small, wasm).with_context(|| format!("replace {}", wasm.display()))
}

fn wasm_opt(workspace: &Workspace) -> Result<Option<PathBuf>> {
    let is_recent = |program: &Path| {
        let said = output_of(Command::new(program).arg("--version")).unwrap_or_default();
        version(&said).is_some_and(|version| version >= LEAST)
    };
    let own = workspace.third_party().join("tools/binaryen");
    let programs = [PathBuf::from("wasm-opt"), own.join("node_modules/.bin/wasm-opt")];
    if let Some(found) = programs.iter().find(|program| is_recent(program)) {
        return Ok(Some(found.clone()));
    }
    if !answers(Command::new("npm").arg("--version")) {
        return Ok(None);
    }
    eprintln!("xtask: installing {PACKAGE} in third_party/tools, once");
    let mut install = workspace.command("npm");
    install.args(["install", "--silent", "--no-audit", "--no-fund", "--no-save", "--ignore-scripts"]);
    install.arg("--prefix").arg(&own).arg(PACKAGE);
    run_command(&mut install)?;
    Ok(is_recent(&programs[1]).then(|| programs[1].clone()))
}

/// The number in what `wasm-opt --version` says.
fn version(said: &str) -> Option<u32> {
    said.split_whitespace().find_map(|word| word.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_read() {
        assert_eq!(version("wasm-opt version 108"), Some(108));
        assert_eq!(version("wasm-opt version 132 (version_132)"), Some(132));
        assert_eq!(version(""), None);
    }
}
