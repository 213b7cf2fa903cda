//! The engines, by name.

/// A physics engine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Engine {
    /// That of training.
    #[default]
    Mujoco,
    /// In pure Rust.
    Rapier,
}

impl Engine {
    /// Both.
    pub const ALL: [Engine; 2] = [Engine::Mujoco, Engine::Rapier];

    /// Name for command lines and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Engine::Mujoco => "mujoco",
            Engine::Rapier => "rapier",
        }
    }

    /// Name for people.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Engine::Mujoco => "MuJoCo",
            Engine::Rapier => "Rapier",
        }
    }

    /// The engine called `name`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|engine| engine.name() == name)
    }

    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Engine::Mujoco => Engine::Rapier,
            Engine::Rapier => Engine::Mujoco,
        }
    }

    /// True when its characters tell the force of each contact.
    #[must_use]
    pub const fn tells_contacts(self) -> bool {
        matches!(self, Engine::Mujoco)
    }

    /// True when its characters keep the last seconds, to go back to.
    #[must_use]
    pub const fn keeps_history(self) -> bool {
        matches!(self, Engine::Mujoco)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_engine_is_found_by_its_name() {
        for engine in Engine::ALL {
            assert_eq!(Engine::from_name(engine.name()), Some(engine));
            assert_ne!(engine.other(), engine);
            assert_eq!(engine.other().other(), engine);
        }
        assert_eq!(Engine::from_name("bullet"), None);
    }
}
