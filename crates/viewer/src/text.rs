//! Text as it is shown: quotations of files made harmless, and numbers of things.

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

/// A name of a pack as it is shown: `idle_stop` reads `idle stop`.
#[must_use]
pub fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

/// A noun for so many things: `character` for one, `characters` for none or several.
#[must_use]
pub fn noun(number: u64, one: &str) -> String {
    format!("{one}{}", if number == 1 { "" } else { "s" })
}

/// A number of things: `1 fall`, `2 falls`.
#[must_use]
pub fn counted(number: u64, one: &str) -> String {
    format!("{number} {}", noun(number, one))
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

    #[test]
    fn one_thing_is_singular() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "fall")), ["0 falls", "1 fall", "2 falls"]);
        assert_eq!(noun(1, "character"), "character");
    }
}
