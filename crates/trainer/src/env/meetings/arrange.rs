//! How meetings begin: where the other character, the ball and the crate start, and how fast they move.

use std::f32::consts::PI;

use glam::{Quat, Vec2, Vec3};
use physics_bridge::Motion;
use policy_core::contract::WALKING_START_MPS;
use policy_core::{CharacterState, Heading};
use random::Rng;

use super::super::env::GRAVITY;
use super::Company;

/// Shares of meetings with a character and with a ball; the rest are with a crate.
const CHARACTER_SHARE: f32 = 0.65;
const BALL_SHARE: f32 = 0.2;

/// Seconds that a meeting takes.
const CHARACTER_SECS: f32 = 4.0;
const BALL_SECS: f32 = 1.5;
const CRATE_SECS: f32 = 4.0;

/// Share of the characters that come from ahead, and how far off straight ahead they come, radians.
const AHEAD_SHARE: f32 = 0.7;
const AHEAD_RADIANS: f32 = 0.5;

/// How far away another character starts, and how far beside the middle it passes, metres.
const COMES_FROM_METRES: [f32; 2] = [1.6, 3.0];
const PASSES_METRES: f32 = 0.35;

/// Mass of a ball, its speed, and where it comes from.
pub(super) const BALL_KG: [f32; 2] = [1.5, 8.0];
const BALL_MPS: [f32; 2] = [4.0, 11.0];
const THROW_METRES: f32 = 2.0;

/// Heights at which a ball hits, metres: from the hips to the chest.
const HIT_METRES: [f32; 2] = [0.8, 1.3];

/// Mass of a crate, half its side, and how far ahead it lies.
pub(super) const CRATE_KG: [f32; 2] = [1.0, 20.0];
pub(super) const CRATE_HALF_METRES: [f32; 2] = [0.12, 0.28];
const CRATE_AHEAD_METRES: [f32; 2] = [0.9, 1.8];

/// So much faster than this, metres per second, and it is the way that counts, not the direction it faces.
const GOES_MPS: f32 = 0.3;

impl Company {
    /// Arranges a meeting; how long it takes, seconds.
    pub(super) fn meet(&mut self, state: &CharacterState, rng: &mut Rng) -> f32 {
        let root = state.root();
        let (at, velocity) = (root.position.truncate(), root.linear_velocity.truncate());
        let ahead = match velocity.length() {
            speed if speed > GOES_MPS => velocity.to_angle(),
            _ => Heading::from_rotation(root.rotation).angle(),
        };
        let kind = rng.uniform();
        if kind < CHARACTER_SHARE {
            self.send_character(at, velocity, ahead, rng);
            CHARACTER_SECS
        } else if kind < CHARACTER_SHARE + BALL_SHARE {
            let ground = root.position.z - state.root_height();
            self.throw_ball(at.extend(ground), velocity, rng);
            BALL_SECS
        } else {
            self.leave_crate(at, ahead, rng);
            CRATE_SECS
        }
    }

    /// Sends the other character to where both will be after the time that it takes to walk there.
    fn send_character(&mut self, at: Vec2, velocity: Vec2, ahead: f32, rng: &mut Rng) {
        let aside = if rng.chance(AHEAD_SHARE) { AHEAD_RADIANS } else { PI };
        let from = Vec2::from_angle(ahead + rng.range(-aside, aside));
        let [near, far] = COMES_FROM_METRES;
        let apart = rng.range(near, far);
        let secs = apart / (WALKING_START_MPS + velocity.dot(from).max(0.0));
        let passed = from.perp() * rng.range(-PASSES_METRES, PASSES_METRES);
        // What comes towards it need not be met where it will be: it goes there by itself.
        let met = at + (velocity - velocity.dot(from).max(0.0) * from) * secs;
        let start = met + apart * from + passed;
        // One that comes from behind would start too near.
        let start = if start.distance(at) < near { at + near * from } else { start };
        self.other.stand(&mut self.world, start, (-from).to_angle(), WALKING_START_MPS);
        self.other.way = Some(-from);
    }

    /// Throws the ball at where the own character will be. `at` is on the ground below it.
    fn throw_ball(&mut self, at: Vec3, velocity: Vec2, rng: &mut Rng) {
        let mps = rng.range(BALL_MPS[0], BALL_MPS[1]);
        let secs = THROW_METRES / mps;
        let height = rng.range(HIT_METRES[0], HIT_METRES[1]);
        let hit = at + (secs * velocity).extend(height);
        let start = hit + (THROW_METRES * Vec2::from_angle(rng.angle())).extend(0.0);
        let rise = Vec3::Z * (0.5 * GRAVITY * secs);
        let motion = Motion::at(start).moving((hit - start) / secs + rise);
        self.place_loose(self.ball, motion);
    }

    /// Lays the crate down ahead of the own character.
    fn leave_crate(&mut self, at: Vec2, ahead: f32, rng: &mut Rng) {
        let direction = Vec2::from_angle(ahead);
        let aside = direction.perp() * rng.range(-PASSES_METRES, PASSES_METRES);
        let metres = rng.range(CRATE_AHEAD_METRES[0], CRATE_AHEAD_METRES[1]);
        self.lay(self.block, at + metres * direction + aside, Quat::from_rotation_z(rng.angle()));
    }
}
