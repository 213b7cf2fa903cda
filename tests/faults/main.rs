//! What a crash, a full disk, a folder that can't be written and a second writer leave behind: the newest file or the
//! one before it, whole, and nothing half-written beside it.
//!
//! The writers run in child processes: this program again, with the test `child` and its part in the environment.
#![cfg(unix)]

mod disk;
mod writers;

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use writers::{ALL, Writer};

/// Times that saving is interrupted, and that two processes write at once.
const KILLS: u64 = 200;
const MEETINGS: u64 = 50;

/// The words with which a child tells that a version is written.
const WROTE: &str = "wrote ";

/// What a child is to do: `WRITER PART COUNT FOLDER`.
const TASK: &str = "POLICY_SPACE_FAULT";

fn command(writer: &Writer, part: &str, count: u64, folder: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "child", "--nocapture", "--test-threads=1"]);
    command.env(TASK, format!("{} {part} {count} {}", writer.name, folder.display()));
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Not a test of its own: the part that a fault run's child plays.
#[test]
fn child() {
    let Ok(task) = std::env::var(TASK) else { return };
    let [name, part, count, folder] = task.splitn(4, ' ').collect::<Vec<_>>()[..] else {
        panic!("a task has four words: {task}")
    };
    let writer = ALL.iter().find(|writer| writer.name == name).expect("a known writer");
    let (count, folder) = (count.parse().unwrap(), Path::new(folder));
    match part {
        "write" => write(writer, count, folder),
        "disk" => disk::fill_and_forbid(writer, folder),
        "forbid" => disk::forbid(writer, folder),
        _ => panic!("an unknown part {part}"),
    }
}

/// Writes so many versions after the one that is there.
fn write(writer: &Writer, count: u64, folder: &Path) {
    for _ in 0..count {
        let next = 1 + (writer.read)(folder).unwrap().unwrap_or(0);
        if let Err(error) = (writer.write)(folder, next) {
            println!("failed: {error}");
            return;
        }
        println!("{WROTE}{next}");
    }
}

/// The last version that a child told of.
fn last_told(said: &str) -> Option<u64> {
    said.lines().rev().find_map(|line| line.split_once(WROTE)?.1.parse().ok())
}

/// The version that is there. It must be whole.
fn whole(writer: &Writer, folder: &Path, when: &str) -> Option<u64> {
    (writer.read)(folder).unwrap_or_else(|error| panic!("{} after {when}: {error}", writer.name))
}

/// Files that no finished write leaves.
fn unfinished(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        match entry.path() {
            path if path.is_dir() => found.extend(unfinished(&path)),
            path if path.to_string_lossy().contains("partial") => found.push(path.display().to_string()),
            _ => {}
        }
    }
    found
}

/// Reads what a child says until it tells of a version.
fn await_first(child: &mut Child) -> (String, BufReader<std::process::ChildStdout>) {
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let mut said = String::new();
    while last_told(&said).is_none() && lines.read_line(&mut said).unwrap() > 0 {}
    assert!(last_told(&said).is_some(), "it wrote nothing: {said}");
    (said, lines)
}

#[test]
fn a_process_that_is_killed_while_it_saves_loses_nothing() {
    for writer in ALL {
        // The others share the code of one of the two that are killed most.
        let kills = if writer.name == "checkpoint" { KILLS } else { KILLS / 5 };
        let folder = tempfile::tempdir().unwrap();
        let mut versions = 0;
        for kill in 0..kills {
            let mut child = command(writer, "write", u64::MAX, folder.path()).spawn().unwrap();
            let (mut said, mut lines) = await_first(&mut child);
            // Another moment of the next save each time.
            std::thread::sleep(Duration::from_micros(kill * 7919 % 9000));
            child.kill().unwrap();
            child.wait().unwrap();
            lines.read_to_string(&mut said).unwrap();
            let (told, found) = (last_told(&said).unwrap(), whole(writer, folder.path(), "kill -9"));
            assert!(found >= Some(told), "{}: {found:?} after {told} was saved", writer.name);
            versions = told;
        }
        println!("{}: {kills} kills, {versions} versions", writer.name);
    }
}

