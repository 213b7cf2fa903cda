//! Settings of starts in play.

use serde::{Deserialize, Serialize};

/// What acts until a start, but for [`OutOf::Low`].
const PLAYED: &[&str] = &[
    "idle",
    "walk",
    "jog",
    "run",
    "crouch",
    "zombie_walk",
    "strafe",
    "idle_agile",
    "walk_agile",
    "jog_agile",
    "run_agile",
    "crouch_agile",
    "idle_steady",
    "walk_steady",
    "jog_steady",
    "run_steady",
    "crouch_steady",
    "walk_start",
    "walk_turn",
    "walk_catch",
    "run_catch",
    "crouch_catch",
    "idle_stop",
    "roll",
];

/// What acts until one of those.
const PLAYED_LOW: &[&str] = &[
    "idle",
    "walk",
    "crouch",
    "crawl",
    "idle_agile",
    "walk_agile",
    "crouch_agile",
    "idle_steady",
    "walk_steady",
    "crouch_steady",
    "crawl_steady",
    "walk_start",
    "walk_turn",
    "idle_stop",
    "crouch_rest",
    "crawl_rest",
];

/// Nodes for [`OutOf::Anything`]; the first one stands.
const OUT_OF: [&str; 14] = [
    "idle",
    "idle",
    "walk",
    "walk",
    "jog",
    "run",
    "crouch",
    "crouch",
    "zombie_walk",
    "strafe",
    "strafe",
    "strafe",
    "strafe",
    "strafe",
];

/// Nodes for [`OutOf::Stride`].
const STRIDES: [&str; 5] = ["walk", "walk", "jog", "jog", "run"];

/// Nodes for [`OutOf::Push`].
const PUSHED: [&str; 5] = ["walk", "jog", "run", "run", "run"];

/// Nodes for [`OutOf::PushInCrouch`].
const CROUCHED: [&str; 1] = ["crouch"];

/// Nodes for [`OutOf::Run`].
const RUNS: [&str; 3] = ["jog", "jog", "run"];

/// Nodes for [`OutOf::Low`].
const LOW: [&str; 1] = ["crawl"];

/// Starts where a game starts an episodic skill, or where a variant begins to act.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InPlayConfig {
    /// Share of episodes.
    pub share: f32,
    /// Speed below which the skill starts, as in the plan of the pack, metres per second. Leave it out for a variant of a gait. The
    /// variant of a standing gait starts up to 0.3 s after the stick is released, the variant of a moving gait from standing or mid-gait.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maximum_speed_mps: Option<f32>,
    /// Out of what it starts.
    #[serde(default)]
    pub out_of: OutOf,
    /// Where it starts out of a push: smallest force, as a share of `randomisation.push_newton`.
    #[serde(default = "least_push")]
    pub least_push: f32,
    /// Where it starts out of a push: share of those from behind, within 0.4 rad. The others come from any side.
    #[serde(default = "from_behind_share")]
    pub from_behind_share: f32,
}

fn least_push() -> f32 {
    0.3
}

/// They are the hardest to catch out of a run.
fn from_behind_share() -> f32 {
    0.5
}

impl Default for InPlayConfig {
    fn default() -> Self {
        Self {
            share: 1.0,
            maximum_speed_mps: None,
            out_of: OutOf::Anything,
            least_push: least_push(),
            from_behind_share: from_behind_share(),
        }
    }
}

/// What a character does before it starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OutOf {
    /// Any gait but a crawl, with turns, halts and rolls.
    #[default]
    Anything,
    /// It stands, for a variant that sets off.
    Stand,
    /// It walks, jogs or runs, for a variant that turns, or that stops: that one starts as soon as the stick is released.
    Stride,
    /// It jogs or runs, and a foot comes down, for a skill that starts so.
    Run,
    /// It walks, jogs or runs, half of the time straight ahead, and is being pushed by up to `randomisation.push_newton`: for a variant that
    /// catches it. It is to go on.
    Push,
    /// The same in a crouch.
    PushInCrouch,
    /// It crawls, rests there, or is on its way down, for a variant that rises.
    Low,
}

impl OutOf {
    /// Of so many starts one each is out of these nodes.
    pub(super) fn nodes(self) -> &'static [&'static str] {
        match self {
            Self::Anything => &OUT_OF,
            Self::Stand => &OUT_OF[..1],
            Self::Stride => &STRIDES,
            Self::Run => &RUNS,
            Self::Push => &PUSHED,
            Self::PushInCrouch => &CROUCHED,
            Self::Low => &LOW,
        }
    }

    /// The gaits that lead up to the start, their variants, and a skill that may have ended just before it.
    pub(crate) fn played(self) -> &'static [&'static str] {
        if self == Self::Low { PLAYED_LOW } else { PLAYED }
    }

    /// Whether it starts in the middle of a stride.
    pub(super) fn strides(self) -> bool {
        matches!(self, Self::Stride | Self::Run) || self.pushes()
    }

    /// Whether it starts in the middle of a push.
    pub(crate) fn pushes(self) -> bool {
        matches!(self, Self::Push | Self::PushInCrouch)
    }
}
