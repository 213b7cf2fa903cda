//! Files that are there whole or not at all, and reads that stop at a bound.

use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Ending of files that are still being written.
pub const PARTIAL: &str = "partial";

/// Writes a file so that readers find the old file or the new one, never a part of either.
///
/// The data goes to a file of a unique name in the same folder. File and folder are synchronised with the disk. The
/// unfinished file is removed when anything fails.
///
/// # Errors
/// When the folder can't be written or the disk is full.
pub fn write_atomically(path: &Path, data: &[u8]) -> io::Result<()> {
    write_moving(path, data, None)
}

/// As [`write_atomically`], and moves the file that was there before to `previous` first.
///
/// At every moment one of the two is whole.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_keeping_previous(path: &Path, previous: &Path, data: &[u8]) -> io::Result<()> {
    write_moving(path, data, Some(previous))
}

fn write_moving(path: &Path, data: &[u8], previous: Option<&Path>) -> io::Result<()> {
    let unfinished = Unfinished(unique_beside(path));
    let mut file = File::create_new(&unfinished.0)?;
    file.write_all(data)?;
    file.sync_all()?;
    drop(file);
    if let Some(previous) = previous
        && path.exists()
    {
        std::fs::rename(path, previous)?;
    }
    std::fs::rename(&unfinished.0, path)?;
    sync_folder(path)
}

/// A file that is removed with its owner; after a rename there is nothing to remove.
struct Unfinished(PathBuf);

impl Drop for Unfinished {
    fn drop(&mut self) {
        // The error that led here is reported; a file that can't be removed adds nothing to it.
        let _ = std::fs::remove_file(&self.0);
    }
}

/// A name in the same folder that no other call and no other process uses.
fn unique_beside(path: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    path.with_file_name(format!(".{name}.{}-{count}.{PARTIAL}", std::process::id()))
}

/// Makes a rename last: the entry of the folder is on disk when this returns.
fn sync_folder(path: &Path) -> io::Result<()> {
    // Only Unix can open a folder as a file; elsewhere the file system keeps the order of renames.
    if cfg!(unix) {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

/// Removes unfinished files that a crash left in a folder. The caller must hold the folder's lock.
///
/// # Errors
/// When the folder can't be read or a file can't be removed.
pub fn remove_unfinished(folder: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == PARTIAL) {
            std::fs::remove_file(path)?;
        }
    }
    Ok(())
}

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

impl From<ReadError> for io::Error {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Io(error) => error,
            other => invalid(other.to_string()),
        }
    }
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
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_file() {
        return Ok(());
    }
    Err(ReadError::NotRegular { found: if kind.is_dir() { "a folder" } else { "a pipe or device" } })
}

/// As [`read`], with an error of the system.
///
/// # Errors
/// As [`read`]; what is wrong with the file is [`io::ErrorKind::InvalidData`].
pub fn read_bounded(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read(path, most).map_err(io::Error::from)
}

/// Reads a text of at most `most` bytes.
///
/// # Errors
/// As [`read_bounded`], or when it is no UTF-8.
pub fn read_text_bounded(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read_bounded(path, most)?).map_err(|_| invalid("expected UTF-8".to_owned()))
}

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writers_of_one_file_do_not_meet() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        std::thread::scope(|scope| {
            for byte in 0..4_u8 {
                let path = &path;
                scope.spawn(move || {
                    for _ in 0..25 {
                        write_atomically(path, &vec![byte; 100_000]).unwrap();
                        let found = std::fs::read(path).unwrap();
                        assert!(found.len() == 100_000 && found.iter().all(|b| *b == found[0]));
                    }
                });
            }
        });
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no unfinished file is left");
    }

    #[test]
    fn the_file_before_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let (path, previous) = (folder.path().join("a"), folder.path().join("b"));
        for text in ["one", "two", "three"] {
            write_keeping_previous(&path, &previous, text.as_bytes()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "three");
        assert_eq!(std::fs::read_to_string(&previous).unwrap(), "two");
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        // A folder stands where the file is to go.
        let path = folder.path().join("a");
        std::fs::create_dir(&path).unwrap();
        std::fs::write(path.join("inside"), "x").unwrap();
        assert!(write_atomically(&path, b"y").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write_atomically(&folder.path().join("none/a"), b"y").is_err());
    }

    #[test]
    fn what_a_crash_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        for name in [".a.7-0.partial", "checkpoint.partial", "kept"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        remove_unfinished(folder.path()).unwrap();
        let left: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["kept"]);
    }

    #[test]
    fn reads_are_bounded() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(read_bounded(&path, 5).unwrap(), b"12345");
        assert!(read_bounded(&path, 4).unwrap_err().to_string().contains("at most 4"));
        assert!(read_bounded(folder.path(), 9).is_err());
        if cfg!(unix) {
            assert!(read_bounded(Path::new("/dev/zero"), 9).unwrap_err().to_string().contains("regular"));
        }
    }

    #[test]
    fn folders_devices_and_large_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let found = read(folder.path(), 10).unwrap_err().to_string();
        assert!(found.contains("expected a regular file, found a folder"), "{found}");
        let path = folder.path().join("x");
        std::fs::write(&path, [0; 11]).unwrap();
        let found = read(&path, 10).unwrap_err().to_string();
        assert!(found.contains("at most 10 bytes, found 11"), "{found}");
        assert_eq!(read(&path, 11).unwrap(), [0; 11]);
        if cfg!(unix) {
            let found = read(Path::new("/dev/zero"), 10).unwrap_err().to_string();
            assert!(found.contains("found a pipe or device"), "{found}");
        }
    }
}
