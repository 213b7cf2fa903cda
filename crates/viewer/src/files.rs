//! Files as the demo reads and writes them: regular files of a bounded size are read, and a file is written whole
//! or not at all.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use ::files::write_atomically;
pub use ::files::{ReadError, check_regular, read};

/// Writes a file, with its folder. After an error the file is as it was. A device, such as `/dev/stdout`, is written
/// to directly.
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
    write_atomically(&path, bytes)
}

/// Copies a file that can't be read as what it should be to a name ending in `.bad` beside it, before it is replaced; returns that name. An
/// earlier copy is overwritten.
///
/// # Errors
/// When it is no regular file or can't be copied.
fn keep_aside(path: &Path) -> io::Result<PathBuf> {
    check_regular(path).map_err(io::Error::other)?;
    let mut name = path.as_os_str().to_owned();
    name.push(".bad");
    let aside = PathBuf::from(name);
    fs::copy(path, &aside)?;
    Ok(aside)
}

/// Keeps a file aside that can't be read for this `error`. What to tell the player, and false where it could not be copied: then
/// `what` must not be written.
pub fn keep_unreadable(path: &Path, error: &dyn std::error::Error, what: &str) -> (String, bool) {
    match keep_aside(path) {
        Ok(aside) => (format!("{error}. The old file is kept as {}.", aside.display()), true),
        Err(_) => (format!("{error}. {what} are not saved in this run."), false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn a_file_is_kept_aside_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("layout.ron");
        assert!(keep_aside(&path).is_err() && keep_aside(folder.path()).is_err());
        fs::write(&path, "nonsense").unwrap();
        let aside = keep_aside(&path).unwrap();
        assert_eq!(aside, folder.path().join("layout.ron.bad"));
        assert_eq!(
            (fs::read(&path).unwrap(), fs::read(&aside).unwrap()),
            (b"nonsense".into(), b"nonsense".into())
        );
    }
}
