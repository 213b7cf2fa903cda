//! What is chosen once for a controller: arithmetic, blend mode, and what the controller does by itself.

use crate::evaluator::BlendMode;
use crate::give_way::GiveWay;
use crate::ids::NodeId;
use crate::kernel::Arithmetic;
use crate::steering::Steering;
use crate::turn_assist::TurnAssist;

/// Choices that are made once for a controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControllerConfig {
    /// How products are summed.
    pub arithmetic: Arithmetic,
    /// Cache the parameters of a resting blend; see [`BlendEvaluator::new`](crate::BlendEvaluator::new).
    pub cache_blends: bool,
    /// Start the pack's recovery skill when the character has fallen.
    pub auto_recover: bool,
    /// Start it too when the character is to stand up out of a low gait and has not within 0.1 s, or within 2.2 s where the gait has a
    /// rising variant and `agility` lets it act. Otherwise it acts to and fro along the edge from 0.8 s on, and has fallen after
    /// [`RISE_SECONDS`](crate::training::RISE_SECONDS).
    pub assist_rise: bool,
    /// Node to start at. One that is not there means the first.
    pub start: NodeId,
    /// How a blend becomes an action.
    pub blend_mode: BlendMode,
    /// Time over which joint targets pass from one policy to the other when a skill starts or ends, seconds, at most 3600; 0 for
    /// a jump.
    pub handover_secs: f32,
    /// Time after a skill in which the character stays in the gait that the skill returns to, and turns little, seconds, at most
    /// 3600; 0 to go on at once.
    pub settle_secs: f32,
    /// Slow down fast gaits while the target lies far off the heading, the default; `None` to leave turning to the policies.
    pub turn_assist: Option<TurnAssist>,
    /// Hold the course and lead into turns, the default; `None` to give the policies the target as it is.
    pub steering: Option<Steering>,
    /// Stop for a moment when something holds the character up, the default; `None` to walk on against it.
    pub give_way: Option<GiveWay>,
    /// Blend gaits with their variants for rough ground where the ground is uneven, the default; where the pack has none, nothing changes.
    pub footing: bool,
    /// Blend gaits with their starting variants while the character sets off from a stand, with their turning variants while it turns, with their
    /// stopping variants while it comes to a stand, with their agile variants while it does not move yet as it is asked to, with their steady
    /// variants once it has for a while, with their resting variants where it is to go nowhere, and with their rising variants while it stands
    /// up out of them, the default; where the pack has none, nothing changes.
    pub agility: bool,
    /// Step back with the pack's first policy that strafes when the body tips over backwards, and catch a push that drives it off its course
    /// by the catching variants of its gaits, the default; where the pack has no policies for it, nothing changes.
    pub capture_steps: bool,
}

impl ControllerConfig {
    /// The default without what adjusts a command for the player's sake: turn assist, steering, giving way, capture steps. What the policies do
    /// by themselves is trained and measured so.
    #[must_use]
    pub fn unassisted() -> Self {
        Self { turn_assist: None, steering: None, give_way: None, capture_steps: false, ..Self::default() }
    }
}

impl Default for ControllerConfig {
    fn default() -> Self {
        Self {
            arithmetic: Arithmetic::Reproducible,
            cache_blends: true,
            auto_recover: true,
            assist_rise: true,
            start: NodeId::new(0),
            blend_mode: BlendMode::Parameters,
            handover_secs: 0.0,
            settle_secs: 0.5,
            turn_assist: Some(TurnAssist::default()),
            steering: Some(Steering::default()),
            give_way: Some(GiveWay::default()),
            footing: true,
            agility: true,
            capture_steps: true,
        }
    }
}
