//! What a controller did in its last tick.

use std::mem::MaybeUninit;

use policy_core::training::Evaluation;
use policy_core::{GraphPosition, Refusal, SkillEnd, SkillId, StateFault, TickReport};

use crate::border::{id, present};
use crate::command::PsBlendTerm;
use crate::controller::PsController;
use crate::error::{PsStatus, guard};
use crate::{PS_MAX_BLEND_TERMS, PS_NONE};

/// What an evaluation took.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsEvaluation {
    /// One policy.
    Single = 0,
    /// Interpolated parameters, cached in an earlier tick.
    Cached = 1,
    /// Interpolated parameters, without building them.
    Fused = 2,
    /// Every policy, actions interpolated.
    Actions = 3,
}

/// Why an episodic skill ended.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsSkillEnd {
    /// The discriminator recognised the motion to return to.
    Recognised = 0,
    /// The time limit was reached.
    TimeLimit = 1,
    /// Another skill took over, or the controller was reset or put elsewhere.
    Interrupted = 2,
}

/// Why a requested skill does not start.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsRefusal {
    /// The recovery skill was requested while the character is up.
    Upright = 0,
    /// The pack has no such skill.
    Unknown = 1,
    /// It was pending for 4 s and could not start.
    TookTooLong = 2,
    /// It was pending when the recovery skill started after a fall.
    Fell = 3,
}

/// Why the state was not acted on.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsFault {
    /// It was acted on.
    None = 0,
    /// A number is not finite, or a quaternion is not of length 1.
    BadNumber = 1,
    /// It does not have the bodies and hinges of the skeleton.
    WrongSize = 2,
}

/// A position on the graph: `t` in [0, 1] of the way from one node to another.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PsPosition {
    /// Node at 0.
    pub from_node: i32,
    /// Node at 1.
    pub to_node: i32,
    /// How far between them.
    pub t: f32,
}

/// What a controller did in its last tick.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PsReport {
    /// Position on the graph.
    pub position: PsPosition,
    /// Where on the graph it is going.
    pub goal: PsPosition,
    /// Blend weights that were evaluated: the first blend_count entries.
    pub blend: [PsBlendTerm; PS_MAX_BLEND_TERMS],
    /// Policies of the blend.
    pub blend_count: usize,
    /// PsEvaluation.
    pub evaluation: i32,
    /// The target as the policy saw it.
    pub target: [f32; 2],
    /// The skill that runs, or PS_NONE.
    pub skill: i32,
    /// Seconds since it started.
    pub skill_secs: f32,
    /// Latest score of its discriminator, in [0, 1]; NaN before there is one.
    pub skill_score: f32,
    /// The skill that starts once the position on the graph allows it, or PS_NONE.
    pub pending_skill: i32,
    /// The skill that started in this tick, or PS_NONE.
    pub started_skill: i32,
    /// The skill that ended since the tick before, or PS_NONE.
    pub ended_skill: i32,
    /// PsSkillEnd; PS_NONE when none ended.
    pub skill_end: i32,
    /// The skill whose request was refused in this tick, or PS_NONE.
    pub refused_skill: i32,
    /// PsRefusal; PS_NONE when none was refused.
    pub refusal: i32,
    /// 1: the root has been lower than the policies in use allow for some time.
    pub fallen: i32,
    /// PsFault. When it is not 0, the joint targets are those of a zero action and nothing else was done.
    pub fault: i32,
    /// 1: the tick's time differs by more than a quarter from the control period.
    pub off_rate: i32,
}

/// Writes what the controller did in its last tick. Does not allocate.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_report(
    controller: Option<&PsController>,
    report: Option<&mut MaybeUninit<PsReport>>,
) -> PsStatus {
    guard(|| {
        let (controller, out) =
            (present("a controller", controller)?, present("the place of a report", report)?);
        out.write(PsReport::from(controller.controller.report()));
        Ok(())
    })
}

impl From<&TickReport> for PsReport {
    fn from(report: &TickReport) -> Self {
        let mut blend = [PsBlendTerm::default(); PS_MAX_BLEND_TERMS];
        for (slot, term) in blend.iter_mut().zip(report.blend.terms()) {
            *slot = PsBlendTerm { policy: id(term.policy.index()), weights: term.weights };
        }
        let skill = |skill: Option<SkillId>| skill.map_or(PS_NONE, |s| id(s.index()));
        Self {
            position: position(report.position),
            goal: position(report.goal),
            blend,
            blend_count: report.blend.terms().len(),
            evaluation: match report.evaluation {
                Evaluation::Single => PsEvaluation::Single,
                Evaluation::Cached => PsEvaluation::Cached,
                Evaluation::Fused => PsEvaluation::Fused,
                Evaluation::Actions => PsEvaluation::Actions,
            } as i32,
            target: report.target,
            skill: skill(report.skill.map(|s| s.skill)),
            skill_secs: report.skill.map_or(0.0, |s| s.seconds),
            skill_score: report.skill.and_then(|s| s.score).unwrap_or(f32::NAN),
            pending_skill: skill(report.pending_skill),
            started_skill: skill(report.skill_started),
            ended_skill: skill(report.skill_ended.map(|(s, _)| s)),
            skill_end: report.skill_ended.map_or(PS_NONE, |(_, why)| match why {
                SkillEnd::Recognised => PsSkillEnd::Recognised as i32,
                SkillEnd::TimeLimit => PsSkillEnd::TimeLimit as i32,
                SkillEnd::Interrupted => PsSkillEnd::Interrupted as i32,
            }),
            refused_skill: skill(report.skill_refused.map(|(s, _)| s)),
            refusal: report.skill_refused.map_or(PS_NONE, |(_, why)| match why {
                Refusal::Upright => PsRefusal::Upright as i32,
                Refusal::Unknown => PsRefusal::Unknown as i32,
                Refusal::TookTooLong => PsRefusal::TookTooLong as i32,
                Refusal::Fell => PsRefusal::Fell as i32,
            }),
            fallen: report.fallen.into(),
            fault: match report.fault {
                None => PsFault::None,
                Some(StateFault::NonFinite) => PsFault::BadNumber,
                Some(StateFault::WrongSize) => PsFault::WrongSize,
            } as i32,
            off_rate: report.off_rate.into(),
        }
    }
}

fn position(at: GraphPosition) -> PsPosition {
    PsPosition { from_node: id(at.from.index()), to_node: id(at.to.index()), t: at.t }
}
