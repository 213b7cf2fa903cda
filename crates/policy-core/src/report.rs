//! What a controller did in its last tick.

use crate::blend::Blend;
use crate::evaluator::Evaluation;
use crate::graph::GraphPosition;
use crate::observation::TARGET_LEN;
use crate::skill::{SkillEnd, SkillProgress};

/// What a [`Controller`](crate::Controller) did in its last tick, for a game's logic and for panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickReport {
    /// Place on the graph.
    pub position: GraphPosition,
    /// Where on the graph it is going.
    pub goal: GraphPosition,
    /// Blend weights that were evaluated.
    pub blend: Blend,
    /// What the evaluation took.
    pub evaluation: Evaluation,
    /// The target as the policy saw it; see [`target_input`](crate::target_input).
    pub target: [f32; TARGET_LEN],
    /// The skill that runs.
    pub skill: Option<SkillProgress>,
    /// The skill that will start when the graph position allows it.
    pub pending_skill: Option<usize>,
    /// Index of the skill that started in this tick.
    pub skill_started: Option<usize>,
    /// The skill that ended in this tick, and why.
    pub skill_ended: Option<(usize, SkillEnd)>,
    /// The pelvis has been lower than the policies in use allow for some time.
    pub fallen: bool,
    /// The state was not finite: the joint targets are those of a zero action, and nothing else was done.
    pub non_finite: bool,
}

impl Default for TickReport {
    fn default() -> Self {
        Self {
            position: GraphPosition::node(0),
            goal: GraphPosition::node(0),
            blend: Blend::single(0),
            evaluation: Evaluation::default(),
            target: [0.0; TARGET_LEN],
            skill: None,
            pending_skill: None,
            skill_started: None,
            skill_ended: None,
            fallen: false,
            non_finite: false,
        }
    }
}
