//! What a controller did in its last tick.

use crate::blend::Blend;
use crate::evaluator::Evaluation;
use crate::ids::{NodeId, PolicyId, SkillId};
use crate::observation::TARGET_LEN;
use crate::path::GraphPosition;
use crate::skill::{Refusal, SkillEnd, SkillProgress};

/// Why a state can't be acted on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StateFault {
    /// A number is not finite.
    NonFinite,
    /// It does not have the bodies and hinges of the pack's skeleton.
    WrongSize,
}

/// What a [`Controller`](crate::Controller) did in its last tick, for a game's logic and for panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickReport {
    /// Position on the graph.
    pub position: GraphPosition,
    /// Where on the graph it is going.
    pub goal: GraphPosition,
    /// Blend weights that were evaluated.
    pub blend: Blend,
    /// What the evaluation took.
    pub evaluation: Evaluation,
    /// The target as the policy saw it; see [`target_input`](crate::target_input). The policy of a timed skill sees a clock instead.
    pub target: [f32; TARGET_LEN],
    /// The skill that runs.
    pub skill: Option<SkillProgress>,
    /// The skill that starts once the position on the graph allows it.
    pub pending_skill: Option<SkillId>,
    /// The skill that started in this tick.
    pub skill_started: Option<SkillId>,
    /// The skill that ended since the tick before, and why.
    pub skill_ended: Option<(SkillId, SkillEnd)>,
    /// The skill whose request was refused in this tick, and why.
    pub skill_refused: Option<(SkillId, Refusal)>,
    /// The root has been lower than the policies in use allow for some time.
    pub fallen: bool,
    /// Why the state was not acted on: the joint targets are those of a zero action, and nothing else was done.
    pub fault: Option<StateFault>,
    /// The tick's time differs by more than a quarter from the pack's control period. Policies and discriminators were trained at
    /// that period; a [`FixedRate`](crate::FixedRate) keeps it.
    pub off_rate: bool,
}

impl TickReport {
    /// The report of a controller that rests at `position`.
    pub(crate) fn at(position: GraphPosition) -> Self {
        Self { position, goal: position, blend: position.blend(), ..Self::default() }
    }
}

impl Default for TickReport {
    fn default() -> Self {
        Self {
            position: GraphPosition::node(NodeId::new(0)),
            goal: GraphPosition::node(NodeId::new(0)),
            blend: Blend::single(PolicyId::new(0)),
            evaluation: Evaluation::default(),
            target: [0.0; TARGET_LEN],
            skill: None,
            pending_skill: None,
            skill_started: None,
            skill_ended: None,
            skill_refused: None,
            fallen: false,
            fault: None,
            off_rate: false,
        }
    }
}
