//! What a character is asked to do during an episode: a target that is renewed, and a blend weight that moves.

use glam::Vec2;

use super::config::EnvironmentConfig;
use crate::Rng;

/// Seconds of a control tick.
pub const DT_SECS: f32 = 1.0 / 30.0;

/// Target and blend weight of one character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Where to go, world.
    pub target: Vec2,
    /// Blend weight of the child, 0 parent to 1 child.
    pub blend: f32,
    /// True when the target is to be reached and stood at.
    pub stop: bool,
    target_ticks: u32,
    blend_goal: f32,
    blend_rate: f32,
}

impl Command {
    /// A command at the start of an episode at `position`. Without an edge the blend weight is always 1.
    #[must_use]
    pub fn start(
        config: &EnvironmentConfig,
        edge: bool,
        position: Vec2,
        heading: f32,
        rng: &mut Rng,
    ) -> Self {
        let mut command = Self { blend: 1.0, blend_goal: 1.0, ..Self::default() };
        if edge {
            command.blend = draw_blend(rng);
            command.blend_goal = command.blend;
            command.start_moving(rng);
        }
        command.renew_target(config, position, Some(heading), rng);
        command
    }

    /// Moves the command on by a tick.
    pub fn advance(&mut self, config: &EnvironmentConfig, edge: bool, position: Vec2, rng: &mut Rng) {
        self.target_ticks = self.target_ticks.saturating_sub(1);
        if self.target_ticks == 0 {
            self.renew_target(config, position, None, rng);
        }
        if edge && self.blend_rate > 0.0 {
            let step = (self.blend_goal - self.blend).clamp(-self.blend_rate, self.blend_rate);
            self.blend += step;
            if self.blend == self.blend_goal && rng.chance(1.0 / 30.0) {
                self.blend_goal = draw_blend(rng);
                if rng.chance(0.15) {
                    self.blend = self.blend_goal;
                }
            }
        }
    }

    /// Half of the blend weights move, at a rate between a full sweep in 0.5 s and one in 6 s.
    fn start_moving(&mut self, rng: &mut Rng) {
        if rng.chance(0.5) {
            self.blend_rate = DT_SECS / rng.range(0.5, 6.0);
            self.blend_goal = draw_blend(rng);
        }
    }

    fn renew_target(
        &mut self,
        config: &EnvironmentConfig,
        position: Vec2,
        heading: Option<f32>,
        rng: &mut Rng,
    ) {
        let secs = rng.range(config.target_secs[0], config.target_secs[1]);
        self.target_ticks = (secs / DT_SECS).max(1.0) as u32;
        self.stop = rng.chance(config.stop);
        // Half of the first targets lie ahead, so that moving starts are not always asked to turn.
        let angle = match heading {
            Some(heading) if rng.chance(0.5) => heading + rng.range(-0.5, 0.5),
            _ => rng.angle(),
        };
        let distance =
            if self.stop { 0.0 } else { rng.range(config.target_metres[0], config.target_metres[1]) };
        self.target = position + distance * Vec2::from_angle(angle);
    }
}

/// 35 % at the child, 15 % at the parent, the rest between.
fn draw_blend(rng: &mut Rng) -> f32 {
    match rng.uniform() {
        u if u < 0.35 => 1.0,
        u if u < 0.50 => 0.0,
        _ => rng.uniform(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_edge_the_blend_stays_at_the_child() {
        let (config, mut rng) = (EnvironmentConfig::default(), Rng::new(1, 1));
        let mut command = Command::start(&config, false, Vec2::ZERO, 0.0, &mut rng);
        for _ in 0..1000 {
            command.advance(&config, false, Vec2::ZERO, &mut rng);
            assert_eq!(command.blend, 1.0);
        }
    }

    #[test]
    fn blends_and_targets_stay_in_range_and_are_renewed() {
        let (config, mut rng) = (EnvironmentConfig::default(), Rng::new(2, 1));
        let (mut at_child, mut targets, mut count) = (0, 0, 0);
        for _ in 0..200 {
            let mut command = Command::start(&config, true, Vec2::ONE, 0.0, &mut rng);
            for _ in 0..150 {
                let before = command.target;
                command.advance(&config, true, Vec2::ONE, &mut rng);
                assert!((0.0..=1.0).contains(&command.blend));
                assert!(command.target.distance(Vec2::ONE) <= 10.001);
                targets += usize::from(command.target != before);
                at_child += usize::from(command.blend == 1.0);
                count += 1;
            }
        }
        assert!(targets > 100 && (0.2..0.5).contains(&(at_child as f32 / count as f32)));
    }
}
