//! What is remembered from run to run: panels, toggles, presets. A file of RON with a version.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{PanelKind, Preferences, Preset, Side};
use crate::camera::CameraMode;
use crate::files;
use crate::scene_setup::Shown;

/// Version of the file.
pub const LAYOUT_VERSION: u32 = 1;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// What is remembered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PanelLayout {
    /// [`LAYOUT_VERSION`].
    pub version: u32,
    /// Open panels from top to bottom, each with its side.
    pub open: Vec<(PanelKind, Side)>,
    /// All panels hidden: for this run only. Older files have it.
    #[serde(default, skip_serializing)]
    pub hidden: bool,
    /// What is shown besides the characters.
    pub shown: Shown,
    /// How the camera moves.
    pub camera: CameraMode,
    /// Blends per layer.
    pub presets: Vec<Preset>,
    /// What the player has chosen once and for all.
    #[serde(default)]
    pub preferences: Preferences,
}

impl Default for PanelLayout {
    fn default() -> Self {
        Self {
            version: LAYOUT_VERSION,
            open: vec![
                (PanelKind::Paths, Side::Left),
                (PanelKind::Graph, Side::Left),
                (PanelKind::Skills, Side::Left),
                (PanelKind::Physics, Side::Right),
                (PanelKind::Profiler, Side::Right),
            ],
            hidden: false,
            shown: Shown::default(),
            camera: CameraMode::default(),
            presets: Vec::new(),
            preferences: Preferences::default(),
        }
    }
}

/// Why a layout can't be read or written. The demo then uses the default.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// The file can't be read or written.
    #[error("layout {}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: files::ReadError,
    },
    /// The text is no layout.
    #[error("layout {}: {message}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// Where and what.
        message: String,
    },
    /// A layout of another version of the demo.
    #[error("layout {}: expected version {LAYOUT_VERSION}, found {found}", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
}

/// The version alone, whatever else there is.
#[derive(Deserialize)]
struct Versioned {
    version: u32,
}

impl PanelLayout {
    /// Where the user's layout is kept; `None` when the system names no such place.
    #[must_use]
    pub fn home() -> Option<PathBuf> {
        // A variable that is set to nothing counts as not set.
        let folder = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let base = folder("XDG_CONFIG_HOME")
            .or_else(|| folder("APPDATA"))
            .or_else(|| folder("HOME").map(|home| home.join(".config")))?;
        Some(base.join("policy-space").join("layout.ron"))
    }

    /// Reads a layout; the default when there is no file.
    ///
    /// # Errors
    /// When the file can't be read, is no layout, or is of another version.
    pub fn load(path: &Path) -> Result<Self, LayoutError> {
        let file = |source| LayoutError::File { path: path.to_owned(), source };
        if !path.exists() {
            return Ok(Self::default());
        }
        Self::from_bytes(path, &files::read(path, MOST_BYTES).map_err(file)?)
    }

    /// Reads a layout that is to be written again. One that can't be read is copied aside first, so that nothing of it is lost. The second
    /// value says so; the third is false where it could not be copied: then nothing must be written.
    #[must_use]
    pub fn load_or_keep_aside(path: &Path) -> (Self, Option<String>, bool) {
        let error = match Self::load(path) {
            Ok(layout) => return (layout, None, true),
            Err(error) => error,
        };
        let (said, kept) = files::keep_unreadable(path, &error, "Settings");
        (Self::default(), Some(said), kept)
    }

    /// Reads the bytes of a layout; `path` is only named in errors.
    ///
    /// # Errors
    /// When they are no layout, or one of another version.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, LayoutError> {
        let text = |message| LayoutError::Text { path: path.to_owned(), message };
        let content = std::str::from_utf8(bytes).map_err(|e| text(e.to_string()))?;
        let versioned: Versioned = ron::from_str(content).map_err(|e| text(e.to_string()))?;
        if versioned.version != LAYOUT_VERSION {
            return Err(LayoutError::Version { path: path.to_owned(), found: versioned.version });
        }
        let layout: Self = ron::from_str(content).map_err(|e| text(e.to_string()))?;
        Ok(Self { preferences: layout.preferences.clamped(), hidden: false, ..layout })
    }

    /// Writes the layout, with its folder.
    ///
    /// # Errors
    /// When that fails.
    pub fn save(&self, path: &Path) -> Result<(), LayoutError> {
        let content = self
            .to_text()
            .map_err(|e| LayoutError::Text { path: path.to_owned(), message: e.to_string() })?;
        files::write(path, content.as_bytes())
            .map_err(|source| LayoutError::File { path: path.to_owned(), source: source.into() })
    }

    /// The text of a file.
    ///
    /// # Errors
    /// When a preset can't be written as RON.
    pub fn to_text(&self) -> Result<String, ron::Error> {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::default())
    }

    /// The side of an open panel.
    #[must_use]
    pub fn side_of(&self, kind: PanelKind) -> Option<Side> {
        self.open.iter().find(|(open, _)| *open == kind).map(|(_, side)| *side)
    }

    /// Opens or closes a panel. It opens on the emptier side.
    pub fn toggle(&mut self, kind: PanelKind) {
        if self.side_of(kind).is_some() {
            self.open.retain(|(open, _)| *open != kind);
            return;
        }
        let left = self.open.iter().filter(|(_, side)| *side == Side::Left).count();
        let side = if 2 * left > self.open.len() { Side::Right } else { Side::Left };
        self.open.push((kind, side));
    }

    /// Moves an open panel to the other side.
    pub fn swap_side(&mut self, kind: PanelKind) {
        for (open, side) in &mut self.open {
            if *open == kind {
                *side = if *side == Side::Left { Side::Right } else { Side::Left };
            }
        }
    }
}

