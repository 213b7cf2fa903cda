//! Changes one place in a text of numbers, words and lines: TOML, RON, XML, JSON, whatever has them.

use std::ops::Range;

use super::random::Random;

/// Numbers that a reader may not expect where it reads one.
const NUMBERS: [&str; 22] = [
    "0",
    "-1",
    "-0.0",
    "0.5",
    "1e39",
    "1e308",
    "1e-320",
    "nan",
    "inf",
    "-inf",
    "NaN",
    "18446744073709551616",
    "9223372036854775807",
    "-9223372036854775808",
    "4294967296",
    "1000000000000",
    "1000000000",
    "100000",
    "65536",
    "",
    "x",
    "[100000, 100000]",
];

/// The text with one place changed.
pub fn mutated(text: &str, random: &mut Random) -> String {
    match random.below(8) {
        0..3 => replace_number(text, random),
        3 => swap(text, &numbers(text), random),
        4 => swap(text, &strings(text), random),
        5 => replace_string(text, random),
        6 => edit_line(text, random),
        _ => insert(text, random),
    }
}

/// Another string than the given one: long, empty, a path, control characters, or nearly the same.
pub fn hostile_string(text: &str, random: &mut Random) -> String {
    match random.below(8) {
        0 => String::new(),
        1 => "long".repeat(25_000),
        2 => "\u{1b}[31mred\u{1b}[0m\u{7}\r\n\u{0}".to_owned(),
        3 => "../../../../../../etc/passwd".to_owned(),
        4 => "/dev/zero".to_owned(),
        5 => format!("{text}x"),
        6 => text.chars().rev().collect(),
        _ => "\u{202e}\u{fffd}\u{1f9b6}".repeat(3),
    }
}

fn replace_number(text: &str, random: &mut Random) -> String {
    let number = random.one_of(&NUMBERS);
    replace(text, &numbers(text), number, random)
}

fn replace_string(text: &str, random: &mut Random) -> String {
    let strings = strings(text);
    let string = hostile_string("walk", random);
    replace(text, &strings, &string, random)
}

fn replace(text: &str, places: &[Range<usize>], with: &str, random: &mut Random) -> String {
    if places.is_empty() {
        return format!("{text}{with}");
    }
    let place = &places[random.below(places.len())];
    format!("{}{with}{}", &text[..place.start], &text[place.end..])
}

/// Swaps two of the places.
fn swap(text: &str, places: &[Range<usize>], random: &mut Random) -> String {
    if places.len() < 2 {
        return insert(text, random);
    }
    let mut pair = [random.below(places.len()), random.below(places.len())];
    pair.sort_unstable();
    if pair[0] == pair[1] {
        return edit_line(text, random);
    }
    let [first, second] = pair.map(|index| places[index].clone());
    let (between, after) = (&text[first.end..second.start], &text[second.end..]);
    [&text[..first.start], &text[second], between, &text[first], after].concat()
}

fn edit_line(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
    if lines.is_empty() {
        return insert(text, random);
    }
    let (one, two) = (random.below(lines.len()), random.below(lines.len()));
    match random.below(4) {
        0 => drop(lines.remove(one)),
        1 => lines.insert(two, lines[one]),
        2 => lines.swap(one, two),
        _ => {
            let copies = ((2 << 20) / (lines[one].len() + 1)).min(50_000);
            lines.splice(one..one, std::iter::repeat_n(lines[one], copies).collect::<Vec<_>>());
        }
    }
    lines.concat()
}

/// Inserts something that no file of the format has there.
fn insert(text: &str, random: &mut Random) -> String {
    let mut at = random.below(text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let deep = random.one_of(&["[", "(", "{\"a\":", "<body>", "[["]).repeat(50_000);
    let inserted = match random.below(5) {
        0 => deep.as_str(),
        1 => "\0",
        2 => "\u{1b}[2J",
        3 => "<include file=\"/etc/passwd\"/>",
        _ => "\"",
    };
    format!("{}{inserted}{}", &text[..at], &text[at..])
}

/// Where numbers stand.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let is_part = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'_' | b'e' | b'-' | b'+');
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let after_word = at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_');
        let signed = bytes[at] == b'-' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit);
        if after_word || !(bytes[at].is_ascii_digit() || signed) {
            at += 1;
            continue;
        }
        let length = bytes[at..].iter().take_while(|byte| is_part(**byte)).count();
        found.push(at..at + length);
        at += length;
    }
    found
}

/// Where the insides of quoted strings stand.
fn strings(text: &str) -> Vec<Range<usize>> {
    let quotes: Vec<usize> = text.match_indices('"').map(|(at, _)| at).collect();
    quotes.chunks_exact(2).map(|pair| pair[0] + 1..pair[1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_strings_are_found() {
        let text = "speed = -1.5e3 # m2\nname = \"walk\" x=[1, 22]";
        let of = |ranges: Vec<Range<usize>>| ranges.into_iter().map(|r| &text[r]).collect::<Vec<_>>();
        assert_eq!(of(numbers(text)), ["-1.5e3", "1", "22"]);
        assert_eq!(of(strings(text)), ["walk"]);
    }

    #[test]
    fn two_places_change_their_values() {
        let text = "a = 1\nb = 22\n";
        let swapped = (0..50).map(|seed| swap(text, &numbers(text), &mut Random::new(seed)));
        assert!(swapped.into_iter().any(|text| text == "a = 22\nb = 1\n"));
    }

    #[test]
    fn a_text_without_numbers_or_with_long_characters_is_no_trouble() {
        for seed in 0..200 {
            for text in ["", "\u{e4}\u{1f9b6}\u{e4}", "\"", "5"] {
                mutated(text, &mut Random::new(seed));
            }
        }
    }
}
