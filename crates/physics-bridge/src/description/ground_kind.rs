//! Grounds with a name, to choose from and to measure on.

use super::terrain::Terrain;

/// Kinds of ground that a character can walk over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundKind {
    /// A plane.
    #[default]
    Flat,
    /// Hills 0.35 m high, 9 m from crest to crest.
    Wavy,
    /// Broad flights of six steps up and six down, each 0.05 m high and 1.2 m deep.
    Steps,
}

impl GroundKind {
    /// All kinds.
    pub const ALL: [GroundKind; 3] = [GroundKind::Flat, GroundKind::Wavy, GroundKind::Steps];

    /// Name for command lines, panels and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            GroundKind::Flat => "flat",
            GroundKind::Wavy => "wavy",
            GroundKind::Steps => "steps",
        }
    }

    /// The kind called `name`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Its shape; `seed` places the hills.
    #[must_use]
    pub const fn terrain(self, seed: u32) -> Terrain {
        match self {
            GroundKind::Flat => Terrain::Flat,
            GroundKind::Wavy => Terrain::Wavy { height_m: 0.35, wavelength_m: 9.0, seed },
            GroundKind::Steps => Terrain::Steps { rise_m: 0.05, run_m: 1.2, count: 6 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_grounds_can_be_made_and_are_no_cliffs() {
        for (kind, highest) in [(GroundKind::Wavy, 0.35), (GroundKind::Steps, 0.3)] {
            let terrain = kind.terrain(3);
            terrain.check().unwrap();
            let grid = terrain.grid().unwrap();
            assert!(grid.highest > 0.5 * highest && grid.highest <= highest + 1e-6, "{}", grid.highest);
        }
    }
}
