//! What a player throws and puts down: the same things, speeds and places in every physics engine.

use glam::Vec3;
use policy_core::Heading;
use policy_core::contract::{Motion, Prop, Solid};

use super::Paint;

/// Speed of a ball that a player throws, metres per second, along the ground and up.
const THROWN_MPS: [f32; 2] = [9.0, 1.2];
/// It leaves the player so far ahead of the root body and above it, metres.
const THROWN_FROM_M: [f32; 2] = [0.55, 0.45];
/// What is put down falls from so far ahead and above, metres.
const PUT_AT_M: [f32; 2] = [1.4, 0.3];

/// What can be thrown or put somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LooseKind {
    /// A ball of 3 kg to throw.
    Ball,
    /// A crate.
    Crate,
    /// A barrel.
    Barrel,
    /// A large, light ball.
    BeachBall,
    /// A log.
    Log,
}

impl LooseKind {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Ball, Self::Crate, Self::Barrel, Self::BeachBall, Self::Log];
    /// Those that are put somewhere, in turn.
    pub const PUT: [Self; 4] = [Self::Crate, Self::Barrel, Self::BeachBall, Self::Log];

    /// Most of this kind at a time.
    #[must_use]
    pub const fn most(self) -> usize {
        match self {
            Self::Ball => 24,
            _ => 4,
        }
    }

    /// What it is to the physics, and its colour.
    #[must_use]
    pub fn prop(self) -> (Prop, Paint) {
        match self {
            Self::Ball => (Prop::ball(0.11, 3.0), Paint::Violet),
            Self::Crate => (Prop::cube(0.5, 5.0), Paint::Wood),
            Self::Barrel => {
                (Prop::new(Solid::Cylinder { radius: 0.25, half_length: 0.35 }, 8.0), Paint::Blue)
            }
            Self::BeachBall => (Prop::ball(0.35, 1.0), Paint::Orange),
            Self::Log => (Prop::new(Solid::Capsule { radius: 0.12, half_length: 0.5 }, 6.0), Paint::Green),
        }
    }
}

/// How a ball leaves a player whose root body is at `root`, metres, world space, and who throws along `ahead`.
#[must_use]
pub fn thrown(root: Vec3, ahead: Heading) -> Motion {
    let ahead = ahead.direction().extend(0.0);
    Motion::at(beside(root, ahead, THROWN_FROM_M)).moving(ahead * THROWN_MPS[0] + Vec3::Z * THROWN_MPS[1])
}

/// Where something is put down in front of a player whose root body is at `root`, metres, world space.
#[must_use]
pub fn put_down(root: Vec3, ahead: Heading) -> Motion {
    Motion::at(beside(root, ahead.direction().extend(0.0), PUT_AT_M))
}

fn beside(root: Vec3, ahead: Vec3, [far, high]: [f32; 2]) -> Vec3 {
    root + ahead * far + Vec3::Z * high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_leaves_ahead_of_the_player_and_upwards() {
        let root = Vec3::new(1.0, 2.0, 0.9);
        let motion = thrown(root, Heading::from_angle(core::f32::consts::FRAC_PI_2));
        assert!(motion.position.distance(Vec3::new(1.0, 2.55, 1.35)) < 1e-5, "{motion:?}");
        assert!(motion.velocity.distance(Vec3::new(0.0, 9.0, 1.2)) < 1e-5, "{motion:?}");
        motion.check().unwrap();
    }

    #[test]
    fn what_is_put_down_clears_the_player() {
        let put = put_down(Vec3::ZERO, Heading::FORWARD).position;
        for kind in LooseKind::PUT {
            let reach = match kind.prop().0.solid {
                Solid::Sphere { radius } => radius,
                Solid::Capsule { radius, half_length } => radius + half_length,
                Solid::Cylinder { radius, .. } => radius,
                Solid::Cuboid { half_extents } => half_extents.x,
                Solid::Hull { .. } => f32::INFINITY,
            };
            assert!(put.x - reach > 0.5, "{kind:?} reaches back to {} m", put.x - reach);
            kind.prop().0.check().unwrap();
        }
    }
}
