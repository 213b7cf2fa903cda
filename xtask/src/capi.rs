//! `cargo xtask capi`: the C interface, built and installed as a C library is: header, libraries, pkg-config file.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;

use crate::workspace::{Workspace, run as run_command};

/// Name of the library, of its pkg-config file and of its header.
const NAME: &str = "policy_space";

/// System libraries that the static library needs, in the words of a linker.
const PRIVATE_LIBRARIES: &str = "-lgcc_s -lutil -lrt -lpthread -lm -ldl -lc";

/// Arguments of `cargo xtask capi`.
#[derive(Debug, Args)]
pub struct CapiArgs {
    /// Folder to install to: PREFIX/include, PREFIX/lib, PREFIX/lib/pkgconfig.
    #[arg(long, required_unless_present = "check")]
    prefix: Option<PathBuf>,
    /// Build quicker, for code that runs slower.
    #[arg(long)]
    debug: bool,
    /// Instead of installing, build and run the example program with gcc and clang, as `cargo xtask test` does.
    #[arg(long, conflicts_with_all = ["prefix", "debug"])]
    pub check: bool,
}

/// Builds and installs.
///
/// # Errors
/// When the library can't be built or a file can't be written.
pub fn run(workspace: &Workspace, arguments: &CapiArgs) -> Result<()> {
    let Some(prefix) = &arguments.prefix else { return Ok(()) };
    install(workspace, prefix, arguments.debug)?;
    eprintln!("xtask: installed in {}; PKG_CONFIG_PATH is its lib/pkgconfig", prefix.display());
    Ok(())
}

/// Builds the library and installs it below `prefix`.
///
/// # Errors
/// When the library can't be built or a file can't be written.
pub fn install(workspace: &Workspace, prefix: &Path, debug: bool) -> Result<()> {
    let mut build = workspace.cargo();
    build.args(["build", "--quiet", "-p", "policy-capi", "--lib"]);
    if !debug {
        build.arg("--release");
    }
    run_command(&mut build)?;
    let built = workspace.target().join(if debug { "debug" } else { "release" });
    let header = format!("{NAME}.h");
    let headers = workspace.root().join("crates/policy-capi/include");
    copy(&headers.join(&header), &prefix.join("include").join(&header))?;
    for library in libraries() {
        copy(&built.join(&library), &prefix.join("lib").join(&library))?;
    }
    let description = prefix.join(format!("lib/pkgconfig/{NAME}.pc"));
    write(&description, &pkg_config(env!("CARGO_PKG_VERSION")))
}

/// Files of the shared and the static library.
fn libraries() -> Vec<String> {
    if cfg!(windows) {
        return vec![format!("{NAME}.dll"), format!("{NAME}.dll.lib"), format!("{NAME}.lib")];
    }
    let shared = if cfg!(target_os = "macos") { "dylib" } else { "so" };
    vec![format!("lib{NAME}.{shared}"), format!("lib{NAME}.a")]
}

/// The file for pkg-config. Its folders are relative to itself, so that the prefix may be moved.
fn pkg_config(version: &str) -> String {
    format!(
        "prefix=${{pcfiledir}}/../..\n\
         libdir=${{prefix}}/lib\n\
         includedir=${{prefix}}/include\n\
         \n\
         Name: {NAME}\n\
         Description: Physics-based characters steered by blending the parameters of tiny policies\n\
         Version: {version}\n\
         Libs: -L${{libdir}} -l{NAME}\n\
         Libs.private: {PRIVATE_LIBRARIES}\n\
         Cflags: -I${{includedir}}\n"
    )
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    create_parent(to)?;
    fs::copy(from, to).with_context(|| format!("copy {} to {}", from.display(), to.display()))?;
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<()> {
    create_parent(path)?;
    fs::write(path, text).with_context(|| format!("write {}", path.display()))
}

fn create_parent(path: &Path) -> Result<()> {
    let parent = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(parent).with_context(|| format!("create {}", parent.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pkg_config_file_has_all_fields() {
        let text = pkg_config("1.2.3");
        assert!(text.contains("\nVersion: 1.2.3\n") && text.contains("\nLibs: -L${libdir} -lpolicy_space\n"));
        assert!(text.starts_with("prefix=${pcfiledir}/../..\n"), "{text}");
        let fields = text.lines().filter(|line| line.contains(": ")).count();
        assert_eq!(fields, 6);
    }
}
