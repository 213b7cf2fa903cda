//! What stands on the floor, by name.

/// A scene of the demo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneKind {
    /// Nothing: characters live apart, in either engine, on any ground. For the method.
    #[default]
    Empty,
    /// Ramps, stairs, props and a course, in one world with characters that wander.
    Playground,
}

impl SceneKind {
    /// All scenes.
    pub const ALL: [SceneKind; 2] = [SceneKind::Empty, SceneKind::Playground];

    /// Name for command lines and panels.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            SceneKind::Empty => "empty",
            SceneKind::Playground => "playground",
        }
    }

    /// The scene called `name`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scene| scene.name() == name)
    }

    /// Characters that it usually has, the player included.
    #[must_use]
    pub const fn usual_characters(self) -> usize {
        match self {
            SceneKind::Empty => 1,
            SceneKind::Playground => 5,
        }
    }
}
