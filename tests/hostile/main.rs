//! Reads hostile files for `cargo xtask hostile`, one process for many files.
//!
//! `hostile-reader seeds FOLDER` writes sound files, a folder for each reader. `hostile-reader read NAME` reads a
//! path a line on stdin and answers `accepted KILOBYTES` or `refused KILOBYTES MESSAGE`: the most memory that the
//! process has used for that file, and the error with its control characters escaped. It catches no panic: the harness
//! sees the process end and starts another.

mod readers;
mod seeds;

use std::io::{BufRead, Write};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["seeds", folder] => seeds::write(Path::new(folder)),
        ["read", name] => match readers::ALL.iter().find(|(known, _)| *known == name) {
            Some((_, read)) => serve(*read),
            None => return usage(),
        },
        _ => return usage(),
    }
    ExitCode::SUCCESS
}

fn usage() -> ExitCode {
    let names: Vec<&str> = readers::ALL.iter().map(|(name, _)| *name).collect();
    eprintln!("usage: hostile-reader seeds FOLDER | read NAME\nnames: {}", names.join(", "));
    ExitCode::FAILURE
}

fn serve(read: readers::Read) {
    let mut out = std::io::stdout();
    for path in std::io::stdin().lock().lines().map_while(Result::ok) {
        reset_peak();
        let answer = read(Path::new(&path));
        let peak = peak_kilobytes();
        let line = match answer {
            Ok(()) => format!("accepted {peak}"),
            Err(message) => format!("refused {peak} {}", message.escape_debug()),
        };
        if writeln!(out, "{line}").and_then(|()| out.flush()).is_err() {
            return;
        }
    }
}

/// Forgets the most memory used so far, where the system can (Linux).
fn reset_peak() {
    // Without it the peak is that of all files so far, which is still a bound.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Most memory used since, in kilobytes; 0 where the system does not tell.
fn peak_kilobytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}
