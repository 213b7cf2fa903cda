//! What the demo carries inside itself, so that it runs from any folder.

/// The humanoid as MJCF.
pub const HUMANOID_MJCF: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// The mannequin as glTF binary.
pub const HUMANOID_GLB: &[u8] =
    include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.glb"));
/// The character pack.
pub const HUMANOID_PACK: &[u8] =
    include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors"));
