//! Meetings: a character shares its world with another one that walks into its way, with a ball that is thrown at it and
//! with a crate that lies before it. One that was touched in training is not thrown by the first touch in a game.

mod arrange;
mod other;

use glam::{Quat, Vec2, Vec3};
use physics_bridge::{
    Character, CharacterHandle, Contact, Diverging, Model, Motion, Movable, Part, Prop, PropHandle, Solid,
    World, WorldError,
};
use policy_core::contract::Pose;
use policy_core::{BodyId, CharacterState, Controller, Heading};
use random::Rng;
use serde::{Deserialize, Serialize};

use self::arrange::{BALL_KG, CRATE_HALF_METRES, CRATE_KG};
use self::other::Other;
use super::command::DT_SECS;

pub(crate) use self::other::{MET, WALK};

/// What characters meet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MeetingsConfig {
    /// Share of the environments in which something is met. Each of them costs about three times as much time as one without.
    pub share: f32,
    /// Longest pause between two meetings, seconds.
    pub pause_secs: f32,
}

/// The world of a character that meets others.
#[derive(Debug)]
pub(super) struct Company {
    world: World,
    own: CharacterHandle,
    other: Other,
    ball: Loose,
    block: Loose,
    /// Where the own character touches the ground.
    contacts: Vec<Contact>,
    pose: Pose,
    /// Ticks until the next meeting.
    ticks_left: u32,
}

/// A prop that is laid down or thrown.
#[derive(Clone, Copy, Debug)]
struct Loose {
    prop: PropHandle,
    /// Height of its middle above the ground that it lies on, metres.
    half_metres: f32,
}

/// What is not met waits this far away, metres.
const ASIDE_METRES: f32 = 40.0;

impl Company {
    /// A world of `model` with another character, which `controller` drives, a ball and a crate. Allocates.
    ///
    /// # Errors
    /// When MuJoCo refuses it.
    pub fn new(model: &Model, controller: &Controller, rng: &mut Rng) -> Result<Self, WorldError> {
        let mut world = World::new(model)?;
        let kg = rng.range(BALL_KG[0], BALL_KG[1]);
        // As dense as a medicine ball.
        let radius = 0.12 * (kg / 3.0).cbrt();
        let half = rng.range(CRATE_HALF_METRES[0], CRATE_HALF_METRES[1]);
        let side = Solid::Cuboid { half_extents: Vec3::splat(half) };
        let block = Prop::new(side, rng.range(CRATE_KG[0], CRATE_KG[1]));
        let (own, other, ball, block) = world.edit(|edit| {
            let at_rest = |x: f32, half: f32| Motion::at(Vec3::new(x, ASIDE_METRES, half));
            Ok((
                edit.add_character(model, 0.0, 0.0, Heading::FORWARD, 0.0)?,
                edit.add_character(model, 0.0, ASIDE_METRES, Heading::FORWARD, 0.0)?,
                edit.add_prop(Prop::new(Solid::Sphere { radius }, kg), at_rest(3.0, radius))?,
                edit.add_prop(block, at_rest(-3.0, half))?,
            ))
        })?;
        let other = Other::new(other, controller);
        let [ball, block] =
            [(ball, radius), (block, half)].map(|(prop, half_metres)| Loose { prop, half_metres });
        let contacts = Vec::with_capacity(64);
        let pose = Character::new(model).pose();
        Ok(Self { world, own, other, ball, block, contacts, pose, ticks_left: 0 })
    }

    /// Begins an episode with the own character where `character` is.
    pub fn begin(&mut self, character: &Character, pause_secs: f32, rng: &mut Rng) {
        character.pose_into(&mut self.pose);
        let Pose { qpos, qvel } = &self.pose;
        self.world.set_pose(self.own, qpos, qvel).expect("a pose of the same character");
        self.part();
        self.ticks_left = pause(pause_secs, rng);
    }

