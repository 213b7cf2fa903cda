//! Opens files to read. Refuses pipes, devices and folders: reading a pipe can wait for ever.

use std::fs::File;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// Opens a regular file, or a link to one.
pub(crate) fn open_regular(path: &Path) -> Result<File> {
    // Checked before opening, because opening a pipe waits for its writer.
    if !std::fs::metadata(path)?.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "expected a regular file, found another kind"));
    }
    File::open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        std::fs::write(&file, "text").unwrap();
        assert!(open_regular(&file).is_ok());
        assert_eq!(open_regular(folder.path()).unwrap_err().kind(), ErrorKind::InvalidInput);
        assert_eq!(open_regular(&folder.path().join("b")).unwrap_err().kind(), ErrorKind::NotFound);
    }
}
