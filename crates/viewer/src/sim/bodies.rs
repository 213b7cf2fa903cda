//! The physics of all characters of the demo: each alone in its own world, or all in one.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use physics::{Character, PhysicsCharacter};
use physics_bridge::{CharacterHandle, Crowd, Part, Pose, World};
use policy_core::{BodyId, CharacterState, Heading, Skeleton};

use super::SharedWorld;

/// Where the characters live.
#[derive(Debug)]
pub(super) enum Bodies {
    /// Each alone: they walk through each other.
    Apart(Crowd<Character>),
    /// In one world, with props.
    Together(Box<SharedWorld>),
}

/// The physics of one character.
#[derive(Clone, Copy, Debug)]
pub(super) enum BodyRef<'a> {
    Alone(&'a Character),
    Shared(&'a World, CharacterHandle),
}

/// A point at which a character touches the ground or what stands on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundContact {
    /// Metres, world space.
    pub position: Vec3,
    /// On the character, newtons, world space.
    pub force: Vec3,
}

impl Bodies {
    /// The physics of a character.
    pub(super) fn of(&self, index: usize) -> BodyRef<'_> {
        match self {
            Self::Apart(crowd) => BodyRef::Alone(crowd.character(index)),
            Self::Together(shared) => BodyRef::Shared(shared.world(), shared.handle(index)),
        }
    }

    /// Stands a character up; false when it can't stand there.
    pub(super) fn stand_at(&mut self, index: usize, at: Vec2, heading: Heading) -> bool {
        match self {
            Self::Apart(crowd) => crowd.character_mut(index).stand_at(at.x, at.y, heading, 0.0).is_ok(),
            Self::Together(shared) => shared.stand_at(index, at, heading),
        }
    }

    /// Pushes a body of a character; false when the push is out of its bounds.
    pub(super) fn push(&mut self, index: usize, body: BodyId, force: Vec3, secs: f32) -> bool {
        match self {
            Self::Apart(crowd) => crowd.character_mut(index).push(body, force, secs).is_ok(),
            Self::Together(shared) => shared.push(index, body, force, secs),
        }
    }
}

impl<'a> BodyRef<'a> {
    /// The skeleton; `None` for a character that its world has taken out.
    pub(super) fn skeleton(self) -> Option<&'a Arc<Skeleton>> {
        match self {
            Self::Alone(character) => Some(character.model().skeleton()),
            Self::Shared(world, handle) => world.model(handle).ok().map(physics_bridge::Model::skeleton),
        }
    }

    pub(super) fn control_hz(self) -> f32 {
        match self {
            Self::Alone(character) => character.control_hz(),
            Self::Shared(world, _) => world.ground().control_hz(),
        }
    }

    /// True when its last seconds are kept.
    pub(super) fn keeps_history(self) -> bool {
        match self {
            Self::Alone(character) => character.history_len() > 0,
            Self::Shared(world, _) => world.history_len() > 0,
        }
    }

    /// Writes what it senses; nothing for a character that its world has taken out.
    pub(super) fn sense_into(self, out: &mut CharacterState) {
        match self {
            Self::Alone(character) => character.sense_into(out),
            Self::Shared(world, handle) => {
                let _ = world.sense_into(handle, out);
            }
        }
    }

    /// Writes its pose; nothing for a character that its world has taken out.
    pub(super) fn pose_into(self, out: &mut Pose) {
        match self {
            Self::Alone(character) => character.pose_into(out),
            Self::Shared(world, handle) => {
                let _ = world.pose_into(handle, out);
            }
        }
    }

    /// Centre of mass, metres.
    pub(super) fn centre_of_mass(self) -> Vec3 {
        match self {
            Self::Alone(character) => character.centre_of_mass(),
            Self::Shared(world, handle) => world.centre_of_mass(handle).unwrap_or(Vec3::ZERO),
        }
    }

    /// Where it touches the ground, or what stands there.
    pub(super) fn ground_contacts(self) -> Vec<GroundContact> {
        match self {
            Self::Alone(character) => {
                let on_ground = character.contacts().iter().filter(|contact| contact.other.is_none());
                on_ground.map(|c| GroundContact { position: c.position, force: c.force }).collect()
            }
            Self::Shared(world, handle) => {
                let is_own = |part: Part| matches!(part, Part::Body(whose, _) if whose == handle);
                let touching = world.contacts().iter().filter_map(|contact| {
                    // The force is on the second of the two.
                    let force = match contact.parts.map(is_own) {
                        [false, true] => contact.force,
                        [true, false] => -contact.force,
                        _ => return None,
                    };
                    Some(GroundContact { position: contact.position, force })
                });
                touching.collect()
            }
        }
    }
}