#[test]
fn a_write_beyond_the_limit_leaves_the_file_as_it_was() {
    for writer in ALL {
        let folder = tempfile::tempdir().unwrap();
        (writer.write)(folder.path(), 1).unwrap();
        writers::let_go();
        let size = largest(folder.path());
        let (mut failed, mut done) = (0, 0);
        for step in 0..=20 {
            // `ulimit` counts blocks of 512 bytes; the signal of a file that grows too large is ignored.
            let blocks = step * (size / 512 + 2) / 20;
            let inner = command(writer, "write", 1, folder.path());
            let mut outer = Command::new("sh");
            outer.args(["-c", "trap '' XFSZ; ulimit -f \"$0\" && exec \"$@\"", &blocks.to_string()]);
            outer.arg(inner.get_program()).args(inner.get_args());
            outer.envs(inner.get_envs().filter_map(|(key, value)| Some((key, value?))));
            let before = whole(writer, folder.path(), "a write");
            let output = outer.output().unwrap();
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            let after = whole(writer, folder.path(), "a write that is too large");
            match last_told(&said) {
                Some(told) => (assert_eq!(after, Some(told)), done += 1).1,
                None => {
                    assert!(said.contains("failed: ") || !output.status.success(), "{said}");
                    assert_eq!(after, before, "{} at {blocks} blocks: {said}", writer.name);
                    failed += 1;
                }
            }
            assert_eq!(unfinished(folder.path()), [""; 0], "{} at {blocks} blocks", writer.name);
        }
        println!("{}: {failed} writes failed, {done} did not", writer.name);
        assert!(failed >= 10 && done >= 1, "{}: {failed} and {done}", writer.name);
    }
}

/// Size of the largest file in a folder, bytes.
fn largest(folder: &Path) -> u64 {
    let size =
        |path: &Path| if path.is_dir() { largest(path) } else { path.metadata().map_or(0, |m| m.len()) };
    std::fs::read_dir(folder).unwrap().map(|entry| size(&entry.unwrap().path())).max().unwrap_or(0)
}

/// Runs a child under another program; says what it printed when it said `done`.
fn under(outer: &[&str], inner: &Command, done: &str) -> Result<String, String> {
    let mut command = Command::new(outer[0]);
    command.args(&outer[1..]).arg(inner.get_program()).args(inner.get_args());
    command.envs(inner.get_envs().filter_map(|(key, value)| Some((key, value?))));
    let output = command.output().map_err(|error| format!("{}: {error}", outer[0]))?;
    let said = String::from_utf8_lossy(&[&output.stdout[..], &output.stderr[..]].concat()).into_owned();
    assert!(!said.contains("panicked"), "{said}");
    match said.lines().find(|line| line.contains(done)) {
        Some(line) if output.status.success() => Ok(line.to_owned()),
        _ => Err(said),
    }
}

#[test]
fn a_full_disk_and_a_folder_made_read_only_leave_the_file_as_it_was() {
    for writer in ALL {
        let folder = tempfile::tempdir().unwrap();
        let inner = command(writer, "disk", 1, folder.path());
        let done = under(&["unshare", "-rm", "--"], &inner, disk::DONE).or_else(|no_mount| {
            println!("{}: no disk of its own here, the mode of the folder instead: {no_mount}", writer.name);
            let inner = command(writer, "forbid", 1, folder.path());
            under(&["env"], &inner, disk::FORBIDDEN).or_else(|held| {
                assert!(held.contains(disk::NOT_HELD_BACK), "{held}");
                // Root writes anywhere, unless it lays that right down.
                under(&["setpriv", "--bounding-set=-dac_override", "--"], &inner, disk::FORBIDDEN)
            })
        });
        println!("{}", done.expect("`unshare -rm`, `setpriv` or a user other than root"));
    }
}

#[test]
fn two_processes_at_once_leave_a_whole_file() {
    for writer in ALL {
        let folder = tempfile::tempdir().unwrap();
        let (mut refused, mut reads) = (0, 0);
        for _ in 0..MEETINGS {
            let start = || command(writer, "write", 5, folder.path()).spawn().unwrap();
            let mut pair = [start(), start()];
            let begin = Instant::now();
            while pair.iter_mut().any(|child| child.try_wait().unwrap().is_none()) {
                whole(writer, folder.path(), "a read beside two writers");
                reads += 1;
                assert!(begin.elapsed() < Duration::from_secs(60), "{} hangs", writer.name);
            }
            let said = pair.map(|child| child.wait_with_output().unwrap());
            let said = said.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
            assert!(said.iter().any(|said| last_told(said).is_some()), "{}: {said:?}", writer.name);
            refused += said.iter().filter(|said| said.contains("no other trainer")).count();
            let told = said.iter().filter_map(|said| last_told(said)).max();
            let found = whole(writer, folder.path(), "two writers");
            assert!(found.is_some() && (writer.name != "checkpoint" || found == told), "{said:?}");
        }
        println!("{}: {MEETINGS} meetings, {refused} refused, {reads} whole reads meanwhile", writer.name);
        assert!(writer.name != "checkpoint" || refused > 0, "expected the lock to refuse a writer");
        assert_eq!(unfinished(folder.path()), [""; 0], "{}", writer.name);
    }
}
