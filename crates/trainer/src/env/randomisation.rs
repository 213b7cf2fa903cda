//! Differences between environments: ground, strength, friction, latency and pushes. A policy that met them in training
//! keeps its balance in worlds that differ from the training's.

use glam::Vec2;
use physics_bridge::{Model, ModelError, Settings, Terrain};
use policy_core::{BodyId, Skeleton};
use serde::{Deserialize, Serialize};

use super::command::DT_SECS;
use super::env::{Env, EnvContext};

/// Length of a push, seconds.
pub(super) const PUSH_SECS: f32 = 0.2;

/// Length of a long push, seconds, least and most, and its force as a share of that of a short one.
const LONG_PUSH_SECS: [f32; 2] = [0.5, 2.0];
const LONG_PUSH_FORCE: f32 = 0.4;

/// A long push comes from at most this far off straight ahead, radians.
const LONG_PUSH_ASIDE: f32 = 0.8;

/// From crest to crest of the waves and of the slopes, metres.
const WAVELENGTH_METRES: f32 = 6.0;
const SLOPE_WAVELENGTH_METRES: f32 = 20.0;

/// Waves that differ in the places of their hills.
const WAVES: u32 = 3;

/// Height of a step as a share of the height of the waves, its depth in metres, and steps up before the steps down.
const STEP_RISE_SHARE: f32 = 0.3;
const STEP_RUN_METRES: f32 = 0.9;
const STEP_COUNT: u32 = 5;

/// Changes of strength and friction in units of [`RandomisationConfig::dynamics`]. Half of the bodies stay as they are.
const DYNAMICS: [[f32; 2]; 6] = [[0.0, 0.0], [0.0, 0.0], [-1.0, 0.0], [0.0, 0.0], [0.5, -1.5], [-0.5, 1.0]];

/// Which of these is stepped coarsely where [`RandomisationConfig::long_steps`] says so.
const LONG_STEPS_AT: usize = 1;

/// Ground, pushes and differences of the body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RandomisationConfig {
    /// Height of the hills of wavy ground, metres; zero for flat ground alone. Above zero one environment of five is flat,
    /// one has steps and three have waves.
    pub terrain_metres: f32,
    /// Height of a step where the ground has waves and steps, metres. Above zero one environment of six has steps of half this
    /// height, one of this height, three waves and one is flat. Zero for steps of 0.3 of `terrain_metres`.
    pub step_metres: f32,
    /// Height of hills of 20 m from crest to crest in place of one of the waves, metres; 2 for slopes of 7 degrees in the root mean
    /// square. Zero for three waves.
    pub slope_metres: f32,
    /// Largest relative change of the motors' strength; friction changes by up to 1.5 times as much.
    pub dynamics: f32,
    /// True for physics steps of twice the length in one environment of six, where the body differs too.
    pub long_steps: bool,
    /// Share of episodes in which every action arrives one tick late.
    pub latency_share: f32,
    /// Mean seconds between pushes of 0.2 s; zero for none.
    pub push_secs: f32,
    /// Largest force of a push, newton.
    pub push_newton: f32,
    /// Share of pushes that are long, 0.5 to 2 s with 0.4 of the force, and come from ahead: as if it walked into something.
    pub long_push_share: f32,
    /// Names of the bodies that are pushed; the root when there are none.
    pub push_bodies: Vec<String>,
}

impl RandomisationConfig {
    /// The bodies that are pushed.
    ///
    /// # Errors
    /// The name of a body that the character does not have.
    pub fn pushed(&self, skeleton: &Skeleton) -> Result<Vec<BodyId>, String> {
        if self.push_bodies.is_empty() {
            return Ok(vec![skeleton.root()]);
        }
        self.push_bodies.iter().map(|name| skeleton.body_named(name).ok_or_else(|| name.clone())).collect()
    }

