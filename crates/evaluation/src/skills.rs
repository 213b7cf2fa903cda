//! Episodic skills: out of a heap of limbs onto the feet, and over the shoulder back into a walk.

use std::sync::Arc;

use glam::Vec2;
use physics::{Model, PhysicsCharacter};
use policy_core::contract::WALKING_START_MPS;
use policy_core::training::TARGET_RANGE_METRES;
use policy_core::{CharacterPack, CharacterState, Command, ControllerConfig, Heading, SkillEnd, SkillId};
use random::Rng;
use random::limp::drop_limp;
use rayon::prelude::*;
use serde::Serialize;

use super::eval_character::{EvalCharacter, SETTLE_SECS};
use crate::trial::{TICK_SECS, median};

mod limbs;

use limbs::{Limbs, hands};

/// Seconds within which a dropped character must stand.
const GET_UP_SECS: f32 = 5.0;

/// Seconds within which an episodic skill must be over.
const SKILL_SECS: f32 = 3.0;

/// The directions of the tries differ from straight ahead by at most this, radians.
const ASIDE: f32 = 0.52;

/// Body whose x axis tells which way a lying character faces; the root where there is none.
const FACING: &str = "torso";

/// A share of tries that went well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RateReport {
    /// 0 to 1.
    pub success: f32,
    /// Tries.
    pub tries: usize,
    /// Share that the discriminator ended, not the time limit; of a skill without one, that the time ended.
    pub recognised: f32,
    /// Mean seconds until it did.
    pub seconds: f32,
}

impl RateReport {
    /// Of tries, each with whether it went well and the seconds after which the discriminator ended it, if it did.
    fn of(tries: &[(bool, Option<f32>)]) -> Self {
        let count = tries.len().max(1) as f32;
        let ended: Vec<f32> = tries.iter().filter_map(|(_, secs)| *secs).collect();
        Self {
            success: tries.iter().filter(|(well, _)| *well).count() as f32 / count,
            tries: tries.len(),
            recognised: ended.len() as f32 / count,
            seconds: ended.iter().sum::<f32>() / ended.len().max(1) as f32,
        }
    }
}

/// Tries of an episodic skill, and how high the feet and how far the hands go while it runs: medians over the tries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SkillReport {
    /// How many went well.
    #[serde(flatten)]
    pub rate: RateReport,
    /// Greatest height of the lowest point of a foot above the ground, metres: how high it kicks.
    pub foot_m: Option<f32>,
    /// The same of the lower foot: how high it jumps.
    pub jump_m: Option<f32>,
    /// Seconds in which both feet are off the ground.
    pub air_s: Option<f32>,
    /// Seconds from the press to the beginning of the longest time in which both feet are off the ground; `None` where most never are.
    pub leaves_s: Option<f32>,
    /// Greatest horizontal distance of a hand ahead of the root, metres: how far it punches. `None` without bodies of such a name.
    pub hand_m: Option<f32>,
    /// Greatest angle between the heading of the root and that at the start of the skill, degrees: how far a jump twists.
    pub turned_degrees: Option<f32>,
}

/// Limp drops after which the character stands within 5 s and still does a second later. `None` when the pack has no skill
/// of this name.
#[must_use]
pub fn measure_get_up(
    model: &Model,
    pack: &Arc<CharacterPack>,
    skill: &str,
    drops: usize,
) -> Option<RateReport> {
    let skill = pack.skill_named(skill)?;
    let tries: Vec<_> = (0..drops).into_par_iter().map(|i| gets_up(model, pack, skill, i as u64)).collect();
    Some(RateReport::of(&tries))
}

fn gets_up(model: &Model, pack: &Arc<CharacterPack>, skill: SkillId, seed: u64) -> (bool, Option<f32>) {
    let mut eval = EvalCharacter::new(model, pack, "idle");
    let mut rng = Rng::new(seed, 11);
    if !drop_on_the_spot(&mut eval, &mut rng) {
        return (false, None);
    }
    let mut command = Command { skill: Some(skill), ..Command::default() };
    let (mut stood, mut ended) = (0.0, None);
    for tick in 0..((GET_UP_SECS + 1.0) / TICK_SECS) as u32 {
        if !eval.tick(&command) {
            return (false, ended);
        }
        command.skill = None;
        if let Some((_, SkillEnd::Recognised)) = eval.controller.report().skill_ended {
            ended = Some(tick as f32 * TICK_SECS);
        }
        let up = eval.is_upright();
        stood = if up { stood + TICK_SECS } else { 0.0 };
    }
    // Up at the end, and so since five seconds after the drop.
    (stood >= 1.0, ended)
}

fn drop_on_the_spot(eval: &mut EvalCharacter, rng: &mut Rng) -> bool {
    let sound = drop_limp(&mut eval.character, Vec2::ZERO, rng);
    eval.character.sense_into(&mut eval.state);
    sound
}

