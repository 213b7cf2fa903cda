//! Where a character of the scene wanders: seeded, simple, turned back at the edge of its zone.

use std::f32::consts::{PI, TAU};

use glam::Vec2;
use policy_core::{CharacterPack, Command, Goal, PathId};
use random::Rng;

/// How long it keeps to one direction, seconds.
const STROLL_SECS: [f32; 2] = [2.0, 6.0];
/// Share of the strolls in which it stands.
const STANDS: f32 = 0.2;
/// Nearer to the edge of its zone it turns back, metres.
const MARGIN_M: f32 = 1.0;
/// How far ahead its target is, metres: as far as a full stick's.
const AHEAD_M: f32 = 5.0;
/// In a hurry it is so far along the path behind its second node.
const HURRY: f32 = 0.25;
/// Fastest that it turns its direction, radians per second.
const TURN_RADPS: f32 = 3.0;

/// What a wanderer wants in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Where to, a unit vector; `None` to stand.
    pub direction: Option<Vec2>,
    /// Of the speed path: 0 the slowest gait, 1 a quarter of the way to the fastest.
    pub haste: f32,
}

/// The path that wanderers move along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WanderPath(Option<(PathId, f32)>);

impl WanderPath {
    /// That of the stick, where the pack has one.
    #[must_use]
    pub fn of(pack: &CharacterPack) -> Self {
        let named = pack.graph().path_named(&policy_core::Bindings::default().stick_path);
        Self(named.map(|path| (path, pack.graph().path(path).end())))
    }

    /// The command of a wish for a character at a point.
    #[must_use]
    pub fn command(self, wish: Wish, at: Vec2) -> Command {
        let goal = |coordinate: f32| match self.0 {
            Some((path, end)) => Goal::Path { path, coordinate: coordinate.min(end) },
            None => Goal::Stay,
        };
        match wish.direction {
            Some(direction) => Command {
                target: Some(at + direction * AHEAD_M),
                goal: goal(1.0 + HURRY * wish.haste),
                ..Command::default()
            },
            None => Command { goal: goal(0.0), ..Command::default() },
        }
    }
}

/// The state of one wanderer: plain data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanderer {
    rng: Rng,
    zone: [Vec2; 2],
    left_secs: f32,
    angle: f32,
    wanted: f32,
    stands: bool,
    haste: f32,
}

impl Wanderer {
    /// A wanderer in a rectangle, least and greatest x and y. Equal seeds and streams wander alike.
    #[must_use]
    pub fn new(zone: [Vec2; 2], heading: f32, seed: u64, stream: u64) -> Self {
        let rng = Rng::new(seed, stream);
        Self { rng, zone, left_secs: 0.0, angle: heading, wanted: heading, stands: true, haste: 0.0 }
    }

    /// Gives the bits of the whole state to `out`: what a hash of it is made of.
    pub fn bits(&self, mut out: impl FnMut(u32)) {
        let Self { mut rng, zone: _, left_secs, angle, wanted, stands, haste } = *self;
        [left_secs, angle, wanted, haste].into_iter().for_each(|value| out(value.to_bits()));
        // What it would draw next tells where its numbers are.
        out(rng.next_u32());
        out(u32::from(stands));
    }

    /// One tick of `dt_secs` for a character at a point.
    pub fn tick(&mut self, at: Vec2, dt_secs: f32) -> Wish {
        self.left_secs -= dt_secs;
        let outside = self.outward(at);
        if self.left_secs <= 0.0 {
            self.left_secs = self.rng.range(STROLL_SECS[0], STROLL_SECS[1]);
            self.stands = self.rng.chance(STANDS);
            self.haste = self.rng.uniform();
            self.wanted = self.rng.angle();
        }
        if let Some(out) = outside
            && Vec2::from_angle(self.wanted).dot(out) > -0.3
        {
            // Back, a little to one side or the other.
            let aside = self.rng.range(-0.9, 0.9);
            (self.wanted, self.stands) = ((-out).to_angle() + aside, false);
        }
        let off = (self.wanted - self.angle + PI).rem_euclid(TAU) - PI;
        self.angle += off.clamp(-TURN_RADPS * dt_secs, TURN_RADPS * dt_secs);
        let direction = (!self.stands).then(|| Vec2::from_angle(self.angle));
        Wish { direction, haste: self.haste }
    }

    /// Out of the zone, a unit vector, for a point near its edge or outside.
    fn outward(&self, at: Vec2) -> Option<Vec2> {
        let [low, high] = self.zone;
        // A zone that is narrow is all edge: its middle is always inside.
        let margin = Vec2::splat(MARGIN_M).min((high - low) * 0.4);
        let out = (at - (high - margin)).max(Vec2::ZERO) + (at - (low + margin)).min(Vec2::ZERO);
        out.try_normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ZONE: [Vec2; 2] = [Vec2::new(-4.0, 2.0), Vec2::new(4.0, 5.0)];

    /// Walks a point at walking speed for a while; returns how far out of the zone it came, and its way.
    fn stroll(seed: u64, secs: f32) -> (f32, Vec<Vec2>) {
        let (dt, mut at) = (1.0 / 30.0, Vec2::new(0.0, 3.0));
        let mut wanderer = Wanderer::new(ZONE, 0.0, seed, 1);
        let (mut worst, mut way) = (0.0_f32, Vec::new());
        for _ in 0..(secs / dt) as usize {
            let wish = wanderer.tick(at, dt);
            assert!(wish.direction.is_none_or(|d| (d.length() - 1.0).abs() < 1e-4));
            at += wish.direction.unwrap_or(Vec2::ZERO) * 1.4 * dt;
            worst = worst.max((at - at.clamp(ZONE[0], ZONE[1])).length());
            way.push(at);
        }
        (worst, way)
    }

    #[test]
    fn it_turns_back_at_the_edge_and_sees_its_zone() {
        for seed in 0..20 {
            let (worst, way) = stroll(seed, 120.0);
            assert!(worst < 1.5, "seed {seed} strays {worst} m");
            let span =
                way.iter().fold(Vec2::MIN, |a, b| a.max(*b)) - way.iter().fold(Vec2::MAX, |a, b| a.min(*b));
            assert!(span.x > 3.0, "seed {seed} sees {span}");
        }
    }

    #[test]
    fn equal_seeds_wander_alike_and_others_do_not() {
        assert_eq!(stroll(3, 30.0).1, stroll(3, 30.0).1);
        assert_ne!(stroll(3, 30.0).1, stroll(4, 30.0).1);
    }
}
