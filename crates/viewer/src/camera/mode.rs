//! The ways in which a camera moves.

/// How the camera moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "native", derive(serde::Serialize, serde::Deserialize))]
pub enum CameraMode {
    /// Keeps its direction and follows the character.
    #[default]
    Follow,
    /// Swings round behind the character.
    Chase,
    /// Stays where it is and looks at the character.
    Fixed,
    /// Sees what the character sees; turns as the player turns it.
    FirstPerson,
    /// Stays where it is and looks where it looked; flies with the arrow keys.
    Free,
}

impl CameraMode {
    /// All modes.
    pub const ALL: [CameraMode; 5] =
        [CameraMode::Follow, CameraMode::Chase, CameraMode::FirstPerson, CameraMode::Fixed, CameraMode::Free];

    /// Name for panels.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            CameraMode::Follow => "orbit",
            CameraMode::Chase => "follow",
            CameraMode::Fixed => "fixed",
            CameraMode::FirstPerson => "first person",
            CameraMode::Free => "free",
        }
    }

    /// What it does, in a sentence.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            CameraMode::Follow => "Moves along with the character and turns as you turn it.",
            CameraMode::Chase => "Swings round behind the character.",
            CameraMode::Fixed => "Stays where it is and looks at the character.",
            CameraMode::FirstPerson => "Sees what the character sees.",
            CameraMode::Free => "Flies: arrow keys, Page Up and Page Down; the wheel goes ahead.",
        }
    }

    /// True for a camera that circles the character.
    pub(super) const fn circles(self) -> bool {
        matches!(self, CameraMode::Follow | CameraMode::Chase)
    }
}