    /// Copies the own character's pose to `character`, which forgets everything else.
    pub fn copy_to(&mut self, character: &mut Character) {
        self.world.pose_into(self.own, &mut self.pose).expect("it is never removed");
        // One that is about to fail may be beyond what a pose can be.
        _ = character.set_pose(&self.pose.qpos, &self.pose.qvel);
    }

    /// Pushes a body of the own character, as [`Character::push`].
    pub fn push(&mut self, body: BodyId, force: Vec3, secs: f32) -> Result<(), WorldError> {
        self.world.push(Movable::Body(self.own, body), force, secs)
    }

    /// Writes what the own character senses.
    pub fn sense_into(&self, out: &mut CharacterState) {
        self.world.sense_into(self.own, out).expect("it is never removed");
    }

    /// Where the own character touches the ground.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// One tick of all: `targets` are those of the own character, `state` what it senses. True when the own character diverged.
    /// The other one is put back by the world, and a prop that diverges is met no more.
    pub fn step(&mut self, targets: &[f32], state: &CharacterState, pause_secs: f32, rng: &mut Rng) -> bool {
        if self.ticks_left == 0 {
            let secs = self.meet(state, rng);
            self.ticks_left = (secs / DT_SECS) as u32 + pause(pause_secs, rng);
        }
        self.ticks_left -= 1;
        self.world.actuate(self.own, targets).expect("it is never removed");
        self.other.act(&mut self.world);
        self.world.step();
        self.collect_contacts();
        self.has_diverged()
    }

    /// Puts the other character and the props out of the way.
    fn part(&mut self) {
        let at = self.place().with_y(self.place().y + ASIDE_METRES);
        self.other.stand(&mut self.world, at, 0.0, 0.0);
        self.other.way = None;
        for (loose, along) in [(self.ball, 3.0), (self.block, -3.0)] {
            self.lay(loose, at + along * Vec2::X, Quat::IDENTITY);
        }
    }

    /// True when the own character diverged in the last tick, or the world can't tell what did.
    fn has_diverged(&self) -> bool {
        let mut culprits = self.world.divergences().iter().map(|divergence| divergence.what);
        culprits.any(|what| what.is_none_or(|what| what == Diverging::Character(self.own)))
    }

    fn place(&self) -> Vec2 {
        Vec2::new(self.pose.qpos[0] as f32, self.pose.qpos[1] as f32)
    }

    /// Lays a prop down at rest.
    fn lay(&mut self, loose: Loose, at: Vec2, rotation: Quat) {
        let height = self.world.ground().height_at(at.x, at.y) + loose.half_metres;
        let motion = Motion { rotation, ..Motion::at(at.extend(height)) };
        self.place_loose(loose, motion);
    }

    /// Puts a prop somewhere, unless it diverged and was taken out.
    fn place_loose(&mut self, loose: Loose, motion: Motion) {
        if self.world.prop(loose.prop).is_ok() {
            self.world.place_prop(loose.prop, motion).expect("a place near the character");
        }
    }

    fn collect_contacts(&mut self) {
        self.contacts.clear();
        for contact in self.world.contacts() {
            let (body, sign) = match contact.parts {
                [Part::Ground, Part::Body(owner, body)] if owner == self.own => (body, 1.0),
                [Part::Body(owner, body), Part::Ground] if owner == self.own => (body, -1.0),
                _ => continue,
            };
            self.contacts.push(Contact {
                body,
                other: None,
                position: contact.position,
                normal: contact.normal * sign,
                force: contact.force * sign,
                depth: contact.depth,
            });
        }
    }
}

/// A pause of up to so many seconds, ticks.
fn pause(most_secs: f32, rng: &mut Rng) -> u32 {
    (rng.range(0.1, most_secs.max(0.2)) / DT_SECS) as u32 + 1
}

#[cfg(test)]
#[path = "meetings/tests.rs"]
mod tests;
