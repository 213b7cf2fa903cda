//! The mutable state of one controller as plain data: to save, send and restore.
//!
//! It holds all that the next tick depends on and no parameters of policies. Restored into a controller of the same pack
//! and configuration, the next ticks give the same bits.

use alloc::vec::Vec;

use crate::agility::Urgency;
use crate::capture_step::CaptureStep;
use crate::evaluator::BlendRest;
use crate::fall::FallDetector;
use crate::features::FrameHistory;
use crate::give_way::GiveWayState;
use crate::ids::SkillId;
use crate::pack::CharacterPack;
use crate::report::TickReport;
use crate::rising::Rise;
use crate::state::JointTargets;
use crate::steering::SteeringState;
use crate::variants::Lasting;

/// State of one [`Controller`](crate::Controller). Made once for a pack, then overwritten by
/// [`Controller::save_into`](crate::Controller::save_into).
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerState {
    pub(crate) report: TickReport,
    pub(crate) fall: FallDetector,
    pub(crate) history: FrameHistory,
    pub(crate) rest: BlendRest,
    /// The skill that was dropped between ticks; the next tick reports it.
    pub(crate) interrupted: Option<SkillId>,
    pub(crate) targets: JointTargets,
    /// Joint targets that a skill took over from.
    pub(crate) handover_from: Vec<f32>,
    /// Seconds that the hand-over takes yet.
    pub(crate) handover_secs: f32,
    /// Seconds that it settles yet after a skill.
    pub(crate) settle_secs: f32,
    /// Seconds that the pending skill has waited.
    pub(crate) pending_secs: f32,
    /// What steering remembers.
    pub(crate) steering: SteeringState,
    /// What giving way remembers.
    pub(crate) give_way: GiveWayState,
    /// How uneven the ground is, in [0, 1].
    pub(crate) unevenness: f32,
    /// How far the character is from what it is asked to do.
    pub(crate) urgency: Urgency,
    /// How it steps under a body that tips over.
    pub(crate) capture_step: CaptureStep,
    /// How it catches a push.
    pub(crate) catch: Lasting,
    /// How it stands up out of a low gait.
    pub(crate) rising: Rise,
}

/// Why a state can't be restored. The controller is unchanged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// The bytes have another length.
    #[error("expected {expected} bytes of a controller's state, found {found}")]
    Length {
        /// Length for this pack.
        expected: usize,
        /// Length of the bytes.
        found: usize,
    },
    /// The bytes are of another version, or no state at all.
    #[error("expected a controller's state of version {expected}, found {found}")]
    Version {
        /// The version that this library reads.
        expected: u32,
        /// First four bytes, as a number.
        found: u32,
    },
    /// A field has a value that no controller of this pack can have.
    #[error("expected {expected} in {field} of a controller's state")]
    Field {
        /// The field.
        field: &'static str,
        /// What it should hold.
        expected: &'static str,
    },
}

impl ControllerState {
    /// The state of a new controller of `pack`. Allocates; nothing else here does.
    #[must_use]
    pub fn new(pack: &CharacterPack) -> Self {
        let skeleton = pack.skeleton();
        Self {
            report: TickReport::default(),
            fall: FallDetector::default(),
            history: FrameHistory::new(skeleton.frame_len()),
            rest: BlendRest::default(),
            interrupted: None,
            targets: JointTargets::new(skeleton),
            handover_from: alloc::vec![0.0; skeleton.joint_count()],
            handover_secs: 0.0,
            settle_secs: 0.0,
            pending_secs: 0.0,
            steering: SteeringState::default(),
            give_way: GiveWayState::default(),
            unevenness: 0.0,
            urgency: Urgency::default(),
            capture_step: CaptureStep::default(),
            catch: Lasting::default(),
            rising: Rise::default(),
        }
    }

    /// What the controller did in its last tick.
    #[must_use]
    pub fn report(&self) -> &TickReport {
        &self.report
    }

    /// Copies `other` without allocating.
    ///
    /// # Panics
    /// When `other` was made for a pack with another skeleton.
    pub fn copy_from(&mut self, other: &Self) {
        assert!(self.same_size(other), "states of one skeleton");
        self.report = other.report;
        self.fall = other.fall;
        self.history.copy_from(&other.history);
        self.rest = other.rest;
        self.interrupted = other.interrupted;
        self.targets.copy_from_slice(&other.targets);
        self.handover_from.copy_from_slice(&other.handover_from);
        self.handover_secs = other.handover_secs;
        self.settle_secs = other.settle_secs;
        self.pending_secs = other.pending_secs;
        self.steering = other.steering;
        self.give_way = other.give_way;
        self.unevenness = other.unevenness;
        self.urgency = other.urgency;
        self.capture_step = other.capture_step;
        self.catch = other.catch;
        self.rising = other.rising;
    }

    /// Makes it the state of a new controller again.
    pub(crate) fn clear(&mut self) {
        self.report = TickReport::default();
        self.fall.reset();
        self.history.reset();
        self.rest = BlendRest::default();
        self.interrupted = None;
        self.targets.fill(0.0);
        self.handover_from.fill(0.0);
        self.handover_secs = 0.0;
        self.settle_secs = 0.0;
        self.pending_secs = 0.0;
        self.steering = SteeringState::default();
        self.give_way = GiveWayState::default();
        self.unevenness = 0.0;
        self.urgency = Urgency::default();
        self.capture_step = CaptureStep::default();
        self.catch = Lasting::default();
        self.rising = Rise::default();
    }

    pub(crate) fn same_size(&self, other: &Self) -> bool {
        self.targets.len() == other.targets.len()
            && self.history.parts().0.len() == other.history.parts().0.len()
    }
}
