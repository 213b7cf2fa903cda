//! The C interface as a C programmer meets it: installed, found by pkg-config, and a program that walks 10 m in MuJoCo.
//!
//! gcc links the static library and watches memory with AddressSanitizer; clang links the shared one. clang reads the
//! header as C++ too.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use super::Verdict;
use crate::capi;
use crate::setup::mujoco_folders;
use crate::workspace::{Workspace, answers, output_of, run};

/// Warnings that fail the build, and the oldest C that the program is written in.
const STRICT: [&str; 5] = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// Memory errors, leaks and undefined behaviour end the program.
const SANITIZED: [&str; 4] =
    ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"];

/// Installs the library below the target folder, builds the program with both compilers and runs it.
///
/// # Errors
/// When a tool is missing, something does not build, or the program fails.
pub fn check(workspace: &Workspace) -> Result<Verdict> {
    if !cfg!(target_os = "linux") {
        return Ok(Verdict::Skipped("written for Linux".into()));
    }
    for tool in ["gcc", "clang", "pkg-config"] {
        let there = answers(Command::new(tool).arg("--version"));
        ensure!(there, "expected {tool} on this machine, found none: apt-get install {tool}");
    }
    let prefix = workspace.target().join("capi");
    capi::install(workspace, &prefix, true)?;
    let header = prefix.join("include/policy_space.h");
    let as_cpp = ["-x", "c++", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"];
    run(workspace.command("clang").args(as_cpp).arg(&header)).context("read the header as C++")?;

    let program = Program { workspace, prefix: &prefix };
    let mut with_gcc = program.compiler("gcc");
    with_gcc.args(SANITIZED).args(program.flags(&["--cflags"])?).arg(prefix.join("lib/libpolicy_space.a"));
    program.build_and_run(with_gcc, "walk-gcc").context("static library, gcc, AddressSanitizer")?;

    let mut with_clang = program.compiler("clang");
    with_clang.arg("-O2").args(program.flags(&["--cflags", "--libs"])?);
    with_clang.arg(rpath(&prefix.join("lib")));
    program.build_and_run(with_clang, "walk-clang").context("shared library, clang")?;
    Ok(Verdict::Passed)
}

/// The example program.
struct Program<'a> {
    workspace: &'a Workspace,
    prefix: &'a Path,
}

impl Program<'_> {
    fn compiler(&self, name: &str) -> Command {
        let mut command = self.workspace.command(name);
        command.args(STRICT).arg("crates/policy-capi/examples/walk.c");
        command
    }

    /// What pkg-config says about the installed library.
    fn flags(&self, arguments: &[&str]) -> Result<Vec<String>> {
        let mut command = self.workspace.command("pkg-config");
        command.env("PKG_CONFIG_PATH", self.prefix.join("lib/pkgconfig"));
        let flags = output_of(command.args(arguments).arg("policy_space"))?;
        Ok(flags.split_whitespace().map(str::to_owned).collect())
    }

    /// Adds MuJoCo to a command that compiles, runs it, and runs the program with the shipped pack.
    fn build_and_run(&self, mut compiler: Command, name: &str) -> Result<()> {
        let (library, headers) = mujoco_folders(self.workspace);
        // MuJoCo's headers are not ours to warn about.
        compiler.arg("-isystem").arg(headers).arg("-L").arg(&library).arg(rpath(&library));
        let out: PathBuf = self.prefix.join(name);
        run(compiler.args(["-lmujoco", "-lm", "-lpthread", "-ldl", "-o"]).arg(&out))?;
        run(self.workspace.command(&out).arg("assets/humanoid.pack.safetensors"))
    }
}

fn rpath(folder: &Path) -> String {
    format!("-Wl,-rpath,{}", folder.display())
}
