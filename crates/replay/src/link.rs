//! A replay as text for a link: base64url without padding.

use crate::error::ReplayError;
use crate::header::Replay;

/// Longest link. Browsers and chat programs take this much in a URL's fragment.
pub const MOST_LINK_CHARS: usize = 16_000;

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

impl Replay {
    /// Its bytes as base64url, for the fragment of a URL.
    ///
    /// # Errors
    /// When that is longer than [`MOST_LINK_CHARS`].
    pub fn to_link(&self) -> Result<String, ReplayError> {
        let link = encode(&self.to_bytes());
        match link.len() {
            0..=MOST_LINK_CHARS => Ok(link),
            found => Err(ReplayError::LongLink { most: MOST_LINK_CHARS, found }),
        }
    }

    /// Reads what [`Replay::to_link`] wrote.
    ///
    /// # Errors
    /// When the text is too long or no base64url, and as [`Replay::from_bytes`].
    pub fn from_link(link: &str) -> Result<Self, ReplayError> {
        if link.len() > MOST_LINK_CHARS {
            return Err(ReplayError::LongLink { most: MOST_LINK_CHARS, found: link.len() });
        }
        Self::from_bytes(&decode(link)?)
    }
}

fn encode(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits =
            group.iter().enumerate().fold(0u32, |bits, (i, &byte)| bits | u32::from(byte) << (16 - 8 * i));
        for i in 0..=group.len() {
            out.push(char::from(ALPHABET[(bits >> (18 - 6 * i)) as usize & 63]));
        }
    }
    out
}

fn decode(text: &str) -> Result<Vec<u8>, ReplayError> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut held) = (0u32, 0u32);
    for (at, found) in text.char_indices() {
        let value = match found {
            'A'..='Z' => found as u32 - 'A' as u32,
            'a'..='z' => found as u32 - 'a' as u32 + 26,
            '0'..='9' => found as u32 - '0' as u32 + 52,
            '-' => 62,
            '_' => 63,
            _ => return Err(ReplayError::Character { at, found }),
        };
        (bits, held) = (bits << 6 | value, held + 6);
        if held >= 8 {
            held -= 8;
            out.push((bits >> held) as u8);
            bits &= (1 << held) - 1;
        }
    }
    // What is left over of the last byte: less than a character, and zero.
    if held >= 6 || bits != 0 {
        return Err(ReplayError::LinkEnd { found: text.len() });
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_texts_are_met() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg"),
            ("fo", "Zm8"),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg"),
            ("\u{fb}\u{ff}", "w7vDvw"),
        ] {
            assert_eq!(encode(bytes.as_bytes()), text);
            assert_eq!(decode(text).unwrap(), bytes.as_bytes());
        }
    }

    #[test]
    fn what_is_no_base64url_is_refused() {
        assert_eq!(decode("Zg=="), Err(ReplayError::Character { at: 2, found: '=' }));
        assert_eq!(decode("Z/"), Err(ReplayError::Character { at: 1, found: '/' }));
        assert_eq!(decode("Zm9vY"), Err(ReplayError::LinkEnd { found: 5 }));
        assert_eq!(decode("Zh"), Err(ReplayError::LinkEnd { found: 2 }));
        let long = "A".repeat(MOST_LINK_CHARS + 1);
        assert!(matches!(Replay::from_link(&long), Err(ReplayError::LongLink { .. })));
    }
}
