//! Where a character that strafes is to face: the way that a player's camera looks.

use glam::Vec2;
use policy_core::Heading;
use random::Rng;

use super::config::StrafeConfig;
use super::{Command, DT_SECS, QUARTER};
use crate::env::graph::TrainingGraph;

/// A character that is slower stands, metres per second.
const MOVING_MPS: f32 = 0.15;

/// A way to face that a player turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facing {
    /// Now, radians.
    radians: f32,
    /// What is left to turn, radians.
    left: f32,
    /// How fast, radians a tick.
    rate: f32,
    ticks: u32,
}

impl Facing {
    pub(super) fn along(radians: f32) -> Self {
        Self { radians, left: 0.0, rate: 0.0, ticks: 1 }
    }

    pub(super) fn advance(&mut self, config: &StrafeConfig, rng: &mut Rng) {
        let step = self.left.clamp(-self.rate, self.rate);
        self.radians += step;
        self.left -= step;
        self.ticks = self.ticks.saturating_sub(1);
        if self.ticks > 0 {
            return;
        }
        self.ticks = (rng.range(config.facing_secs[0], config.facing_secs[1]) / DT_SECS).max(1.0) as u32;
        if rng.chance(config.jump_share) {
            (self.radians, self.left) = (rng.angle(), 0.0);
        } else {
            self.left = rng.range(-1.0, 1.0) * QUARTER;
            self.rate = rng.range(config.turn_rate[0], config.turn_rate[1]) * DT_SECS;
        }
    }
}

/// An angle from the way to face to go along, at most so far from it, radians. Keys and thumbs mostly go ahead, aside or back.
pub(super) fn way_to_go(most: f32, anywhere: bool, rng: &mut Rng) -> f32 {
    let angle = if anywhere { rng.angle() } else { QUARTER * (rng.index(4) as f32 - 1.0) };
    Heading::from_angle(angle).angle().clamp(-most, most)
}

impl Command {
    /// The way to face, world; `None` where it faces its target.
    #[must_use]
    pub fn facing(&self) -> Option<Vec2> {
        self.facing.map(|facing| Vec2::from_angle(facing.radians))
    }

    /// Lets a character that strafes go on as it moves at the start of an episode, so that a command fits the clip that it begins in.
    /// Others keep their target.
    pub fn go_on(&mut self, graph: &TrainingGraph, position: Vec2, velocity: Vec2) {
        let Some(facing) = &self.facing else { return };
        self.stop = velocity.length() < MOVING_MPS;
        if !self.stop {
            self.stick = Some(velocity.to_angle() - facing.radians);
        }
        self.follow_stick(graph, position);
        self.seen_target = self.target;
    }

    /// Direction of the stick in the world, radians. That of a character that strafes turns with the camera.
    pub(super) fn stick_radians(&self) -> Option<f32> {
        let facing = self.facing.map_or(0.0, |facing| facing.radians);
        self.stick.map(|stick| stick + facing)
    }

    /// Speed that it is commanded to, metres per second: that of its position on the graph, less aside and backwards by as much as
    /// it strafes there.
    #[must_use]
    pub fn speed_mps(&self, graph: &TrainingGraph, root: Vec2) -> f32 {
        let speed = graph.speed_mps(self.position);
        match (graph.strafe(self.position), self.facing()) {
            ((share, Some(strafe)), Some(facing)) if self.target != root => {
                let aside = (self.target - root).angle_to(facing);
                speed * (1.0 + share * (strafe.speed_share(aside) - 1.0))
            }
            _ => speed,
        }
    }

    /// True when it faces further from its way than training allows where it strafes.
    #[must_use]
    pub fn faces_elsewhere(&self, graph: &TrainingGraph, heading: Heading) -> bool {
        let (share, strafe) = graph.strafe(self.position);
        let off = self.facing().map(|facing| heading.direction().angle_to(facing).abs());
        let most = strafe.map_or(f32::INFINITY, |strafe| strafe.max_facing_error);
        share > 0.5 && off.is_some_and(|off| off > most)
    }
}

#[cfg(test)]
#[path = "facing_tests.rs"]
mod tests;
