//! `pad`: lists pads and their problems, prints udev rules, records and plays pads.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};
use clap::{Args, Parser, Subcommand};
use gamepad::doctor::{self, SystemFacts};
use gamepad::pads::PadOutput;
use gamepad::recording::{Recording, VirtualPad};
use gamepad::{Gamepads, udev};

/// Time between two polls, about one control tick.
const TICK: Duration = Duration::from_millis(33);

/// States a second that `pad play` prints.
const PLAY_HZ: f64 = 30.0;

/// Lists gamepads and their problems, records and plays them.
#[derive(Debug, Parser)]
#[command(name = "pad", arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// List connected pads, their back ends, live values, problems and remedies.
    ///
    /// Exits with 0 when a pad works and there is no problem, else with 1.
    Doctor(DoctorArgs),
    /// Print the udev rules for all known pads.
    Udev,
    /// Record the first pad on which a button is pressed, other than a trigger.
    Record {
        /// File to write.
        file: PathBuf,
        /// Seconds to record.
        #[arg(long, default_value_t = 60.0)]
        seconds: f64,
    },
    /// Print the states of a recording at 30 Hz.
    Play {
        /// The recording.
        file: PathBuf,
    },
    /// Turn on rumble and light of the active pad for a second.
    Rumble,
}

#[derive(Debug, Args)]
struct DoctorArgs {
    /// Seconds to search and show live values.
    #[arg(long, default_value_t = 3.0)]
    seconds: f64,
}

fn main() -> Result<ExitCode> {
    // Exits quietly on SIGPIPE, as when the output is piped to `head`.
    sigpipe::reset();
    match Cli::parse().verb {
        Verb::Doctor(DoctorArgs { seconds }) => run_doctor(seconds),
        Verb::Udev => {
            print!("{}", udev::rules());
            eprintln!(
                "Install with: pad udev | sudo tee {}; sudo udevadm control --reload; sudo udevadm trigger",
                udev::RULES_PATH
            );
            Ok(ExitCode::SUCCESS)
        }
        Verb::Record { file, seconds } => record(&file, seconds),
        Verb::Play { file } => play(&file),
        Verb::Rumble => rumble(),
    }
}

fn open() -> (Gamepads, Vec<String>) {
    let (gamepads, errors) = Gamepads::with_all_backends();
    (gamepads, errors.iter().map(ToString::to_string).collect())
}

/// Polls for a time and calls `each` after every poll, until it returns true.
fn watch(
    gamepads: &mut Gamepads,
    seconds: f64,
    mut each: impl FnMut(&mut Gamepads) -> Result<bool>,
) -> Result<()> {
    let length =
        Duration::try_from_secs_f64(seconds).context("--seconds: expected a duration of at least 0")?;
    let start = Instant::now();
    while start.elapsed() < length {
        gamepads.poll();
        if each(gamepads)? {
            break;
        }
        std::thread::sleep(TICK);
    }
    Ok(())
}

fn run_doctor(seconds: f64) -> Result<ExitCode> {
    let (mut gamepads, errors) = open();
    eprintln!("Searching for {seconds} s. Put all pads down first, then press buttons and move sticks.");
    watch(&mut gamepads, seconds, |gamepads| {
        if let Some(pad) = gamepads.active() {
            eprint!("\r{:<118}", doctor::values(&gamepads.report_of(pad).state));
        }
        Ok(false)
    })?;
    eprintln!();
    let (text, sound) = doctor::report(&gamepads, &SystemFacts::of_this_system(errors));
    print!("{text}");
    if gamepads.problems().iter().any(|(_, problem)| doctor::needs_rules(problem)) {
        println!("To install the rules for all known pads: pad udev | sudo tee {}", udev::RULES_PATH);
    }
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn record(file: &Path, seconds: f64) -> Result<ExitCode> {
    let (mut gamepads, errors) = open();
    let mut key = None;
    eprintln!("Press a button on the pad to record it.");
    watch(&mut gamepads, 30.0, |gamepads| {
        key = gamepads.pressed().map(|pad| (pad.device.key, pad.device.name.clone()));
        Ok(key.is_some())
    })?;
    let Some((key, name)) = key else {
        bail!(
            "expected a button pressed on a pad within 30 s, found none ({} back ends failed); `pad doctor` lists problems",
            errors.len()
        );
    };
    let cannot_write = || format!("cannot write {}", file.display());
    let unfinished = Unfinished::beside(file);
    let out = File::create_new(&unfinished.0).with_context(cannot_write)?;
    gamepads.record(key, Box::new(BufWriter::new(out)))?;
    eprintln!("Recording {name} for {seconds} s to {}.", file.display());
    watch(&mut gamepads, seconds, |gamepads| Ok(gamepads.pad_mut(key).is_none()))?;
    if gamepads.pad_mut(key).is_none() {
        eprintln!("The pad was disconnected; the recording ends there.");
    }
    gamepads.stop_recording(key).with_context(cannot_write)?;
    unfinished.become_whole(file).with_context(cannot_write)?;
    Ok(ExitCode::SUCCESS)
}

/// A recording on its way, beside its file; removed when it does not get there.
struct Unfinished(PathBuf);

impl Unfinished {
    fn beside(file: &Path) -> Self {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        Self(file.with_file_name(format!(".{name}.{}.partial", std::process::id())))
    }

    /// Takes the place of `file` once all of it can be read.
    fn become_whole(self, file: &Path) -> Result<()> {
        Recording::load(&self.0)?;
        File::open(&self.0)?.sync_all()?;
        Ok(std::fs::rename(&self.0, file)?)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        // The error that led here is told; after a rename there is nothing to remove.
        let _ = std::fs::remove_file(&self.0);
    }
}

fn play(file: &Path) -> Result<ExitCode> {
    let recording = Recording::load(file)?;
    let duration = recording.duration();
    let mut pad = VirtualPad::new(recording).with_context(|| format!("{}", file.display()))?;
    let mut out = std::io::stdout().lock();
    for tick in 0.. {
        let time_secs = f64::from(tick) / PLAY_HZ;
        let report = pad.report_at(time_secs);
        writeln!(out, "{time_secs:8.3}  {}", doctor::values(&report.state))?;
        if time_secs >= duration {
            break;
        }
    }
    let (accepted, refused) = pad.counts();
    eprintln!("{accepted} reports accepted, {refused} refused.");
    Ok(ExitCode::SUCCESS)
}

fn rumble() -> Result<ExitCode> {
    let (mut gamepads, _) = open();
    watch(&mut gamepads, 2.0, |gamepads| Ok(gamepads.active().is_some()))?;
    let Some(key) = gamepads.active().map(|pad| pad.device.key) else {
        bail!("expected a pad, found none; `pad doctor` lists problems")
    };
    let strong = PadOutput { low_rumble: 0.6, high_rumble: 0.6, light: [0, 120, 255] };
    if !gamepads.set_output(key, &strong) {
        bail!("this pad does not support rumble through this back end");
    }
    watch(&mut gamepads, 1.0, |_| Ok(false))?;
    gamepads.set_output(key, &PadOutput { light: strong.light, ..PadOutput::default() });
    watch(&mut gamepads, 0.2, |_| Ok(false))?;
    Ok(ExitCode::SUCCESS)
}
