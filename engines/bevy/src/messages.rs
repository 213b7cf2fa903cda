//! What characters tell a game: skills, falls, and what went wrong.

use std::collections::HashMap;

use bevy::prelude::*;
use policy_core::{SkillEnd, SkillId, SwapError};

/// A skill has started.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct SkillStarted {
    /// The character.
    pub character: Entity,
    /// The skill.
    pub skill: SkillId,
    /// Its name.
    pub name: String,
}

/// A skill has ended.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct SkillEnded {
    /// The character.
    pub character: Entity,
    /// The skill.
    pub skill: SkillId,
    /// Its name.
    pub name: String,
    /// Why.
    pub end: SkillEnd,
}

/// A character has fallen.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fell {
    /// The character.
    pub character: Entity,
}

/// A character that had fallen is on its feet again.
#[derive(Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rose {
    /// The character.
    pub character: Entity,
}

/// Something is wrong with a character. [`CorePlugin`](crate::CorePlugin) logs each of these.
#[derive(Message, Debug, thiserror::Error)]
#[error("character {character}: {problem}")]
pub struct CharacterError {
    /// The character.
    pub character: Entity,
    /// What is wrong.
    #[source]
    pub problem: CharacterProblem,
}

/// What can be wrong with a character. It says what the plug-in did about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CharacterProblem {
    /// The pack can't be loaded. A character that waits for it goes on waiting, one that has a pack keeps it.
    #[error("expected a character pack in \"{path}\", found: {reason}")]
    Load {
        /// The asset.
        path: String,
        /// Why not.
        reason: String,
    },
    /// A new pack is for another body. The character keeps the pack it had.
    #[error("the new pack is not used: {source}")]
    Reload {
        /// What differs.
        source: SwapError,
    },
    /// The pack's body can't be built. The character keeps the body it had, if it had one.
    #[error("the body of the pack can't be built: {message}")]
    Body {
        /// What the physics says.
        message: String,
    },
    /// A `Transform` is not finite. The character stays where it was, or waits for a finite one.
    #[error("expected a finite Transform, found {found:?}")]
    Transform {
        /// What was found.
        found: Transform,
    },
    /// A character can't stand where its `Transform` is. It stays where it was, or waits for another one.
    #[error("expected a Transform where the character can stand: {message}")]
    OutOfReach {
        /// What is wrong with the place.
        message: String,
    },
    /// There is no default context of Rapier, or there are several. The character waits for the only one.
    #[error("expected one default context of Rapier for the character, found {found}")]
    Context {
        /// Default contexts.
        found: usize,
    },
    /// A force or impulse is not finite. It is not applied.
    #[error("expected a finite force on \"{body}\", found {found}")]
    Force {
        /// The body.
        body: String,
        /// Newtons or newton seconds.
        found: Vec3,
    },
    /// The target of a command is not finite. The character stays where it stands.
    #[error("expected a finite target, found {found}")]
    Target {
        /// What was found.
        found: Vec3,
    },
    /// The pack lacks a name. That part of the command is ignored.
    #[error("expected a {kind} of the pack, found \"{name}\"")]
    Unknown {
        /// `path`, `node` or `skill`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Its bodies moved faster or farther than is plausible. It stands again where it last was well.
    #[error("the physics diverged, so it was stood up again: {message}")]
    Diverged {
        /// The body and how it moved.
        message: String,
    },
    /// The game removed a part of it from the physics. It was built anew.
    #[error("a part was removed, so it was built anew: {message}")]
    Removed {
        /// The part.
        message: String,
    },
    /// A component was removed that it needs. It was put back with its default value.
    #[error("expected the component {component}, found it removed; it was put back")]
    Component {
        /// Its name.
        component: &'static str,
    },
}

impl CharacterProblem {
    /// The problem of a character.
    pub(crate) fn of(self, character: Entity) -> CharacterError {
        CharacterError { character, problem: self }
    }
}

/// What was reported of characters that wait: each problem once, as long as it is the same.
#[derive(Default)]
pub(crate) struct Reported(HashMap<Entity, String>);

impl Reported {
    /// Forgets the characters that wait no longer.
    pub(crate) fn keep(&mut self, waits: impl Fn(Entity) -> bool) {
        self.0.retain(|&character, _| waits(character));
    }

    /// Reports a problem of a character, unless it was the last one reported of it.
    pub(crate) fn write(
        &mut self,
        problem: CharacterProblem,
        character: Entity,
        errors: &mut MessageWriter<'_, CharacterError>,
    ) {
        let words = problem.to_string();
        if self.0.get(&character) != Some(&words) {
            self.0.insert(character, words);
            errors.write(problem.of(character));
        }
    }
}
