//! `policy-space`: the demo in a window, without one, and its benchmarks.

use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;
use viewer::cli::open::open;
use viewer::cli::{Cli, Task, bench, headless, replay_files};
use viewer::{signals, text};

/// Longest message of an error, characters.
const LONGEST_MESSAGE: usize = 2000;

fn main() -> ExitCode {
    // Exits quietly on SIGPIPE, as when `head` has read enough.
    sigpipe::reset();
    let cli = Cli::parse();
    if cli.demo.headless || cli.command.is_some() {
        silence_device_selection();
    }
    let ended = run(&cli);
    match (ended, signals::received()) {
        (Ok(()), None) => ExitCode::SUCCESS,
        (Ok(()), Some(signal)) => {
            tell(&format!("ended by {}", signal.name));
            ExitCode::from(signal.exit_status())
        }
        (Err(error), _) => {
            tell(&format!("error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}

/// Mesa's device selection asks the display for its graphics card, and complains on standard error where there is
/// no session. Runs without a window have no display to ask.
fn silence_device_selection() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: `main` calls this before it starts any thread.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// Writes a message to standard error.
fn tell(message: &str) {
    // Where standard error is closed or full there is no other place for it.
    let _ = writeln!(std::io::stderr(), "{}", text::printable(message, LONGEST_MESSAGE));
}

/// Writes a line to standard output.
fn say(line: &str) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{}", text::printable(line, LONGEST_MESSAGE))
        .map_err(|error| anyhow::anyhow!("cannot write to standard output: {error}"))
}

fn run(cli: &Cli) -> anyhow::Result<()> {
    if cli.command.is_none() {
        signals::watch()?;
    }
    match cli.command {
        Some(Task::BenchCrowd(choices)) => say(&bench::crowd(choices)?),
        Some(Task::BenchFrame(choices)) => say(&bench::frame(choices)?),
        None if cli.demo.headless && cli.demo.poses.is_some() => match headless::play(&cli.demo)? {
            Some(p) => say(&format!(
                "{}: {:.2} s of {} at {:.2} Hz, {}",
                p.clip,
                p.seconds,
                text::counted(p.poses as u64, "pose"),
                p.hz,
                text::counted(p.frames as u64, "picture"),
            )),
            None => Ok(()),
        },
        None if cli.demo.headless => say(&headless::run(&cli.demo)?.summary()),
        None => {
            let (demo, replay) = replay_files::chosen(&cli.demo)?;
            let mut opened = open(&demo)?;
            replay_files::begin(&demo, replay.as_ref(), &mut opened.app)?;
            opened.app.start_analysis();
            viewer::window::run(&demo, opened.app, opened.appearance, opened.layout)
        }
    }
}
