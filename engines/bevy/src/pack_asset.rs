//! Character packs as assets.

use std::sync::Arc;

use bevy::asset::io::Reader;
use bevy::asset::{Asset, AssetLoader, LoadContext};
use bevy::reflect::TypePath;
use policy_core::{CharacterPack, PackError};

/// A character pack that was loaded, shared by all its characters.
///
/// Files end in `.pack.safetensors`. A game that has the bytes adds the asset itself:
/// `assets.add(PackAsset::from_bytes(bytes)?)`.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct PackAsset {
    /// The pack.
    pub pack: Arc<CharacterPack>,
}

impl PackAsset {
    /// Reads a pack.
    ///
    /// # Errors
    /// When the bytes are no pack; see [`PackError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PackError> {
        Ok(Self { pack: Arc::new(CharacterPack::from_bytes(bytes)?) })
    }
}

/// Loads [`PackAsset`]s.
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct PackLoader;

/// Why a pack can't be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackLoadError {
    /// The file can't be read.
    #[error("expected a readable file, found: {0}")]
    Read(#[from] std::io::Error),
    /// The file is no pack.
    #[error(transparent)]
    Pack(#[from] PackError),
}

impl AssetLoader for PackLoader {
    type Asset = PackAsset;
    type Settings = ();
    type Error = PackLoadError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        _context: &mut LoadContext<'_>,
    ) -> Result<PackAsset, PackLoadError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(PackAsset::from_bytes(&bytes)?)
    }

    fn extensions(&self) -> &[&str] {
        &["pack.safetensors"]
    }
}
