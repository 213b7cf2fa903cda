//! `cargo xtask`: set-up, demo, checks and benchmarks of Policy Space, one command each.
//!
//! Depends on nothing that links libmujoco, because it has to run before libmujoco is there.

mod bench;
mod capi;
mod checks;
mod demo;
mod determinism;
mod fuzz;
mod hostile;
mod onnx;
mod rapier_patch;
mod setup;
mod web;
mod workspace;

use std::ffi::OsString;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Args, Parser, Subcommand};

use crate::setup::Purpose;
use crate::workspace::{Workspace, exit_code_of};

/// Set-up, demo, checks and benchmarks of Policy Space.
///
/// Most users need two commands: `cargo xtask demo` and `cargo xtask test`. Each makes the machine ready first.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

/// The verbs of the program.
#[derive(Debug, Subcommand)]
enum Verb {
    /// Fetch libmujoco and install the system packages that are missing.
    ///
    /// libmujoco 3.17.0 comes from its Python wheel, pinned by hash, and is put in third_party/mujoco.
    /// POLICY_SPACE_MUJOCO_WHEEL=FILE uses a wheel that is already on this machine. MUJOCO_DYNAMIC_LINK_DIR=DIR uses
    /// a libmujoco that is. Running it again is quick.
    Setup(SetupArgs),
    /// Set up, then run the demo.
    #[command(after_help = demo::HELP, disable_help_flag = true)]
    Demo(DemoArgs),
    /// Set up, then run every check that CI runs, and list how each ended.
    Test(TestArgs),
    /// Check which crate imports which.
    Imports,
    /// Check that items and fields have the names of the field, and report source files that are too long.
    Words,
    /// Check licences, banned crates, sources and security advisories with cargo-deny.
    ///
    /// Installs the pinned cargo-deny in third_party/tools first; this takes about two minutes, once.
    Deny,
    /// Check what a release needs: packages, oldest dependencies, features that the tests leave off.
    ///
    /// Compiles Rapier three times and Bevy once more.
    PublishCheck(PublishArgs),
    /// Build the C interface and install header, libraries and pkg-config file.
    Capi(capi::CapiArgs),
    /// Measure, and print a table or one JSON object.
    Bench(bench::BenchArgs),
    /// Export the shipped pack as ONNX models and compare ONNX Runtime and tract with policy-core.
    ///
    /// ONNX Runtime comes from its Python wheel, pinned by hash. tract takes some minutes to compile.
    Onnx,
    /// Compare the states of one fixed run in debug and release, with AVX2 and without, under wasm32 and on arm64.
    ///
    /// wasm32 needs Node.js, arm64 a cross compiler and an emulator; what is missing is skipped and named.
    Determinism(determinism::DeterminismArgs),
    /// Feed random bytes to the parsers. Needs a nightly toolchain and cargo-fuzz.
    Fuzz(fuzz::FuzzArgs),
    /// Give broken files to every reader, and report panics, aborts, hangs and too much memory.
    ///
    /// Each file is a valid file of the project with one fault injected. The time and memory of each reader are bounded.
    /// One file of each finding is kept in out/hostile.
    Hostile(hostile::HostileArgs),
    /// Write a patched copy of Rapier's source, with which a physics step takes half the time.
    ///
    /// Prints what a game puts into its Cargo.toml. Nothing in this workspace builds on it.
    RapierPatch(rapier_patch::RapierPatchArgs),
    /// Build the demo as a web page in out/web and serve it on this machine.
    ///
    /// Installs the target wasm32-unknown-unknown, and the binding generator in third_party/tools, by itself.
    Web(web::WebArgs),
    /// List and test connected gamepads: `cargo xtask pad doctor`.
    Pad {
        /// Arguments of the program `pad`. `doctor` lists devices and shows what they report.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, default_value = "doctor")]
        arguments: Vec<OsString>,
    },
}

