//! Settings of commands.

use std::f32::consts::PI;

use serde::{Deserialize, Serialize};

/// What characters are told to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CommandConfig {
    /// Speed that the skill is commanded to, metres per second.
    pub speed_mps: f32,
    /// Distance of new targets, metres, least and most.
    pub target_metres: [f32; 2],
    /// Seconds until a target is renewed, least and most.
    pub target_secs: [f32; 2],
    /// Share of targets that lie where the character stands.
    pub stop_share: f32,
    /// The same share for gaits slower than 0.6 m/s, if it differs. A player stops a walk by going to Idle, a crouch by the
    /// target alone.
    pub slow_stop_share: Option<f32>,
    /// Factor on `target_secs` for gaits faster than 2 m/s. Asked to turn all the time, a run has little use for its speed.
    pub fast_target_factor: f32,
    /// Share of episodes whose target moves ahead of the character, as the stick of a pad has it.
    pub stick_share: f32,
    /// Share of a stick's new directions that are any at all; the others turn by at most 90 degrees.
    pub any_direction_share: f32,
    /// Share of sticks that steer as in a game: through turn assist and steering, and released they lead to standing.
    pub assisted_share: f32,
    /// Share of coordinates that go to and fro over the whole path, without a rest.
    pub sweep_share: f32,
    /// Seconds in which a moving coordinate crosses an edge, least and most.
    pub edge_sweep_secs: [f32; 2],
    /// Seconds that a moving coordinate rests where it arrived, least and most.
    pub edge_rest_secs: [f32; 2],
    /// Share of moving coordinates that jump to where they are sent.
    pub jump_share: f32,
    /// Least seconds to cross an edge of this skill, as in a pack; 0 for no limit.
    pub edge_secs: f32,
    /// Factors on these seconds for edges between fully upright nodes, to a faster position and to a slower one. Crossing
    /// faster than the pack does leaves a margin.
    pub edge_secs_factors: [f32; 2],
    /// True to stay at the end of the path: on an edge, at the skill itself.
    pub stay_at_end: bool,
    /// Seconds of the clock that a timed skill sees in place of the target, as in a pack; 0 for a skill that sees the target. The
    /// clock shows the second of the clip that is tracked.
    pub clock_seconds: f32,
    /// A skill that faces one way and moves another; none for one that faces its target.
    pub strafe: Option<StrafeConfig>,
}

/// How a skill is asked to strafe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StrafeConfig {
    /// Seconds until the way to face is renewed, least and most.
    pub facing_secs: [f32; 2],
    /// Share of ways to face that jump to any direction; the others turn by up to 90 degrees at the pace of a thumb.
    pub jump_share: f32,
    /// Speed aside, as a share of the speed ahead.
    pub aside: f32,
    /// Speed backwards, as a share of the speed ahead.
    pub back: f32,
    /// How fast a thumb turns the camera, radians a second, least and most.
    pub turn_rate: [f32; 2],
    /// An episode fails where it faces further from its way than this, radians; with pi never. A policy that turns to its target
    /// by habit otherwise hardly meets what it is to learn.
    pub max_facing_error: f32,
    /// Largest angle between the way to face and the way to go, radians; pi for any. Phases that widen it by and by lead a walk to
    /// steps aside and backwards.
    pub max_angle: f32,
}

impl Default for StrafeConfig {
    fn default() -> Self {
        Self {
            facing_secs: [0.7, 4.0],
            jump_share: 0.15,
            aside: 0.6,
            back: 0.7,
            turn_rate: [0.5, 3.5],
            max_facing_error: PI,
            max_angle: PI,
        }
    }
}

impl StrafeConfig {
    /// Share of the speed ahead at an angle between facing and moving, radians: on an ellipse through ahead, aside and back.
    #[must_use]
    pub fn speed_share(&self, radians: f32) -> f32 {
        let (sin, cos) = radians.sin_cos();
        let along = if cos < 0.0 { self.back } else { 1.0 };
        ((cos / along).powi(2) + (sin / self.aside).powi(2)).sqrt().recip()
    }
}

impl Default for CommandConfig {
    fn default() -> Self {
        Self {
            speed_mps: 1.25,
            target_metres: [1.0, 10.0],
            target_secs: [2.0, 7.0],
            stop_share: 0.15,
            slow_stop_share: None,
            fast_target_factor: 1.0,
            stick_share: 0.0,
            any_direction_share: 0.1,
            assisted_share: 0.0,
            sweep_share: 0.0,
            edge_sweep_secs: [0.5, 6.0],
            edge_rest_secs: [0.0, 2.0],
            jump_share: 0.15,
            edge_secs: 0.0,
            edge_secs_factors: [1.0, 1.0],
            stay_at_end: false,
            clock_seconds: 0.0,
            strafe: None,
        }
    }
}