/// States of an episodic skill from its start until half a second after its end: the skill that raises a fallen character
/// starts limp on the ground, on its face or on its back, any other out of the node it returns to.
#[must_use]
pub fn watch_skill(
    model: &Model,
    pack: &Arc<CharacterPack>,
    skill: SkillId,
    on_its_face: bool,
) -> Vec<CharacterState> {
    let back = pack.skills()[skill.index()].returns_to;
    let mut eval = EvalCharacter::new(model, pack, &pack.graph().node(back).name);
    if pack.recovery() == Some(skill) {
        let body = pack.skeleton().body_named(FACING).unwrap_or_else(|| pack.skeleton().root());
        let sign = if on_its_face { -1.0 } else { 1.0 };
        let lies = |s: &EvalCharacter| sign * (s.state.body(body).rotation * glam::Vec3::X).z > 0.5;
        let lying = (0..100).any(|seed| drop_on_the_spot(&mut eval, &mut Rng::new(seed, 11)) && lies(&eval));
        if !lying {
            return Vec::new();
        }
    } else {
        for _ in 0..(SETTLE_SECS / TICK_SECS) as u32 {
            let command = eval.ahead(back);
            eval.tick(&command);
        }
    }
    let mut request = Some(skill);
    let mut states = vec![eval.state.clone()];
    let mut after = 0.0;
    while after < 0.5 && states.len() < 300 {
        let mut command = Command { skill: request.take(), ..eval.ahead(back) };
        if pack.recovery() == Some(skill) {
            command.target = None;
        }
        if !eval.tick(&command) {
            break;
        }
        states.push(eval.state.clone());
        after = if eval.controller.report().skill.is_some() { 0.0 } else { after + TICK_SECS };
    }
    states
}

/// Tries of an episodic skill under a player's controller with `config`, out of the node it returns to, walking or standing, that end within 3 s as they are
/// meant to, and after which the character is still up a second later. Each is set down at another speed and goes in another direction, up
/// to 30 degrees aside, for 2 to 5 s beforehand.
///
/// # Panics
/// When the pack has no such skill.
#[must_use]
pub fn measure_skill(
    model: &Model,
    pack: &Arc<CharacterPack>,
    config: ControllerConfig,
    skill: SkillId,
    tries: usize,
) -> SkillReport {
    let start = pack.skills()[skill.index()].returns_to;
    let config = ControllerConfig { start, ..config };
    let tries: Vec<_> =
        (0..tries).into_par_iter().map(|i| comes_back(model, pack, config, skill, i as u64)).collect();
    let rates: Vec<_> = tries.iter().map(|(well, ended, _)| (*well, *ended)).collect();
    let of = |number: fn(&Limbs) -> Option<f32>| median(tries.iter().map(|(_, _, limbs)| number(limbs)));
    SkillReport {
        rate: RateReport::of(&rates),
        foot_m: of(|limbs| Some(limbs.highest)),
        jump_m: of(|limbs| Some(limbs.lower)),
        air_s: of(|limbs| Some(limbs.air_secs)),
        leaves_s: of(|limbs| limbs.longest.map(|[begins, _]| begins)),
        hand_m: of(|limbs| limbs.hand),
        turned_degrees: of(|limbs| Some(limbs.turned.to_degrees())),
    }
}

/// True for the end that a skill is meant to have: by its discriminator, or by its time where it has none.
pub(crate) fn ended_well(pack: &CharacterPack, skill: SkillId, end: SkillEnd) -> bool {
    let by_time = pack.skills()[skill.index()].discriminator.is_none();
    end == if by_time { SkillEnd::TimeLimit } else { SkillEnd::Recognised }
}

fn comes_back(
    model: &Model,
    pack: &Arc<CharacterPack>,
    config: ControllerConfig,
    skill: SkillId,
    seed: u64,
) -> (bool, Option<f32>, Limbs) {
    let mut eval = EvalCharacter::with_config(model, pack, config);
    let mut rng = Rng::new(seed, 13);
    let start = ((SETTLE_SECS + rng.range(0.0, 3.0)) / TICK_SECS) as u32;
    let aside = Vec2::from_angle(rng.range(-ASIDE, ASIDE));
    eval.set_down(Heading::FORWARD, rng.range(0.0, WALKING_START_MPS));
    let (mut ended, mut limbs) = (None, Limbs::default());
    let hands = hands(pack.skeleton());
    for tick in 0..start + ((SKILL_SECS + 1.0) / TICK_SECS) as u32 {
        let ahead = eval.ahead(config.start);
        let target = ahead.target.map(|_| eval.position() + TARGET_RANGE_METRES * aside);
        let command = Command { skill: (tick == start).then_some(skill), target, ..ahead };
        if !eval.tick(&command) || (tick < start && eval.controller.report().fallen) {
            return (false, ended, limbs);
        }
        let report = eval.controller.report();
        if report.skill.is_some() {
            let feet = pack.skeleton().feet().iter();
            let secs = tick.saturating_sub(start) as f32 * TICK_SECS;
            limbs = limbs.after(secs, feet.map(|foot| eval.character.clearance_of(*foot)));
            limbs = limbs.reaching(&eval.state, &hands).turning(&eval.state);
        }
        if let Some((skill, end)) = report.skill_ended
            && ended_well(pack, skill, end)
        {
            ended = Some((tick - start) as f32 * TICK_SECS);
        }
    }
    (ended.is_some_and(|secs| secs <= SKILL_SECS) && eval.pelvis_height() > 0.65, ended, limbs)
}
