//! Files as the demo reads and writes them: regular files of a bounded size are read, and a file is written whole
//! or not at all.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::Path;

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
}