    /// Every combination of ground and body that environments are spread over.
    ///
    /// # Errors
    /// When the model can't be set on a ground or changed as much.
    pub fn models(&self, model: &Model) -> Result<Vec<Model>, ModelError> {
        let mut grounds = vec![model.clone()];
        if self.terrain_metres > 0.0 {
            let rises: &[f32] = match self.step_metres {
                0.0 => &[STEP_RISE_SHARE * self.terrain_metres],
                highest => &[0.5 * highest, highest],
            };
            for rise in rises {
                let rise_m = rise.max(0.01);
                let steps = Terrain::Steps { rise_m, run_m: STEP_RUN_METRES, count: STEP_COUNT };
                grounds.push(model.with_terrain(steps)?);
            }
            for seed in 1..=WAVES {
                let (height_m, wavelength_m) = if seed == WAVES && self.slope_metres > 0.0 {
                    (self.slope_metres, SLOPE_WAVELENGTH_METRES)
                } else {
                    (self.terrain_metres, WAVELENGTH_METRES)
                };
                let waves = Terrain::Wavy { height_m, wavelength_m, seed };
                grounds.push(model.with_terrain(waves)?);
            }
        }
        if self.dynamics == 0.0 {
            return Ok(grounds);
        }
        let mut models = Vec::new();
        let bodies = DYNAMICS.map(|change| change.map(|units| 1.0 + self.dynamics * units));
        for (body, [strength, friction]) in bodies.into_iter().enumerate() {
            for ground in &grounds {
                let model = ground.with_settings(Settings { strength, friction, ..Settings::default() })?;
                let long = self.long_steps && body == LONG_STEPS_AT;
                models.push(if long { model.with_time_step(2.0)? } else { model });
            }
        }
        Ok(models)
    }
}

impl Env {
    /// Now and then begins a push in a random horizontal direction.
    pub(super) fn push(&mut self, context: &EnvContext<'_>) {
        let config = &context.config.randomisation;
        if config.push_secs > 0.0 && self.rng.chance(DT_SECS / config.push_secs) {
            let long = self.rng.chance(config.long_push_share);
            let (angle, secs, share) = if long {
                let aside = self.rng.range(-LONG_PUSH_ASIDE, LONG_PUSH_ASIDE);
                let secs = self.rng.range(LONG_PUSH_SECS[0], LONG_PUSH_SECS[1]);
                (self.heading().angle() + std::f32::consts::PI + aside, secs, LONG_PUSH_FORCE)
            } else {
                (self.rng.angle(), PUSH_SECS, 1.0)
            };
            let force = Vec2::from_angle(angle) * self.rng.uniform() * share * config.push_newton;
            self.push_body(context, force, secs);
        }
    }

    /// Begins a push on one of the bodies that are pushed.
    pub(super) fn push_body(&mut self, context: &EnvContext<'_>, force: Vec2, secs: f32) {
        let body = context.pushed[self.rng.index(context.pushed.len())];
        let within = "a recipe's push is between 0 and 5000 newton";
        match &mut self.company {
            Some(company) => company.push(body, force.extend(0.0), secs).expect(within),
            None => self.character.push(body, force.extend(0.0), secs).expect(within),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn model() -> Model {
        Model::load(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml")).unwrap()
    }

    #[test]
    fn environments_are_spread_over_grounds_and_bodies() {
        let of = |terrain_metres, dynamics| {
            let config = RandomisationConfig { terrain_metres, dynamics, ..RandomisationConfig::default() };
            config.models(&model()).unwrap()
        };
        assert_eq!(of(0.0, 0.0).len(), 1);
        let grounds = of(0.1, 0.0);
        let waves = grounds.iter().filter(|m| matches!(m.terrain(), Terrain::Wavy { .. })).count();
        let steps = grounds.iter().filter(|m| matches!(m.terrain(), Terrain::Steps { .. })).count();
        assert_eq!((grounds.len(), waves, steps), (5, 3, 1));
        let high =
            RandomisationConfig { terrain_metres: 0.1, step_metres: 0.1, ..RandomisationConfig::default() };
        let rises = high
            .models(&model())
            .unwrap()
            .iter()
            .filter_map(|m| match m.terrain() {
                Terrain::Steps { rise_m, .. } => Some(rise_m),
                _ => None,
            })
            .collect::<Vec<_>>();
        assert_eq!(rises, [0.05, 0.1]);
        let bodies = of(0.1, 0.2);
        assert_eq!(bodies.len(), 30);
        let plain = bodies.iter().filter(|m| m.settings() == Settings::default()).count();
        assert_eq!(plain, 15, "half of the bodies are as they are");
        let weakest = bodies.iter().map(|m| m.settings().strength).fold(9.0, f32::min);
        let slipperiest = bodies.iter().map(|m| m.settings().friction).fold(9.0, f32::min);
        assert!((weakest - 0.8).abs() < 1e-6 && (slipperiest - 0.7).abs() < 1e-6, "{weakest} {slipperiest}");
    }
}
