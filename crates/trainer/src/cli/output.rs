//! What the program prints. Output that can't be written is an error, not a panic, and text from files can't take over the
//! terminal.

use std::fmt::Display;
use std::io::Write as _;

use anyhow::{Context, Result};
use files::printable;

/// Longest message, characters.
const MOST_CHARACTERS: usize = 2000;

/// Prints a line to the standard output.
///
/// # Errors
/// When it can't be written, as on a full disk.
pub(crate) fn say(text: impl Display) -> Result<()> {
    writeln!(std::io::stdout().lock(), "{text}").context("cannot write to the standard output")
}

/// Prints a message to the standard error, with the whole chain of causes of an error.
pub(crate) fn complain(message: &(impl Display + ?Sized)) {
    // Where this can't be written either, only the exit code is left.
    let _ = writeln!(
        std::io::stderr().lock(),
        "trainer: {}",
        printable(&format!("{message:#}"), MOST_CHARACTERS)
    );
}
