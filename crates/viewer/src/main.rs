//! `policy-space`: the demo in a window, without one, and its benchmarks.

use std::process::ExitCode;

use clap::Parser as _;
use viewer::cli::open::open;
use viewer::cli::{Cli, Task, bench, headless};

fn main() -> ExitCode {
    // Whoever reads no further, as `head`, ends the program without a word.
    sigpipe::reset();
    match run(&Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(cli: &Cli) -> anyhow::Result<()> {
    match cli.command {
        Some(Task::BenchCrowd(choices)) => bench::crowd(choices),
        Some(Task::BenchFrame(choices)) => bench::frame(choices),
        None if cli.demo.headless && cli.demo.poses.is_some() => {
            if let Some(p) = headless::play(&cli.demo)? {
                println!(
                    "{}: {:.2} s of {} poses at {:.2} Hz, {} pictures",
                    p.clip, p.seconds, p.poses, p.hz, p.frames
                );
            }
            Ok(())
        }
        None if cli.demo.headless => {
            let report = headless::run(&cli.demo)?;
            println!(
                "{:.1} s, {} characters: upright {:.1} %, {:.2} m, {} falls, {:.2} m/s, state {}",
                report.seconds,
                report.characters,
                100.0 * report.upright_fraction,
                report.distance_m,
                report.falls,
                report.mean_speed_mps,
                report.state_hash,
            );
            Ok(())
        }
        None => {
            let mut opened = open(&cli.demo)?;
            opened.app.start_analysis();
            viewer::window::run(&cli.demo, opened.app, opened.mesh, opened.layout)
        }
    }
}
