//! Reading a character pack that somebody names at the command line.

use std::path::Path;

use anyhow::{Context, Result};
use files::read_bounded;
use policy_core::CharacterPack;
use policy_core::format::MAX_PACK_BYTES;

use super::output::complain;

/// The pack in a file. Says so when the file has no checksum, since damage to it then goes unnoticed.
///
/// # Errors
/// When the file can't be read, is larger than a pack may be, or is no pack.
pub(crate) fn pack(path: &Path) -> Result<CharacterPack> {
    let bytes = read_bounded(path, MAX_PACK_BYTES as u64)
        .with_context(|| format!("cannot read {}", path.display()))?;
    let pack = CharacterPack::from_bytes(&bytes).with_context(|| path.display().to_string())?;
    if !pack.is_verified() {
        complain(&format!(
            "{}: the pack has no checksum; damage to the file would go unnoticed",
            path.display()
        ));
    }
    Ok(pack)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_pack_is_refused_with_the_name_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("torn.pack");
        std::fs::write(&path, b"not a pack").unwrap();
        let error = format!("{:#}", pack(&path).unwrap_err());
        assert!(error.contains("torn.pack"), "{error}");
        let error = format!("{:#}", pack(folder.path()).unwrap_err());
        assert!(error.contains("cannot read"), "{error}");
    }
}