/// Arguments of `cargo xtask setup`.
#[derive(Debug, Args)]
struct SetupArgs {
    /// Only say which system packages are missing.
    #[arg(long)]
    no_install: bool,
}

/// Arguments of `cargo xtask demo`.
#[derive(Debug, Args)]
struct DemoArgs {
    /// Passed to the demo, except --no-install.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENT")]
    arguments: Vec<OsString>,
}

/// Arguments of `cargo xtask test`.
#[derive(Debug, Args)]
struct TestArgs {
    /// Only say which system packages are missing.
    #[arg(long)]
    no_install: bool,
    /// Count a skipped check as failed: without a network for the advisories, or one that is written for Linux elsewhere.
    #[arg(long)]
    strict: bool,
}

/// Arguments of `cargo xtask publish-check`.
#[derive(Debug, Args)]
struct PublishArgs {
    /// Leave out the step that compiles Bevy.
    #[arg(long)]
    no_bevy: bool,
}

fn main() -> ExitCode {
    match dispatch(Cli::parse().verb) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("xtask: error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn dispatch(verb: Verb) -> Result<ExitCode> {
    let workspace = Workspace::find()?;
    match verb {
        Verb::Setup(arguments) => {
            setup::prepare(&workspace, Purpose::Tests, !arguments.no_install)?;
            eprintln!("xtask: libmujoco is ready");
        }
        Verb::Demo(arguments) => return demo::run(&workspace, arguments.arguments),
        Verb::Test(arguments) => {
            setup::prepare(&workspace, Purpose::Tests, !arguments.no_install)?;
            return Ok(checks::run(&workspace, checks::ALL, arguments.strict));
        }
        Verb::Imports => checks::imports::check(&workspace)?,
        Verb::Words => checks::words::check(&workspace)?,
        Verb::Deny => return Ok(checks::run(&workspace, checks::DENY, false)),
        Verb::PublishCheck(arguments) => {
            setup::prepare(&workspace, Purpose::Tests, false)?;
            let steps = if arguments.no_bevy { checks::PUBLISH } else { checks::PUBLISH_ALL };
            return Ok(checks::run(&workspace, steps, false));
        }
        Verb::Capi(arguments) if arguments.check => {
            setup::prepare(&workspace, Purpose::Tests, false)?;
            return Ok(checks::run(&workspace, checks::C_INTERFACE, false));
        }
        Verb::Capi(arguments) => capi::run(&workspace, &arguments)?,
        Verb::Bench(arguments) => bench::run(&workspace, &arguments)?,
        Verb::Onnx => {
            setup::prepare(&workspace, Purpose::Demo, true)?;
            onnx::run(&workspace)?;
        }
        Verb::Determinism(arguments) => determinism::run(&workspace, &arguments)?,
        Verb::Fuzz(arguments) => fuzz::run(&workspace, &arguments)?,
        Verb::Hostile(arguments) => hostile::run(&workspace, &arguments)?,
        Verb::RapierPatch(arguments) => rapier_patch::run(&workspace, &arguments)?,
        Verb::Web(arguments) => web::run(&workspace, &arguments)?,
        Verb::Pad { arguments } => {
            let mut pad = workspace.cargo();
            pad.args(["run", "--quiet", "-p", "policy-space-gamepad", "--bin", "pad", "--"]).args(arguments);
            return exit_code_of(&mut pad);
        }
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }

    #[test]
    fn arguments_of_the_demo_go_through() {
        let cli = Cli::parse_from(["xtask", "demo", "--headless", "--seconds", "3"]);
        let Verb::Demo(arguments) = cli.verb else { panic!("not the demo") };
        assert_eq!(arguments.arguments, ["--headless", "--seconds", "3"]);
    }

    #[test]
    fn help_of_the_demo_is_handled_by_the_demo() {
        let cli = Cli::parse_from(["xtask", "demo", "--help"]);
        let Verb::Demo(arguments) = cli.verb else { panic!("not the demo") };
        assert_eq!(arguments.arguments, ["--help"]);
    }
}
