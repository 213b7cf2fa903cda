//! Files that are no ordinary files: a folder, a pipe, an endless device, an empty file, none at all.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::setup::remove_folder;
use crate::workspace::answers;

/// The kinds of special files.
pub const KINDS: [&str; 5] = ["missing", "empty", "folder", "endless", "pipe"];

/// Makes the special file number `case` below `folder`, under a folder of its kind so that it keeps the ending of `name`.
/// None when there are no more.
///
/// # Errors
/// When it cannot be made.
pub fn make(case: usize, folder: &Path, name: &OsStr) -> Result<Option<PathBuf>> {
    let Some(kind) = KINDS.get(case) else { return Ok(None) };
    let home = folder.join(kind);
    remove_folder(&home)?;
    fs::create_dir_all(&home).with_context(|| format!("create {}", home.display()))?;
    let path = home.join(name);
    let made = match *kind {
        "empty" => fs::write(&path, "").is_ok(),
        "folder" => fs::create_dir(&path).is_ok(),
        "endless" => endless(&path),
        "pipe" => answers(Command::new("mkfifo").arg(&path)),
        _ => true,
    };
    // Where the system has no pipes or devices, a missing file stands in for them.
    let _ = made;
    Ok(Some(path))
}

#[cfg(unix)]
fn endless(path: &Path) -> bool {
    std::os::unix::fs::symlink("/dev/zero", path).is_ok()
}

#[cfg(not(unix))]
fn endless(_: &Path) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn the_first_cases_are_special_and_no_others() {
        let folder = ScratchFolder::new("special");
        let name = OsStr::new("walk.ron");
        let of = |case| make(case, folder.path(), name).unwrap();
        assert!(!of(0).unwrap().exists());
        assert_eq!(fs::read(of(1).unwrap()).unwrap(), b"");
        assert!(of(2).unwrap().is_dir());
        assert!((0..5).all(|case| of(case).unwrap().ends_with("walk.ron")));
        assert!(of(5).is_none());
    }
}
