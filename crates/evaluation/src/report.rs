//! All measures of a pack, in the shape of the JSON file.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;
use physics::Model;
use physics_bridge::GroundKind;
use policy_core::{BlendMode, CharacterPack, CharacterState, ControllerConfig, NodeId, PathId, SkillId};
use serde::Serialize;

use super::{
    Effort, EvaluationError, LayerReport, MotionReport, PlayerReport, Progress, RateReport, Rig, Section,
    SkillReport, UprightReport, measure_coordinates, measure_get_up, measure_layers, measure_push,
    measure_skill, measure_sweep, measure_upright, pose_error, watch,
};
use crate::response::commanded_mps;

/// All measures of a pack.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Evaluation {
    /// Name of the engine that it was measured in.
    pub engine: &'static str,
    /// By path, and in it by blend mode.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub paths: BTreeMap<String, PathReport>,
    /// Limp drops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub getup: Option<RateReport>,
    /// Rolls.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roll: Option<RateReport>,
    /// By name: all episodic skills but the one that raises a fallen character.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub skills: BTreeMap<String, SkillReport>,
    /// By policy: who is still up after 10 s of turns.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub upright: BTreeMap<String, UprightReport>,
    /// By skill.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub push: BTreeMap<String, PushReport>,
    /// By skill: mean distance of the bodies to those of its clip under dynamic time warping, metres.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub pose_error_m: BTreeMap<String, f32>,
    /// By skill: how it moves, straight ahead.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub motion: BTreeMap<String, MotionReport>,
    /// By skill: how its clip moves.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub clip_motion: BTreeMap<String, MotionReport>,
    /// By `from-to`, and in it by the layers that are half-way there: section 4.3 of the paper.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub layers: BTreeMap<String, BTreeMap<String, LayerReport>>,
    /// Share of all those cases without a fall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers_without_fall: Option<f32>,
    /// Squared distance of the parameters at the two ends of each edge.
    pub parameter_distance: BTreeMap<String, f64>,
    /// What a player feels.
    #[serde(flatten)]
    pub player: PlayerReport,
}

/// Measures along one path.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PathReport {
    /// By blend mode.
    #[serde(flatten)]
    pub modes: BTreeMap<String, ModeReport>,
    /// By ground that is not flat, see [`GroundKind::name`], blending parameters.
    pub grounds: BTreeMap<String, ModeReport>,
    /// At fixed coordinates, blending parameters.
    pub speed: Vec<SpeedPoint>,
}

/// Places the hills that paths are measured on too.
const HILLS_SEED: u32 = 7;

/// Measures of one blend mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ModeReport {
    /// Under a trigger that sweeps over the path, with random turns.
    pub falls_per_character_minute: f32,
    /// Ways up out of a crawl, under the same trigger, that took long and were left to the skill that raises fallen characters.
    pub rises_by_skill_per_character_minute: f32,
}

/// Measures at a coordinate of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SpeedPoint {
    /// Place on the path.
    pub coordinate: f32,
    /// Interpolated from the speeds of the nodes.
    pub commanded_mps: f32,
    /// Mean along the wanted direction, turns included.
    pub reached_mps: f32,
    /// With random turns.
    pub falls_per_character_minute: f32,
}

/// Largest pushes of 0.2 s that 95 of 100 survive, in steps of 15 N.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PushReport {
    /// Along the way it goes.
    pub forward_newton: f32,
    /// Across it.
    pub sideways_newton: f32,
}

/// Measures some sections and tells the progress. What a player feels, and skills but for getting up, are measured with `config`. `clips` holds the states of each skill's clips, see
/// [`clip_states`](super::clip_states); without them there is no pose error. `after_section` gets what was measured so far after each section, so
/// that a later one that fails loses nothing.
///
/// # Errors
/// When the model can't be set on uneven ground, or changed.
pub fn evaluate(
    model: &Model,
    pack: &Arc<CharacterPack>,
    config: ControllerConfig,
    (effort, sections): (&Effort, &[Section]),
    clips: &BTreeMap<String, Vec<CharacterState>>,
    progress: &Progress,
    mut after_section: impl FnMut(&Evaluation),
) -> Result<Evaluation, EvaluationError> {
    let mut evaluation = Evaluation { engine: model.engine().name(), ..Evaluation::default() };
    let graph = pack.graph();
    for edge in graph.edges() {
        let [a, b] = edge.nodes;
        let name = format!("{}-{}", graph.node(a).name, graph.node(b).name);
        let distance = pack.policies()[a.index()].squared_distance(&pack.policies()[b.index()]);
        evaluation.parameter_distance.insert(name, distance);
    }
    let rig = Rig::new(model, pack, config, *effort, progress.clone());
    progress.set_length(sections.iter().map(|section| effort.nominal_secs(*section, pack)).sum());
    let mut begun = 0.0;
    for section in sections {
        progress.begin(section.name(), begun);
        begun += effort.nominal_secs(*section, pack);
        match section {
            Section::Paths => evaluation.measure_paths(model, pack, effort)?,
            Section::Upright => evaluation.measure_upright(model, pack, effort),
            Section::Push => evaluation.measure_push(model, pack, effort),
            Section::Motion => evaluation.measure_motion(model, pack, clips),
            Section::Layers => evaluation.measure_layers(model, pack, effort),
            Section::Skills => evaluation.measure_skills(model, pack, config, effort),
            other => evaluation.player.measure(*other, &rig)?,
        }
        after_section(&evaluation);
    }
    Ok(evaluation)
}

