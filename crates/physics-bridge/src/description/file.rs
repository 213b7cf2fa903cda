//! Files from strangers: read up to a bound, and quoted so that a message stays short and plain. Files of our own: there
//! whole or not at all.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Longest quotation from a file in a message, characters.
const QUOTED: usize = 300;

/// Reads a regular file of at most so many bytes. Pipes, devices and folders are refused without reading.
pub(crate) fn read(path: &Path, most: usize) -> Result<Vec<u8>, Error> {
    if !fs::metadata(path)?.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "expected a regular file, found something else"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > most {
        return Err(Error::new(ErrorKind::InvalidData, format!("expected at most {most} bytes, found more")));
    }
    Ok(bytes)
}

/// Writes a file so that readers find the old one or the new one. The bytes go to a file of a unique name beside it,
/// which is removed when anything fails.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().ok_or_else(|| Error::new(ErrorKind::InvalidInput, "expected a file name"))?;
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let unfinished =
        path.with_file_name(format!(".{}.{}-{count}.partial", name.to_string_lossy(), std::process::id()));
    let written = File::create_new(&unfinished)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&unfinished, path));
    if written.is_err() {
        // The first error is the one to be told.
        let _ = fs::remove_file(&unfinished);
    }
    written
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
    fn a_file_is_written_whole_or_stays_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write_whole(&path, b"one").unwrap();
        write_whole(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        // A folder stands where the file is to go.
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert!(write_whole(&taken, b"three").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "nothing is left beside them");
        assert!(write_whole(Path::new("/"), b"").is_err());
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
