//! What a player feels: all measures that steer through a pad, in the shape of the JSON file.

use std::collections::BTreeMap;

use physics::Engine;
use policy_core::{PathId, SkillId};
use serde::{Deserialize, Serialize};

use super::encounters::{EncounterReport, RaceReport, measure_encounters, measure_race};
use super::legs::{LegReport, measure_legs};
use super::press::{
    JumpReport, PressReport, RiseReport, bound_buttons, button_name, measure_buttons, measure_jumps,
    measure_rise,
};
use super::report::coordinates;
use super::response::{
    StartReport, StopReport, StrafeReport, StraightPoint, TurnReport, measure_starts, measure_stops,
    measure_strafe, measure_straight, measure_turns,
};
use super::stress::{
    FallReport, GetUpReport, RandomPadReport, SidesReport, measure_get_up_on_terrain, measure_pushes,
    measure_random_pad, measure_robustness, measure_terrain,
};
use super::trial::Gait;
use super::{EvaluationError, Rig, Section};

/// Measures by name.
type By<T> = BTreeMap<String, T>;

/// Coordinates of a path at which a character goes straight ahead.
pub(super) const STRAIGHT_COORDINATES: usize = 11;

/// What a player feels. Sections that were not measured are left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlayerReport {
    /// Turns, starts and stops.
    #[serde(skip_serializing_if = "ResponseReport::is_empty")]
    pub response: ResponseReport,
    /// By path: off the asked direction at eleven coordinates, degrees; `None` where the character goes nowhere.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub drift_degrees: By<Vec<Option<f32>>>,
    /// By path: everything that was measured at the same coordinates.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub straight: By<Vec<StraightPoint>>,
    /// By the way it goes from where it faces.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub strafe: By<StrafeReport>,
    /// From a crawl to its feet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crawl_to_upright: Option<RiseReport>,
    /// By gait, and in it by button.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub button_presses: By<By<PressReport>>,
    /// The button of Roll, pressed from standing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roll_from_stand: Option<PressReport>,
    /// Jumps of joint targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_target_jump: Option<JumpReport>,
    /// By gait: mean speed of the lowest point of loaded feet, metres per second.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub foot_slide_mps: By<f32>,
    /// By gait: share of ticks in which the legs are more than 1 cm inside each other, 0 to 1.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub self_overlap: By<f32>,
    /// By gait: greatest depth of the legs in each other, metres; 0 when they never touch.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub self_overlap_depth_m: By<f32>,
    /// By kind of pad.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub random_pad: By<RandomPadReport>,
    /// By ground, and in it by gait.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub terrain: By<By<FallReport>>,
    /// By ground.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub terrain_get_up: By<GetUpReport>,
    /// By case, and in it by gait.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub robustness: By<By<FallReport>>,
    /// By gait.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub push_torso: By<SidesReport>,
    /// By gait.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub push_pelvis: By<SidesReport>,
    /// By what is met.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub encounters: By<EncounterReport>,
    /// The playground's course.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub race: Option<RaceReport>,
}

/// Turns, starts and stops.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ResponseReport {
    /// From standing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<StartReport>,
    /// By gait.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub stop: By<StopReport>,
    /// By gait, and in it by `turn_<degrees>`.
    #[serde(flatten)]
    pub turns: By<By<TurnReport>>,
}

impl ResponseReport {
    /// True when nothing was measured.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl PlayerReport {
    /// Measures a section; sections of other reports measure nothing.
    ///
    /// # Errors
    /// When the model can't be set on uneven ground, or changed.
    pub fn measure(&mut self, section: Section, rig: &Rig<'_>) -> Result<(), EvaluationError> {
        match section {
            Section::Turns => {
                let turns = |gait: Gait| (gait.name.into(), measure_turns(rig, &rig.settled(&gait)));
                self.response.turns = rig.gaits_and_starts().into_iter().map(turns).collect();
            }
            Section::Starts => self.response.start = Some(measure_starts(rig)),
            Section::Stops => {
                let stops = |gait: Gait| (gait.name.into(), measure_stops(rig, &rig.settled(&gait)));
                self.response.stop = rig.gaits().into_iter().filter(Gait::moves).map(stops).collect();
            }
            Section::Straight => self.measure_straight(rig),
            Section::Strafe => self.strafe = measure_strafe(rig),
            Section::Rise => self.crawl_to_upright = Some(measure_rise(rig)),
            Section::Buttons => self.measure_buttons(rig),
            Section::Jumps => self.joint_target_jump = Some(measure_jumps(rig)),
            Section::Legs => self.measure_legs(rig),
            Section::RandomPad => self.random_pad = measure_random_pad(rig),
            Section::Terrain => self.terrain = measure_terrain(rig)?,
            Section::GetUp => self.terrain_get_up = measure_get_up_on_terrain(rig)?,
            Section::Robustness => self.robustness = measure_robustness(rig)?,
            Section::Pushes => {
                let skeleton = rig.pack.skeleton();
                let torso = skeleton.body_named("torso");
                self.push_torso = torso.map(|torso| measure_pushes(rig, torso)).unwrap_or_default();
                self.push_pelvis = measure_pushes(rig, skeleton.root());
            }
            // Shared worlds of characters and props are MuJoCo's.
            Section::Encounters if rig.model.engine() == Engine::Mujoco => {
                self.encounters = measure_encounters(rig)?;
            }
            Section::Race if rig.model.engine() == Engine::Mujoco => {
                self.race = Some(measure_race(rig)?);
            }
            _ => {}
        }
        Ok(())
    }

    fn measure_straight(&mut self, rig: &Rig<'_>) {
        for (index, path) in rig.pack.graph().paths().iter().enumerate() {
            let points: Vec<StraightPoint> = coordinates(path.end(), STRAIGHT_COORDINATES)
                .map(|coordinate| measure_straight(rig, PathId::new(index), coordinate))
                .collect();
            let drifts = points.iter().map(|point| point.drift_degrees).collect();
            self.drift_degrees.insert(path.name().into(), drifts);
            self.straight.insert(path.name().into(), points);
        }
    }

    fn measure_buttons(&mut self, rig: &Rig<'_>) {
        self.button_presses = measure_buttons(rig);
        let of_roll = |skill: &Option<SkillId>| skill.is_some() && *skill == rig.pack.skill_named("roll");
        let button = bound_buttons(rig.pack).into_iter().find(|(_, skill)| of_roll(skill));
        let presses = self.button_presses.get("idle").zip(button);
        self.roll_from_stand =
            presses.and_then(|(idle, (button, _))| idle.get(&button_name(button)).cloned());
    }

    fn measure_legs(&mut self, rig: &Rig<'_>) {
        let legs = measure_legs(rig);
        let of = |value: fn(&LegReport) -> f32| {
            legs.iter().map(|(gait, report)| (gait.clone(), value(report))).collect()
        };
        self.foot_slide_mps = of(|report| report.foot_slide_mps);
        self.self_overlap = of(|report| report.self_overlap);
        self.self_overlap_depth_m = of(|report| report.self_overlap_depth_m);
    }
}
