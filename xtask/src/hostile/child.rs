//! One child process that reads files, with bounds on its time and memory.
//!
//! It gets a path a line on stdin and answers each with a line on stdout, see `tests/hostile/main.rs`. A child that
//! panics, is killed or hangs says which file did it, because it is the last one that it was given.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::workspace::Workspace;

/// What a file may cost.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    /// Longest time to read one file, processor time where it can be told.
    pub time: Duration,
    /// Most memory of the child, bytes.
    pub bytes: u64,
}

/// How the reading of one file ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// It was read and used.
    Accepted,
    /// It was refused with an error.
    Refused,
    /// Something that no file may cause.
    Broken(Fault, String),
}

/// The faults that are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// The program panicked.
    Panic,
    /// The program was ended by a signal, its own abort among them.
    Abort,
    /// It took longer than the bound.
    Hang,
    /// It took more memory than the bound.
    Memory,
    /// The error message is endless or carries control characters of the file.
    Message,
}

impl Fault {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Panic => "panic",
            Self::Abort => "abort",
            Self::Hang => "hang",
            Self::Memory => "memory",
            Self::Message => "message",
        }
    }
}

/// A running child.
pub struct Reader {
    child: Child,
    stdin: ChildStdin,
    answers: Receiver<String>,
    stderr: PathBuf,
    bounds: Bounds,
}

/// Longest error message that is no fault, bytes.
const LONGEST_MESSAGE: usize = 2000;

impl Reader {
    /// Starts the program `binary` for the reader `name`; its stderr goes to the file `stderr`.
    ///
    /// # Errors
    /// When it cannot be started.
    pub fn start(
        workspace: &Workspace,
        binary: &Path,
        name: &str,
        stderr: PathBuf,
        bounds: Bounds,
    ) -> Result<Self> {
        let log = File::create(&stderr).with_context(|| format!("create {}", stderr.display()))?;
        let mut command = bounded(workspace, binary, bounds);
        command.args(["read", name]).env("RUST_BACKTRACE", "0");
        // A heap for each thread would reserve address space that counts against the bound.
        command.env("MALLOC_ARENA_MAX", "1");
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .with_context(|| format!("start {}", binary.display()))?;
        let stdin = child.stdin.take().context("the child has no stdin")?;
        let stdout = BufReader::new(child.stdout.take().context("the child has no stdout")?);
        let (sender, answers) = channel();
        std::thread::spawn(move || {
            let mut lines = stdout.lines().map_while(Result::ok);
            // Ends with the child, or when the receiver is dropped.
            while lines.next().is_some_and(|line| sender.send(line).is_ok()) {}
        });
        Ok(Self { child, stdin, answers, stderr, bounds })
    }

    /// Has one file read. After [`Outcome::Broken`] with another fault than a message the child is gone.
    ///
    /// # Errors
    /// When the child cannot be waited for.
    pub fn read(&mut self, path: &Path) -> Result<Outcome> {
        let start = (Instant::now(), self.processor_time());
        // A child that is gone is noticed by the missing answer.
        let _ = writeln!(self.stdin, "{}", path.display());
        loop {
            match self.answers.recv_timeout(self.bounds.time) {
                Ok(answer) => return Ok(judged(&answer, self.bounds)),
                Err(RecvTimeoutError::Disconnected) => return self.ended(),
                Err(RecvTimeoutError::Timeout) => {}
            }
            let used = match (self.processor_time(), start.1) {
                (Some(now), Some(then)) => now.saturating_sub(then),
                _ => start.0.elapsed(),
            };
            // On a busy machine a child waits for its turn; one that waits for ever never gets one.
            let idle = start.0.elapsed() >= 2 * self.bounds.time && used < self.bounds.time / 10;
            if used >= self.bounds.time || idle || start.0.elapsed() >= 6 * self.bounds.time {
                self.child.kill().context("end a child that hangs")?;
                self.child.wait().context("wait for a child that hung")?;
                let what = if used < self.bounds.time { "waits for ever" } else { "takes too long" };
                return Ok(Outcome::Broken(Fault::Hang, what.to_owned()));
            }
        }
    }

    /// Why the child is gone.
    fn ended(&mut self) -> Result<Outcome> {
        let status = self.child.wait().context("wait for a child")?;
        let said = fs::read(&self.stderr).unwrap_or_default();
        Ok(fault_of(status, &String::from_utf8_lossy(&said)))
    }

