//! Files as the demo reads and writes them: regular files of a bounded size are read, and a file is written whole
//! or not at all.

use std::fs::{self, File};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Why a file can't be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The system can't read it.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// It is a folder, a pipe or a device.
    #[error("expected a regular file, found {found}")]
    NotRegular {
        /// What it is.
        found: &'static str,
    },
    /// It is too large.
    #[error("expected at most {most} bytes, found {found}")]
    TooLarge {
        /// The limit.
        most: u64,
        /// Its size, or what was read before the reading stopped.
        found: u64,
    },
}

/// Reads a regular file of at most `most` bytes. Nothing is allocated for a larger one, and a pipe is not waited
/// for.
///
/// # Errors
/// [`ReadError`] when it is no regular file, is larger, or can't be read.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    check_regular(path)?;
    let file = File::open(path)?;
    let found = file.metadata()?.len();
    if found > most {
        return Err(ReadError::TooLarge { most, found });
    }
    let mut bytes = Vec::with_capacity(found as usize);
    // A file may grow while it is read, and those of /proc say that they are empty.
    file.take(most + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 {
        found if found > most => Err(ReadError::TooLarge { most, found }),
        _ => Ok(bytes),
    }
}

/// Refuses folders, pipes and devices without opening them.
///
/// # Errors
/// [`ReadError::NotRegular`] for those, [`ReadError::Io`] when there is nothing.
pub fn check_regular(path: &Path) -> Result<(), ReadError> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_file() {
        return Ok(());
    }
    Err(ReadError::NotRegular { found: if kind.is_dir() { "a folder" } else { "a pipe or device" } })
}

/// Writes a file, with its folder. The bytes go to a file beside it first, which then takes its name: after an
/// error the file is as it was. A device, such as `/dev/stdout`, is written to directly.
///
/// # Errors
/// When the folder can't be made or the file can't be written.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        return File::options().write(true).open(path)?.write_all(bytes);
    }
    // What a link points to is replaced, not the link.
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let partial = partial(&path);
    let written = File::create(&partial)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&partial, &path));
    if written.is_err() {
        // The first error is the one to be told.
        let _ = fs::remove_file(&partial);
    }
    written
}

/// A name beside `path` that no other process and no other call uses.
fn partial(path: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".{}-{}.partial", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_devices_and_large_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let found = read(folder.path(), 10).unwrap_err().to_string();
        assert!(found.contains("expected a regular file, found a folder"), "{found}");
        let path = folder.path().join("x");
        fs::write(&path, [0; 11]).unwrap();
        let found = read(&path, 10).unwrap_err().to_string();
        assert!(found.contains("at most 10 bytes, found 11"), "{found}");
        assert_eq!(read(&path, 11).unwrap(), [0; 11]);
        if cfg!(unix) {
            let found = read(Path::new("/dev/zero"), 10).unwrap_err().to_string();
            assert!(found.contains("found a pipe or device"), "{found}");
        }
    }

    #[test]
    fn a_file_is_replaced_whole_and_its_folder_is_made() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b.json");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
        // What can't be replaced stays, and nothing is left beside it.
        assert!(write(&path.join("c"), b"three").is_err());
        assert_eq!(fs::read(&path).unwrap(), b"two");
    }
}
