//! Text of files in messages: short, and without characters that a terminal would act on.

use alloc::string::String;
use core::fmt::{Display, Write};

/// Most characters of a file in one message.
const LONGEST: usize = 160;

/// At most 160 characters of a text, control characters escaped.
pub(crate) fn excerpt(text: impl Display) -> String {
    let whole = alloc::format!("{text}");
    let mut out = String::new();
    for (count, c) in whole.chars().enumerate() {
        if count == LONGEST {
            out.push_str(" ...");
            break;
        }
        if c.is_control() {
            write!(out, "{}", c.escape_default()).expect("a string takes any text");
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_cut_and_control_characters_escaped() {
        assert_eq!(excerpt("a\u{1b}[2J\nb"), "a\\u{1b}[2J\\nb");
        assert_eq!(excerpt("x".repeat(1000)).len(), LONGEST + 4);
        assert_eq!(excerpt("ü".repeat(160)), "ü".repeat(160));
    }
}
