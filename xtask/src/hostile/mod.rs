//! `cargo xtask hostile`: gives thousands of broken files to everything that reads files.
//!
//! `tests/hostile` holds the readers and writes sound files for each; this half breaks the files and bounds the
//! child processes that read them. It knows the readers only as folders of sound files.

mod child;
mod json;
mod mutate;
mod random;
mod report;
mod special;
mod text;

use std::collections::VecDeque;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use self::child::{Bounds, Outcome, Reader};
use self::random::Random;
use self::report::Report;
use crate::setup::{self, Purpose, remove_folder};
use crate::workspace::{Workspace, run as run_command};

/// Arguments of `cargo xtask hostile`.
#[derive(Debug, Args)]
pub struct HostileArgs {
    /// Broken files in total, shared out evenly among the readers.
    #[arg(long, default_value_t = 10_000)]
    cases: usize,
    /// Only this reader.
    #[arg(long)]
    reader: Option<String>,
    /// Read only this file, with --reader, to see a finding again.
    #[arg(long, requires = "reader")]
    file: Option<PathBuf>,
    /// Another seed makes other files.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Longest time for one file, seconds.
    #[arg(long, default_value_t = 5.0)]
    seconds: f64,
    /// Most memory for one reader, megabytes.
    #[arg(long, default_value_t = 500)]
    megabytes: u64,
    /// Print one JSON object: cases, seconds, readers, findings.
    #[arg(long)]
    json: bool,
    /// Build the readers with optimisation: no overflow checks, but the programs as they ship.
    #[arg(long)]
    release: bool,
}

/// Cases that one child reads before it is replaced.
const CHUNK: usize = 200;

/// Cases of each chunk that are as long as a reader may take.
const FLOODS: usize = 6;

/// The sound files of one reader.
struct Subject {
    name: String,
    sound: Vec<(PathBuf, Vec<u8>)>,
}

/// Everything that the workers share.
struct Setup<'a> {
    workspace: &'a Workspace,
    binary: PathBuf,
    scratch: PathBuf,
    kept: PathBuf,
    bounds: Bounds,
    seed: u64,
}

/// Makes and reads the files; prints what was found.
///
/// # Errors
/// When the readers cannot be built or run, or a file broke one of them.
pub fn run(workspace: &Workspace, arguments: &HostileArgs) -> Result<()> {
    ensure!((0.01..3600.0).contains(&arguments.seconds), "expected 0.01 to 3600 seconds");
    ensure!((50..=1 << 20).contains(&arguments.megabytes), "expected 50 megabytes or more");
    setup::prepare(workspace, Purpose::Demo, false)?;
    let scratch = workspace.target().join("hostile");
    let (kept, seeds) = (workspace.root().join("out/hostile"), scratch.join("seeds"));
    let bounds =
        Bounds { time: Duration::from_secs_f64(arguments.seconds), bytes: arguments.megabytes << 20 };
    let binary = build(workspace, arguments.release)?;
    let setup = Setup { workspace, binary, scratch, kept, bounds, seed: arguments.seed };
    if let (Some(file), Some(reader)) = (&arguments.file, &arguments.reader) {
        return again(&setup, reader, file);
    }
    for folder in [&setup.scratch, &setup.kept] {
        remove_folder(folder)?;
        fs::create_dir_all(folder).with_context(|| format!("create {}", folder.display()))?;
    }
    run_command(workspace.command(&setup.binary).arg("seeds").arg(&seeds))?;
    let mut subjects = subjects(&seeds)?;
    if let Some(name) = &arguments.reader {
        let known: Vec<String> = subjects.iter().map(|subject| subject.name.clone()).collect();
        subjects.retain(|subject| subject.name == *name);
        ensure!(!subjects.is_empty(), "no reader {name}; there are: {}", known.join(", "));
    }
    let start = Instant::now();
    let report = read_all(&setup, &subjects, arguments.cases)?;
    let seconds = start.elapsed().as_secs_f64();
    if arguments.json {
        println!("{}", report.to_json(seconds));
    } else {
        print!("{}", report.to_table(seconds));
    }
    let found = report.findings().count();
    ensure!(found == 0, "{found} findings; a file of each is in {}", setup.kept.display());
    Ok(())
}

/// Builds the program of the readers and returns its path.
fn build(workspace: &Workspace, release: bool) -> Result<PathBuf> {
    let mut command = workspace.cargo();
    command.args(["build", "--quiet", "-p", "integration-tests", "--bin", "hostile-reader"]);
    if release {
        command.arg("--release");
    }
    run_command(&mut command)?;
    let folder = workspace.target().join(if release { "release" } else { "debug" });
    Ok(folder.join(format!("hostile-reader{}", std::env::consts::EXE_SUFFIX)))
}

/// Reads one file and says how that ended.
fn again(setup: &Setup<'_>, name: &str, file: &Path) -> Result<()> {
    let stderr = setup.scratch.join("again.log");
    fs::create_dir_all(&setup.scratch).with_context(|| format!("create {}", setup.scratch.display()))?;
    let mut reader = Reader::start(setup.workspace, &setup.binary, name, stderr.clone(), setup.bounds)?;
    let outcome = reader.read(file)?;
    eprint!("{}", fs::read_to_string(&stderr).unwrap_or_default());
    match outcome {
        Outcome::Broken(fault, what) => bail!("{}: {what}", fault.name()),
        Outcome::Accepted => println!("accepted"),
        Outcome::Refused => println!("refused"),
    }
    Ok(())
}

