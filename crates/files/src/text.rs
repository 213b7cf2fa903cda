//! Text of files in messages: short, and without characters that a terminal obeys.

use std::fmt::Write as _;

/// Longest quotation of a file in an error, characters.
const MOST_QUOTED: usize = 500;

/// A quotation of a file for an error.
#[must_use]
pub fn quoted(text: &str) -> String {
    printable(text, MOST_QUOTED)
}

/// A text with control characters escaped but for line ends, and cut after so many characters.
#[must_use]
pub fn printable(text: &str, most: usize) -> String {
    let mut shown = String::new();
    let mut characters = text.chars();
    for character in characters.by_ref().take(most) {
        if character.is_control() && character != '\n' {
            let _ = write!(shown, "{}", character.escape_default());
        } else {
            shown.push(character);
        }
    }
    if characters.next().is_some() {
        shown.push_str(" [cut]");
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_cut_and_control_characters_escaped() {
        assert_eq!(quoted("a\u{1b}[2J\u{7}b\nc"), "a\\u{1b}[2J\\u{7}b\nc");
        let long = printable(&"x".repeat(100_000), 2000);
        assert!(long.len() < 2100 && long.ends_with("[cut]"));
    }
}