impl Evaluation {
    fn measure_paths(
        &mut self,
        model: &Model,
        pack: &Arc<CharacterPack>,
        effort: &Effort,
    ) -> Result<(), EvaluationError> {
        let mut grounds = Vec::new();
        for kind in GroundKind::ALL.into_iter().filter(|kind| *kind != GroundKind::Flat) {
            grounds.push((kind.name(), model.with_terrain(kind.terrain(HILLS_SEED))?));
        }
        for (index, path) in pack.graph().paths().iter().enumerate() {
            let (index, mut report) = (PathId::new(index), PathReport::default());
            for mode in BlendMode::ALL {
                let swept = measure_sweep(model, pack, index, mode, (effort.characters, effort.secs));
                report.modes.insert(mode.name().into(), swept);
            }
            for (ground, model) in &grounds {
                let walkers = (effort.characters_uneven, effort.secs);
                let swept = measure_sweep(model, pack, index, BlendMode::Parameters, walkers);
                report.grounds.insert((*ground).into(), swept);
            }
            for coordinate in coordinates(path.end(), effort.coordinates) {
                let at = (effort.characters_each, effort.secs);
                let (falls, reached) =
                    measure_coordinates(model, pack, index, BlendMode::Parameters, coordinate, at);
                report.speed.push(SpeedPoint {
                    coordinate,
                    commanded_mps: commanded_mps(pack, index, coordinate),
                    reached_mps: reached,
                    falls_per_character_minute: falls,
                });
            }
            self.paths.insert(path.name().into(), report);
        }
        Ok(())
    }

    fn measure_upright(&mut self, model: &Model, pack: &Arc<CharacterPack>, effort: &Effort) {
        for (id, node) in pack.graph().originals().filter(|(_, n)| n.fall_height.is_some()) {
            let upright = measure_upright(model, pack, id, effort.characters);
            self.upright.insert(node.name.clone(), upright);
        }
    }

    fn measure_push(&mut self, model: &Model, pack: &Arc<CharacterPack>, effort: &Effort) {
        for (id, node) in pack.graph().originals().filter(|(_, n)| n.fall_height.is_some()) {
            let push = |direction| measure_push(model, pack, id, direction, effort.pushed);
            let report = PushReport { forward_newton: push(Vec3::X), sideways_newton: push(Vec3::Y) };
            self.push.insert(node.name.clone(), report);
        }
    }

    fn measure_motion(
        &mut self,
        model: &Model,
        pack: &Arc<CharacterPack>,
        clips: &BTreeMap<String, Vec<CharacterState>>,
    ) {
        for (index, node) in pack.graph().nodes().iter().enumerate().filter(|(_, n)| n.speed_mps.is_some()) {
            let states = watch(model, pack, NodeId::new(index));
            if states.is_empty() {
                continue;
            }
            self.motion.insert(node.name.clone(), MotionReport::of(pack.skeleton(), &states));
            if let Some(clip) = clips.get(&node.name) {
                self.pose_error_m.insert(node.name.clone(), pose_error(&states, clip));
                self.clip_motion.insert(node.name.clone(), MotionReport::of(pack.skeleton(), clip));
            }
        }
    }

    fn measure_layers(&mut self, model: &Model, pack: &Arc<CharacterPack>, effort: &Effort) {
        let graph = pack.graph();
        for [a, b] in graph.edges().iter().map(|e| e.nodes) {
            for (from, to) in [(a, b), (b, a)] {
                let measured = measure_layers(model, pack, (from, to), effort.layered);
                let name = format!("{}-{}", graph.node(from).name, graph.node(to).name);
                self.layers.insert(name, measured);
            }
        }
        let cases: Vec<f32> = self.layers.values().flat_map(|e| e.values().map(|r| r.without_fall)).collect();
        self.layers_without_fall = Some(cases.iter().sum::<f32>() / cases.len().max(1) as f32);
    }

    fn measure_skills(
        &mut self,
        model: &Model,
        pack: &Arc<CharacterPack>,
        config: ControllerConfig,
        effort: &Effort,
    ) {
        self.getup = measure_get_up(model, pack, "get_up", effort.drops);
        let skills = pack.skills().iter().enumerate().map(|(index, skill)| (SkillId::new(index), skill));
        for (id, skill) in skills.filter(|(id, _)| pack.recovery() != Some(*id)) {
            let report = measure_skill(model, pack, config, id, effort.drops);
            self.skills.insert(skill.name.clone(), report);
        }
        self.roll = self.skills.get("roll").map(|skill| skill.rate);
    }
}

/// So many coordinates from one end of a path to the other.
pub(super) fn coordinates(end: f32, count: usize) -> impl Iterator<Item = f32> {
    (0..count).map(move |i| end * i as f32 / (count - 1).max(1) as f32)
}
