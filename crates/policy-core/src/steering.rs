//! Holding the course: a policy drifts aside and begins a turn late. Feedback from the direction of travel corrects both.

use core::f32::consts::PI;

use glam::Vec2;

use crate::heading::Heading;
use crate::state::CharacterState;

/// Slowest speed that has a direction, metres per second. Below it the heading counts.
const LEAST_SPEED: f32 = 0.1;

/// Speed from which the direction of the velocity counts alone, metres per second.
const FULL_SPEED: f32 = 0.3;

/// Errors beyond this are turns, not drift, radians.
const DRIFT_RADIANS: f32 = 0.6;

/// The lead raises no turn above this angle, radians. Larger turns are slower with a lead.
const LARGEST_RADIANS: f32 = 0.5 * PI;

/// Largest angle off the heading at which a policy sees its target, radians. A policy with a target straight behind it waits
/// before it turns.
const BEHIND_RADIANS: f32 = 0.75 * PI;

/// Angle off the heading from which both sides are as near, radians. There a turn goes to the side to which the body turns already.
const EITHER_RADIANS: f32 = 0.92 * PI;

/// A body that turns slower than this turns to no side, radians a second.
const LEAST_TURNING: f32 = 0.1;

/// Corrects the target that a policy sees by the course: the direction in which the root moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// How much further the policy is asked to turn than the target lies, for each radian between course and target.
    pub lead: f32,
    /// How fast the trim against drift grows, radians a second for each radian between course and target.
    pub trim_per_second: f32,
    /// Largest trim, radians.
    pub trim_limit_radians: f32,
    /// Time constant of the low-pass on the velocity, seconds.
    pub velocity_secs: f32,
}

impl Default for Steering {
    fn default() -> Self {
        Self { lead: 0.5, trim_per_second: 0.8, trim_limit_radians: 0.5, velocity_secs: 0.3 }
    }
}

/// What steering remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteeringState {
    /// Low-passed horizontal velocity of the root, world, metres per second.
    pub(crate) velocity: Vec2,
    /// Angle that is added against drift, radians.
    pub(crate) trim: f32,
    /// The side to which it turns about, 1 to the left, -1 to the right; 0 while the target is not behind. A hip that swings in a walk must
    /// not change it.
    pub(crate) side: f32,
}

impl Steering {
    /// The target turned about the root so that the course goes to where it lies. The trim counts and grows by `trim_share`, in [0, 1]: it is that of
    /// the gaits that drift, and a variant that turns in their place does not.
    #[must_use]
    pub fn adjusted(
        self,
        memory: &mut SteeringState,
        state: &CharacterState,
        target: Vec2,
        trim_share: f32,
        dt: f32,
    ) -> Vec2 {
        let root = state.root();
        memory.follow(self.velocity_secs, state, dt);
        let Some(to_target) = way_to(target, state) else { return target };
        let wanted = Heading::from_direction(to_target).angle();
        let off_heading = wrapped(wanted - Heading::from_rotation(root.rotation).angle());
        let (off_course, moving) = memory.off_course(wanted);
        // Facing away, what counts is the side to turn to, not where the momentum of the old direction still leads.
        let error = if libm::fabsf(off_heading) > DRIFT_RADIANS { off_heading } else { moving * off_course };
        if libm::fabsf(off_heading) < DRIFT_RADIANS && libm::fabsf(off_course) < DRIFT_RADIANS {
            self.trim(memory, trim_share * moving * off_course, dt);
        }
        let largest = libm::fabsf(off_heading).max(LARGEST_RADIANS);
        let asked = if libm::fabsf(off_heading) > BEHIND_RADIANS {
            if memory.side == 0.0 {
                let turning = root.angular_velocity.z;
                let continues =
                    libm::fabsf(off_heading) > EITHER_RADIANS && libm::fabsf(turning) > LEAST_TURNING;
                memory.side = 1.0_f32.copysign(if continues { turning } else { off_heading });
            }
            BEHIND_RADIANS * memory.side
        } else {
            memory.side = 0.0;
            (off_heading + self.lead * error + trim_share * memory.trim).clamp(-largest, largest)
        };
        let turned = Heading::from_angle(asked - off_heading);
        root.position.truncate() + turned.world_from_heading_2d(to_target)
    }

    /// The target of a character that strafes, turned about the root by the trim alone: where it looks says nothing about where it goes.
    /// A new way to go begins without a trim.
    #[must_use]
    pub fn trimmed(self, memory: &mut SteeringState, state: &CharacterState, target: Vec2, dt: f32) -> Vec2 {
        memory.follow(self.velocity_secs, state, dt);
        memory.side = 0.0;
        let Some(to_target) = way_to(target, state) else { return target };
        let (off_course, moving) = memory.off_course(Heading::from_direction(to_target).angle());
        if libm::fabsf(off_course) < DRIFT_RADIANS {
            self.trim(memory, moving * off_course, dt);
        } else {
            memory.trim = 0.0;
        }
        let turned = Heading::from_angle(memory.trim);
        state.root().position.truncate() + turned.world_from_heading_2d(to_target)
    }

    /// Lets the trim grow by an error, radians.
    fn trim(self, memory: &mut SteeringState, error: f32, dt: f32) {
        let limit = self.trim_limit_radians;
        let trim = memory.trim + error * self.trim_per_second * dt;
        memory.trim = if trim.is_finite() { trim.max(-limit).min(limit) } else { 0.0 };
    }
}

impl SteeringState {
    /// Follows the velocity of the root with a time constant.
    fn follow(&mut self, secs: f32, state: &CharacterState, dt: f32) {
        let share = if secs > 0.0 { (dt / secs).min(1.0) } else { 1.0 };
        self.velocity += (state.root().linear_velocity.truncate() - self.velocity) * share;
    }

    /// Angle from the course to the direction that is wanted, and how much the course counts, in [0, 1].
    fn off_course(&self, wanted: f32) -> (f32, f32) {
        let speed = libm::sqrtf(self.velocity.length_squared());
        let moving = ((speed - LEAST_SPEED) / (FULL_SPEED - LEAST_SPEED)).clamp(0.0, 1.0);
        (wrapped(wanted - Heading::from_direction(self.velocity).angle()), moving)
    }
}

/// From the root to a target; nothing for one that is not finite or where the character stands.
fn way_to(target: Vec2, state: &CharacterState) -> Option<Vec2> {
    let way = target - state.root().position.truncate();
    let distance = libm::sqrtf(way.length_squared());
    (distance.is_finite() && distance > 1e-3).then_some(way)
}

/// An angle in [-pi, pi].
fn wrapped(radians: f32) -> f32 {
    radians - 2.0 * PI * libm::roundf(radians / (2.0 * PI))
}
