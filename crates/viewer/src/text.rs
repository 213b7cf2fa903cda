//! Text that may come from a file, made fit to be shown.

/// At most so many characters of a text.
#[must_use]
pub fn cut(text: &str, most: usize) -> String {
    let head: String = text.chars().take(most).collect();
    if head.len() < text.len() { head + " ..." } else { head }
}

/// At most so many characters of a text, its control characters escaped: a terminal must not obey what a file
/// says. Line breaks stay.
#[must_use]
pub fn printable(text: &str, most: usize) -> String {
    let mut shown = String::with_capacity(text.len().min(most));
    for character in cut(text, most).chars() {
        if is_harmless(character) {
            shown.push(character);
        } else {
            shown.extend(character.escape_unicode());
        }
    }
    shown
}

/// False for control characters and for those that turn the direction of the text.
fn is_harmless(character: char) -> bool {
    let turns =
        matches!(character, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character == '\n' || !(character.is_control() || turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_and_long_texts_are_cut() {
        assert_eq!(printable("a\u{1b}[2Jb\nc", 100), "a\\u{1b}[2Jb\nc");
        assert_eq!(printable("\u{202e}gnp", 100), "\\u{202e}gnp");
        assert_eq!(printable(&"é".repeat(10), 3), "ééé ...");
        assert_eq!(printable("plain", 5), "plain");
    }
}