/// The readers and their sound files: one folder each.
fn subjects(seeds: &Path) -> Result<Vec<Subject>> {
    let mut subjects = Vec::new();
    for folder in sorted_entries(seeds)? {
        let mut sound = Vec::new();
        for path in sorted_entries(&folder)? {
            let bytes = fs::read(&path).with_context(|| format!("read {}", path.display()))?;
            sound.push((path, bytes));
        }
        ensure!(!sound.is_empty(), "{} has no sound file", folder.display());
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        subjects.push(Subject { name, sound });
    }
    ensure!(!subjects.is_empty(), "{} has no readers", seeds.display());
    Ok(subjects)
}

fn sorted_entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("list {}", folder.display()))?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

/// Shares the cases out among one worker for each core.
fn read_all(setup: &Setup<'_>, subjects: &[Subject], cases: usize) -> Result<Report> {
    let each = cases.div_ceil(subjects.len());
    let chunks = (0..each).step_by(CHUNK).map(|first| first..(first + CHUNK).min(each));
    let jobs: VecDeque<_> =
        chunks.flat_map(|chunk| subjects.iter().map(move |subject| (subject, chunk.clone()))).collect();
    let (jobs, report) = (Mutex::new(jobs), Mutex::new(Report::default()));
    let work = |worker: usize| -> Result<()> {
        let next = || jobs.lock().expect("no worker panics").pop_front();
        while let Some((subject, cases)) = next() {
            read_chunk(setup, subject, cases, worker, &report)?;
        }
        Ok(())
    };
    let workers = available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let work = &work;
        let threads: Vec<_> = (0..workers).map(|worker| scope.spawn(move || work(worker))).collect();
        threads.into_iter().try_for_each(|thread| thread.join().expect("no worker panics"))
    })?;
    Ok(report.into_inner().expect("no worker panics"))
}

/// Reads some cases of one reader; a child that breaks is replaced.
fn read_chunk(
    setup: &Setup<'_>,
    subject: &Subject,
    cases: std::ops::Range<usize>,
    worker: usize,
    report: &Mutex<Report>,
) -> Result<()> {
    let folder = setup.scratch.join(format!("worker-{worker}"));
    fs::create_dir_all(&folder).with_context(|| format!("create {}", folder.display()))?;
    let start = || {
        let stderr = folder.join("stderr.log");
        Reader::start(setup.workspace, &setup.binary, &subject.name, stderr, setup.bounds)
    };
    let mut reader = start()?;
    for case in cases {
        let path = make_case(setup, subject, case, &folder)?;
        let begin = Instant::now();
        let outcome = reader.read(&path)?;
        let gone = !matches!(outcome, Outcome::Accepted | Outcome::Refused);
        let mut report = report.lock().expect("no worker panics");
        if let Some(name) = report.add(&subject.name, &outcome, begin.elapsed(), &path) {
            let kept = setup.kept.join(name);
            // A pipe or a device cannot be kept; its name says what it was.
            if path.is_file() {
                fs::copy(&path, &kept).with_context(|| format!("write {}", kept.display()))?;
            }
        }
        drop(report);
        if gone {
            reader = start()?;
        }
    }
    Ok(())
}

/// Writes the file of one case; the first ones are no ordinary files.
fn make_case(setup: &Setup<'_>, subject: &Subject, case: usize, folder: &Path) -> Result<PathBuf> {
    let mut random = Random::new(seed_of(setup.seed, &subject.name, case));
    let (path, sound) = &subject.sound[case % subject.sound.len()];
    let name = path.file_name().unwrap_or_default();
    if let Some(special) = special::make(case, folder, name)? {
        return Ok(special);
    }
    let (_, other) = &subject.sound[random.below(subject.sound.len())];
    let path = folder.join(name);
    let flood = case % CHUNK < FLOODS + special::KINDS.len();
    let bytes =
        if flood { mutate::flooded(sound, &mut random) } else { mutate::mutated(sound, other, &mut random) };
    fs::write(&path, bytes).with_context(|| format!("write {}", path.display()))?;
    Ok(path)
}

/// The seed of one case: every reader gets its own.
fn seed_of(seed: u64, reader: &str, case: usize) -> u64 {
    let name = reader.bytes().fold(seed, |hash, byte| Random::new(hash ^ u64::from(byte)).bits());
    Random::new(name ^ case as u64).bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn readers_are_the_folders_of_sound_files() {
        let folder = ScratchFolder::new("hostile-seeds");
        fs::create_dir_all(folder.path().join("script")).unwrap();
        assert!(subjects(folder.path()).is_err());
        fs::write(folder.path().join("script/walk.ron"), "()").unwrap();
        let found = subjects(folder.path()).unwrap();
        assert_eq!((found[0].name.as_str(), found[0].sound.len()), ("script", 1));
    }

    #[test]
    fn every_case_of_every_reader_has_its_own_seed() {
        let all: std::collections::HashSet<u64> = ["pack", "mesh", "kcap"]
            .iter()
            .flat_map(|reader| (0..1000).map(move |case| seed_of(1, reader, case)))
            .collect();
        assert_eq!(all.len(), 3000);
    }
}
