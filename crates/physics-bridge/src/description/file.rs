//! Files from strangers: read up to a bound, and quoted so that a message stays short and plain.

use std::fs::File;
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

/// Longest quotation from a file in a message, characters.
const QUOTED: usize = 300;

/// Reads a regular file of at most so many bytes. Pipes, devices and folders are refused without reading.
pub(crate) fn read(path: &Path, most: usize) -> Result<Vec<u8>, Error> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "expected a regular file, found something else"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > most {
        return Err(Error::new(ErrorKind::InvalidData, format!("expected at most {most} bytes, found more")));
    }
    Ok(bytes)
}

/// The beginning of a text from a file, on one line, without control characters.
pub(crate) fn quoted(text: &str) -> String {
    let mut words = String::new();
    for word in text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty()) {
        if !words.is_empty() {
            words.push(' ');
        }
        words.push_str(word);
        if let Some((end, _)) = words.char_indices().nth(QUOTED) {
            words.truncate(end);
            words.push('…');
            break;
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotations_are_short_and_plain() {
        assert_eq!(quoted("a\x1b[2Jb\0 \n\t c\u{9b}d"), "a [2Jb c d");
        assert_eq!(quoted(&"x".repeat(5000)).chars().count(), QUOTED + 1);
        assert!(quoted(&"x y ".repeat(5000)).chars().count() <= QUOTED + 1);
    }

    #[test]
    fn only_regular_files_of_a_sensible_length_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, [7; 100]).unwrap();
        assert_eq!(read(&path, 100).unwrap(), [7; 100]);
        assert!(read(&path, 99).unwrap_err().to_string().contains("99 bytes"));
        assert!(read(folder.path(), 100).unwrap_err().to_string().contains("regular file"));
        #[cfg(unix)]
        assert!(read(Path::new("/dev/zero"), 100).unwrap_err().to_string().contains("regular file"));
    }
}
