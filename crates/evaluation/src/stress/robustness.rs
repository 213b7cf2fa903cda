//! A body and a world that differ from training: latency, noise, strength, friction, gravity, mass, time step; in every gait.

use std::collections::BTreeMap;

use physics::{Model, ModelError};
use policy_core::contract::Settings;

use super::roam::{FallReport, roam};
use crate::Rig;
use crate::chosen::{Chosen, Named};

/// Standard deviation of the noise on actions.
const ACTION_NOISE: f32 = 0.1;

/// What differs from training.
#[derive(Clone, Copy, Debug)]
enum Change {
    Nothing,
    LateTick,
    Noise,
    Settings(fn(&mut Settings)),
    /// Factor on the length of a physics step.
    TimeStep(f64),
    /// Kilograms on the back.
    Load(f32),
}

const CASES: [(&str, Change); 14] = [
    ("none", Change::Nothing),
    ("latency_1_tick", Change::LateTick),
    ("strength_x0.8", Change::Settings(|settings| settings.strength = 0.8)),
    ("strength_x1.2", Change::Settings(|settings| settings.strength = 1.2)),
    ("friction_x0.5", Change::Settings(|settings| settings.friction = 0.5)),
    ("friction_x1.5", Change::Settings(|settings| settings.friction = 1.5)),
    ("gravity_x0.8", Change::Settings(|settings| settings.gravity = 0.8)),
    ("gravity_x1.2", Change::Settings(|settings| settings.gravity = 1.2)),
    ("mass_x0.8", Change::Settings(|settings| settings.mass = 0.8)),
    ("mass_x1.2", Change::Settings(|settings| settings.mass = 1.2)),
    ("timestep_x0.5", Change::TimeStep(0.5)),
    ("timestep_x2", Change::TimeStep(2.0)),
    ("action_noise_0.1", Change::Noise),
    ("load_5kg", Change::Load(5.0)),
];

/// The cases of a body or a world that differ from training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CaseList;

impl Named for CaseList {
    fn names() -> Vec<&'static str> {
        CASES.map(|(name, _)| name).into()
    }
}

/// Some of these cases.
pub type Cases = Chosen<CaseList>;

/// Falls by case, and in it by gait.
///
/// # Errors
/// When the model can't be changed so.
pub fn measure_robustness(
    rig: &Rig<'_>,
) -> Result<BTreeMap<String, BTreeMap<String, FallReport>>, ModelError> {
    let seeds: Vec<u64> = (0..rig.effort.roamers as u64).collect();
    let secs = rig.effort.roam_secs;
    let mut cases = BTreeMap::new();
    for (name, change) in CASES.into_iter().filter(|(name, _)| rig.effort.cases.contains(name)) {
        let model = changed(rig.model, change)?;
        let measure = |gait: &_| {
            rig.each(&seeds, secs, |seed| {
                roam(
                    rig,
                    &model,
                    gait,
                    |none, trial, rng| match change {
                        Change::LateTick => none.late(trial.controller.joint_targets()),
                        Change::Noise => none.noisy(rig.pack.action(), ACTION_NOISE, rng),
                        _ => none,
                    },
                    (secs, *seed),
                )
            })
        };
        let gaits = rig.gaits();
        let falls = gaits.iter().map(|gait| (gait.name.into(), FallReport::of(&measure(gait), secs)));
        cases.insert(name.into(), falls.collect());
    }
    Ok(cases)
}

fn changed(model: &Model, change: Change) -> Result<Model, ModelError> {
    match change {
        Change::Settings(change) => {
            let mut settings = model.described().settings();
            change(&mut settings);
            model.with_settings(settings)
        }
        Change::TimeStep(factor) => Model::new(&model.described().with_time_step(factor)?, model.engine()),
        Change::Load(kg) => {
            let loaded = loaded(model.described().mjcf(), kg);
            let skeleton = model.skeleton().clone();
            Model::new(&physics_bridge::Model::from_mjcf_with_skeleton(&loaded, skeleton)?, model.engine())
        }
        Change::Nothing | Change::LateTick | Change::Noise => Ok(model.clone()),
    }
}

/// The text with a box on the back of the body called torso, which nothing touches.
fn loaded(mjcf: &str, kg: f32) -> String {
    let Some((before, body)) = mjcf.split_once("<body name=\"torso\"") else { return mjcf.to_owned() };
    let Some((attributes, rest)) = body.split_once('>') else { return mjcf.to_owned() };
    let load = format!(
        "<geom name=\"load\" type=\"box\" size=\".08 .14 .18\" pos=\"-.2 0 .12\" mass=\"{kg}\" contype=\"0\" conaffinity=\"0\"/>"
    );
    format!("{before}<body name=\"torso\"{attributes}>{load}{rest}")
}

#[cfg(test)]
mod tests {
    use physics::Engine;

    use super::*;

    const HUMANOID: &str = include_str!("../../../../assets/humanoid.xml");

    #[test]
    fn every_case_is_what_its_name_says() {
        let model = physics_bridge::Model::from_mjcf(HUMANOID).unwrap();
        let model = Model::new(&model, Engine::Mujoco).unwrap();
        for (name, change) in CASES {
            let other = changed(&model, change).unwrap();
            let (other, model) = (other.described(), model.described());
            let mass = (other.mass_kg() / model.mass_kg()) as f32;
            let expected = match name {
                "mass_x0.8" => (0.8, 4),
                "mass_x1.2" => (1.2, 4),
                "load_5kg" => (((model.mass_kg() + 5.0) / model.mass_kg()) as f32, 4),
                "timestep_x0.5" => (1.0, 8),
                "timestep_x2" => (1.0, 2),
                _ => (1.0, 4),
            };
            assert!((mass - expected.0).abs() < 1e-3 && other.substeps() == expected.1, "{name}: {mass}");
        }
    }
}
