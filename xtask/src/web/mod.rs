//! `cargo xtask web`: the demo as a web page in `out/web`, served on this machine, or checked in a headless browser.

mod browser;
mod build;
mod check;
mod graphics;
mod http;
mod manners;
mod server;
mod shrink;

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use crate::setup::{self, Purpose};
use crate::workspace::Workspace;

/// Arguments of `cargo xtask web`.
#[derive(Debug, Args)]
pub struct WebArgs {
    /// Make the module small with wasm-opt, or with that of npm's package binaryen. Takes a minute more.
    #[arg(long)]
    release: bool,
    /// Only write out/web.
    #[arg(long, conflicts_with = "check")]
    no_serve: bool,
    /// Port on this machine; by default any that is free.
    #[arg(long, default_value_t = 0)]
    port: u16,
    /// Instead of serving, play in headless Chromium and compare states with native runs.
    ///
    /// Uses Debian's packages chromium and chromium-driver, and installs them where it may.
    #[arg(long)]
    check: bool,
    /// With --check print one JSON object.
    #[arg(long, requires = "check")]
    json: bool,
    /// With --check do not measure how fast the native demo draws, which builds it first.
    #[arg(long, requires = "check")]
    skip_native_fps: bool,
    /// With --check play on for so many minutes and report the memory, before and after.
    #[arg(long, requires = "check", default_value_t = 0.0)]
    soak_minutes: f64,
}

/// Builds the page, and serves or checks it.
///
/// # Errors
/// When a tool is missing or fails, or the check finds a difference.
pub fn run(workspace: &Workspace, arguments: &WebArgs) -> Result<()> {
    let folder = build::page(workspace, arguments.release)?;
    if arguments.check {
        setup::prepare(workspace, Purpose::Browser, true)?;
        return check::run(workspace, folder, arguments);
    }
    if !arguments.no_serve {
        return serve(folder, arguments.port);
    }
    eprintln!("xtask: the page is in {}; any static server can host it", folder.display());
    Ok(())
}

fn serve(folder: PathBuf, port: u16) -> Result<()> {
    let server = server::Server::start(folder, port)?;
    println!("http://{}/", server.address());
    eprintln!("xtask: Ctrl+C ends it");
    server.wait();
    Ok(())
}
