//! What the program prints. Output that can't be written is an error, not a panic, and text from files can't take over the
//! terminal.

use std::fmt::{Display, Write as _};
use std::io::Write as _;

use anyhow::{Context, Result};

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
    let _ = writeln!(std::io::stderr().lock(), "trainer: {}", printable(&format!("{message:#}")));
}

/// A message without control characters and of a sensible length.
fn printable(message: &str) -> String {
    let mut text = String::new();
    let mut characters = message.chars();
    for character in characters.by_ref().take(MOST_CHARACTERS) {
        if character.is_control() && character != '\n' {
            let _ = write!(text, "{}", character.escape_default());
        } else {
            text.push(character);
        }
    }
    if characters.next().is_some() {
        text.push_str(" [cut]");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_cut_and_control_characters_escaped() {
        assert_eq!(printable("a\u{1b}[2J\u{7}b\nc"), "a\\u{1b}[2J\\u{7}b\nc");
        let long = printable(&"x".repeat(100_000));
        assert!(long.len() < 2100 && long.ends_with("[cut]"));
    }
}