/// A layout that is written whenever it has changed, so that nothing is lost when the program is killed.
#[derive(Clone, Debug)]
pub struct KeptLayout {
    path: PathBuf,
    kept: PanelLayout,
}

impl KeptLayout {
    /// Keeps changes from `layout` on in the file `path`.
    #[must_use]
    pub fn new(path: PathBuf, layout: &PanelLayout) -> Self {
        Self { path, kept: layout.clone() }
    }

    /// Writes `layout` when it has changed since the last call.
    ///
    /// # Errors
    /// When it can't be written. The next change is tried again.
    pub fn keep(&mut self, layout: &PanelLayout) -> Result<(), LayoutError> {
        if *layout == self.kept {
            return Ok(());
        }
        self.kept = layout.clone();
        layout.save(&self.path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_comes_back_as_it_was_saved() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a").join("layout.ron");
        let mut layout = PanelLayout::default();
        layout.toggle(PanelKind::Analysis);
        layout.swap_side(PanelKind::Paths);
        layout.presets.push(Preset {
            name: "x".into(),
            from: "a".into(),
            to: "b".into(),
            t: [0.0, 0.5, 1.0],
        });
        layout.save(&path).unwrap();
        assert_eq!(PanelLayout::load(&path).unwrap(), layout);
    }

    #[test]
    fn a_change_is_written_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("layout.ron");
        let mut layout = PanelLayout::default();
        let mut kept = KeptLayout::new(path.clone(), &layout);
        kept.keep(&layout).unwrap();
        assert!(!path.exists(), "nothing has changed");
        layout.presets.push(Preset { name: "x".into(), from: "a".into(), to: "b".into(), t: [0.5; 3] });
        kept.keep(&layout).unwrap();
        assert_eq!(PanelLayout::load(&path).unwrap(), layout);
    }

    #[test]
    fn a_layout_from_before_the_preferences_still_loads() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("layout.ron");
        let old = "(version: 1, open: [(Graph, Right)], hidden: true, shown: (), camera: Chase, presets: [])";
        std::fs::write(&path, old).unwrap();
        let layout = PanelLayout::load(&path).unwrap();
        assert_eq!((layout.camera, layout.preferences), (CameraMode::Chase, Preferences::default()));
        assert!(!layout.hidden, "a start without panels looks broken");
        layout.save(&path).unwrap();
        assert!(!std::fs::read_to_string(&path).unwrap().contains("hidden"));
        std::fs::write(&path, old.replace("presets: []", "presets: [], preferences: (ui_scale: 1e9)"))
            .unwrap();
        assert_eq!(PanelLayout::load(&path).unwrap().preferences.ui_scale, 2.0);
    }

    #[test]
    fn a_layout_that_cannot_be_read_is_kept_beside_the_new_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("layout.ron");
        assert_eq!(PanelLayout::load_or_keep_aside(&path), (PanelLayout::default(), None, true));
        std::fs::write(&path, "(version: 99, presets: [])").unwrap();
        let (mut layout, said, kept) = PanelLayout::load_or_keep_aside(&path);
        assert!(kept && said.unwrap().contains("layout.ron.bad"));
        let mut file = KeptLayout::new(path.clone(), &layout);
        layout.preferences.advanced = true;
        file.keep(&layout).unwrap();
        assert_eq!(PanelLayout::load(&path).unwrap(), layout);
        let aside = std::fs::read_to_string(folder.path().join("layout.ron.bad")).unwrap();
        assert_eq!(aside, "(version: 99, presets: [])");
        // What can't be copied must not be written over.
        assert!(!PanelLayout::load_or_keep_aside(folder.path()).2);
    }

    #[test]
    fn another_version_and_nonsense_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("layout.ron");
        assert_eq!(PanelLayout::load(&path).unwrap(), PanelLayout::default());
        std::fs::write(&path, "(version: 99, docks: [])").unwrap();
        let error = PanelLayout::load(&path).unwrap_err().to_string();
        assert!(error.contains("layout.ron") && error.contains("expected version 1, found 99"), "{error}");
        std::fs::write(&path, "(version: 1, oben: 3)").unwrap();
        assert!(matches!(PanelLayout::load(&path), Err(LayoutError::Text { .. })));
        std::fs::write(&path, [0xff, 0xfe, 0]).unwrap();
        assert!(matches!(PanelLayout::load(&path), Err(LayoutError::Text { .. })));
        assert!(matches!(PanelLayout::load(folder.path()), Err(LayoutError::File { .. })));
    }
}