    /// Processor time that the child has used, where the system tells it (Linux).
    fn processor_time(&self) -> Option<Duration> {
        let text = fs::read_to_string(format!("/proc/{}/stat", self.child.id())).ok()?;
        let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
        let ticks = |index: usize| fields.get(index)?.parse::<u64>().ok();
        // User and system time, in hundredths of a second.
        Some(Duration::from_millis(10 * (ticks(11)? + ticks(12)?)))
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A command under the bound on memory, where the system has a shell that can set one.
fn bounded(workspace: &Workspace, binary: &Path, bounds: Bounds) -> Command {
    if !cfg!(unix) {
        return workspace.command(binary);
    }
    let mut command = workspace.command("sh");
    command.args(["-c", "ulimit -v \"$0\" && ulimit -c 0 && exec \"$@\""]);
    command.arg((bounds.bytes / 1024).to_string()).arg(binary);
    command
}

/// What an answer says: `accepted KILOBYTES` or `refused KILOBYTES MESSAGE`.
fn judged(answer: &str, bounds: Bounds) -> Outcome {
    let mut words = answer.splitn(3, ' ');
    let (word, peak, message) = (words.next(), words.next(), words.next());
    let peak = peak.and_then(|peak| peak.parse::<u64>().ok()).unwrap_or(0) * 1024;
    if peak > bounds.bytes {
        return Outcome::Broken(Fault::Memory, format!("{} MB or more", bounds.bytes >> 20));
    }
    match (word, message) {
        (Some("accepted"), _) => Outcome::Accepted,
        // The bound turns endless memory into an error of the system, which a user's machine would not give.
        (Some("refused"), Some(message)) if is_out_of_memory(message) => {
            Outcome::Broken(Fault::Memory, "reads until the memory is used up".to_owned())
        }
        (Some("refused"), message) => message_fault(message.unwrap_or_default())
            .map_or(Outcome::Refused, |what| Outcome::Broken(Fault::Message, what.to_owned())),
        _ => Outcome::Broken(Fault::Message, "the reader wrote to stdout".to_owned()),
    }
}

/// What is wrong with an error message, which comes with its control characters escaped.
fn message_fault(message: &str) -> Option<&'static str> {
    if message.is_empty() {
        return Some("an empty message");
    }
    if message.len() > LONGEST_MESSAGE {
        return Some("a message of more than 2000 bytes");
    }
    // A backslash of the message itself comes doubled; what it escapes is sound.
    let message = message.replace("\\\\", "");
    let escapes = ["\\u{1b}", "\\0", "\\u{7}"];
    escapes.iter().any(|escape| message.contains(escape)).then_some("a message with control characters")
}

fn fault_of(status: ExitStatus, said: &str) -> Outcome {
    if let Some((_, panic)) = said.split_once("panicked at ") {
        let mut lines = panic.lines();
        let (place, message) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
        return Outcome::Broken(Fault::Panic, format!("{place} {}", without_numbers(message)));
    }
    let says_something = |line: &&str| !line.trim().is_empty() && !line.starts_with("note:");
    let last = said.lines().find(|line| is_out_of_memory(line));
    let last = last.or_else(|| said.lines().rfind(says_something)).unwrap_or_default();
    let fault = if is_out_of_memory(said) { Fault::Memory } else { Fault::Abort };
    Outcome::Broken(fault, format!("{status} {}", without_numbers(last)).trim().to_owned())
}

fn is_out_of_memory(said: &str) -> bool {
    let words = [
        "memory allocation of",
        "out of memory",
        "Cannot allocate memory",
        "Could not allocate",
        "bad_alloc",
    ];
    words.iter().any(|words| said.contains(words))
}

/// A message without its numbers, so that equal faults have equal texts; cut to a line.
fn without_numbers(message: &str) -> String {
    let mut text = String::new();
    for character in message.chars().take(160) {
        match character {
            '0'..='9' if text.ends_with('#') => {}
            '0'..='9' => text.push('#'),
            other => text.push(if other.is_control() { ' ' } else { other }),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { time: Duration::from_secs(5), bytes: 500 << 20 };

    #[test]
    fn answers_are_told_apart() {
        assert_eq!(judged("accepted 1000", BOUNDS), Outcome::Accepted);
        assert_eq!(judged("refused 1000 expected a list", BOUNDS), Outcome::Refused);
        let fault = |answer: &str| match judged(answer, BOUNDS) {
            Outcome::Broken(fault, _) => Some(fault),
            _ => None,
        };
        assert_eq!(fault("accepted 600000"), Some(Fault::Memory));
        assert_eq!(fault("refused 1 expected \\u{1b}[2J"), Some(Fault::Message));
        assert_eq!(fault(&format!("refused 1 {}", "x".repeat(3000))), Some(Fault::Message));
        assert_eq!(fault("refused 1 read a.ron: out of memory"), Some(Fault::Memory));
        assert_eq!(fault("refused 1 expected \\\\u{1b}"), None);
        assert_eq!(fault("refused 1"), Some(Fault::Message));
    }

    #[test]
    fn equal_faults_have_equal_texts() {
        assert_eq!(without_numbers("index 1234 of 5"), without_numbers("index 7 of 88"));
        assert_eq!(without_numbers("a\u{1b}b"), "a b");
    }

    #[cfg(unix)]
    #[test]
    fn how_a_child_ended_is_told() {
        use std::os::unix::process::ExitStatusExt;
        let panic = "\nthread 'main' panicked at src/a.rs:1:2:\nindex out of bounds: 3\nnote: x\n";
        let expected = Outcome::Broken(Fault::Panic, "src/a.rs:1:2: index out of bounds: #".to_owned());
        assert_eq!(fault_of(ExitStatus::from_raw(101 << 8), panic), expected);
        let Outcome::Broken(fault, _) =
            fault_of(ExitStatus::from_raw(6), "memory allocation of 5 bytes failed")
        else {
            panic!("an abort is a fault")
        };
        assert_eq!(fault, Fault::Memory);
        let Outcome::Broken(fault, what) = fault_of(ExitStatus::from_raw(11), "") else {
            panic!("so is a crash")
        };
        assert_eq!(fault, Fault::Abort);
        assert!(what.contains("signal: 11"), "{what}");
    }
}
