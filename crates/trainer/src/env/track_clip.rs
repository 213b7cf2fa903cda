//! Clip tracking: one skill from a phase of its clip until the tracking error exceeds its threshold, or, of skills trained
//! together, the clips of whatever node the character rests at.

use policy_core::NodeId;
use policy_core::training::{ActionScaling, clock_input};

use super::demonstrations::{ClipPhase, Demonstrations};
use super::env::{Env, EnvContext};
use super::tracking::TrackedState;
use crate::ppo::Done;

/// Ticks for which a character that did not start in the clip may be far from it.
const FREE_TICKS: u32 = 20;

/// The same for a cycle, which it may join at any phase: a change of stance takes longer.
const FREE_TICKS_OF_CYCLE: u32 = 45;

/// Ticks after which a character that tracks a cycle continues from the nearest phase around: a policy that does not know the
/// time keeps its own pace.
const PACE_TICKS: u32 = 60;

/// Ticks before and after that count as around. If any phase counted, a character would never have to step.
const AROUND_TICKS: usize = 15;

/// Ticks without tracking and its reward after the tracking error of a node's clip exceeded its threshold.
const LOST_TICKS: u32 = 30;

/// What a character tracks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracking {
    /// Whose clips.
    node: usize,
    /// Where in them it should be now.
    phase: ClipPhase,
    /// Ticks for which it may still be far from it.
    free_ticks: u32,
    /// Ticks since the phase was chosen.
    ticks: u32,
}

impl Tracking {
    /// Near a node's clips from this phase on.
    pub(super) fn at_once(node: usize, phase: ClipPhase) -> Self {
        Self { node, phase, free_ticks: 0, ticks: 0 }
    }

    /// From this phase of a node's clips on, and near them after a while.
    pub(super) fn soon(node: usize, phase: ClipPhase) -> Self {
        Self { free_ticks: FREE_TICKS, ..Self::at_once(node, phase) }
    }

    /// From elsewhere into a node's clips: to this beginning soon, or into a cycle at its nearest phase after a while.
    pub(super) fn into_clips(node: usize, beginning: ClipPhase, clips: &Demonstrations) -> Self {
        let free_ticks = if clips.loops(beginning) { FREE_TICKS_OF_CYCLE } else { FREE_TICKS };
        Self { free_ticks, ..Self::at_once(node, beginning) }
    }

    /// A tick later; `None` when the clip is over.
    fn next(self, clips: &Demonstrations) -> Option<Self> {
        let phase = clips.after(self.phase)?;
        Some(Self { phase, free_ticks: self.free_ticks.saturating_sub(1), ticks: self.ticks + 1, ..self })
    }

    /// The same, or in a cycle the nearest phase: any one at the end of the free ticks, one around after a while.
    fn in_pace(self, is: &TrackedState, clips: &Demonstrations) -> Self {
        if !clips.loops(self.phase) || (self.ticks < PACE_TICKS && self.free_ticks != 1) {
            return self;
        }
        if self.free_ticks == 1 {
            return Self { phase: clips.nearest(is), ticks: 0, ..self };
        }
        Self { phase: clips.nearest_around(self.phase, AROUND_TICKS, is), ticks: 0, ..self }
    }

    /// The same, or its mirror image where that is nearer, during the free ticks. Afterwards it keeps to one of them: a
    /// character that may change over at every phase never has to put the other foot forward.
    fn this_way_round(self, is: &TrackedState, clips: &Demonstrations) -> Self {
        if self.free_ticks == 0 {
            return self;
        }
        let other = clips.mirrored(self.phase);
        let nearer = is.reward(clips.tracked_at(other)) > is.reward(clips.tracked_at(self.phase));
        if nearer { Self { phase: other, ..self } } else { self }
    }

    /// Tracking reward, and whether the tracking error exceeds its threshold.
    fn compare(self, is: &TrackedState, context: &EnvContext<'_>) -> (f32, bool) {
        let wanted = context.demonstrations[self.node].tracked_at(self.phase);
        let max_tracking_error_metres = context.graph.nodes()[self.node].max_tracking_error_metres;
        (is.reward(wanted), self.free_ticks == 0 && is.exceeds(wanted, max_tracking_error_metres))
    }
}

impl Env {
    /// Writes the action that would track the clip from here, the target of behaviour cloning; NaN when there is none.
    pub fn reference_action_into(&self, context: &EnvContext<'_>, scaling: &ActionScaling, out: &mut [f32]) {
        match self.tracking {
            Some(Tracking { node, phase, .. }) => {
                context.demonstrations[node].ahead_into(phase, out);
                for ((out, centre), gain) in out.iter_mut().zip(scaling.centre()).zip(scaling.gain()) {
                    *out = ((*out - centre) / gain).clamp(-1.0, 1.0);
                }
            }
            None => out.fill(f32::NAN),
        }
    }

    /// What a timed skill sees in place of the target: the second of the clip that it tracks.
    pub(super) fn clock(&self, context: &EnvContext<'_>) -> Option<[f32; 2]> {
        let clock_seconds = context.config.command.clock_seconds;
        let tracking = self.tracking.filter(|_| clock_seconds > 0.0)?;
        let seconds = context.demonstrations[tracking.node].seconds_at(tracking.phase);
        Some(clock_input(seconds, clock_seconds))
    }

    /// True while it tracks a clip.
    #[must_use]
    pub fn tracks(&self) -> bool {
        self.tracking.is_some()
    }

    /// Advances the tracked phase by a tick. Returns the tracking reward and how the episode ends by it.
    pub(super) fn track_clip(&mut self, context: &EnvContext<'_>) -> (f32, Done) {
        let Some(tracking) = self.tracking else { return (0.0, Done::No) };
        let clips = context.demonstrations[tracking.node];
        let is = TrackedState::of(&self.state);
        // At the end of the clip its last phase stays: the value after the time-out is that of a policy that sees the clock.
        let Some(now) = tracking.next(clips) else { return (0.0, Done::TimedOut) };
        let now = now.in_pace(&is, clips).this_way_round(&is, clips);
        self.tracking = Some(now);
        let (reward, lost) = now.compare(&is, context);
        (reward, if lost { Done::Failed } else { Done::No })
    }

    /// Tracking reward for the clips of the node that it rests at, from the nearest phase on. After the threshold was exceeded
    /// tracking pauses, or a character that rests in one pose would be found again and again.
    pub(super) fn track_node(&mut self, context: &EnvContext<'_>) -> f32 {
        let Some(node) = self.command.position.as_node().map(NodeId::index) else {
            self.tracking = None;
            return 0.0;
        };
        if self.lost_ticks > 0 {
            self.lost_ticks -= 1;
            return 0.0;
        }
        let clips = context.demonstrations[node];
        let is = TrackedState::of(&self.state);
        let follow = self.tracking.filter(|before| before.node == node).and_then(|before| before.next(clips));
        let now = follow.unwrap_or_else(|| Tracking::soon(node, clips.nearest(&is)));
        let now = now.in_pace(&is, clips).this_way_round(&is, clips);
        let (reward, lost) = now.compare(&is, context);
        self.tracking = (!lost).then_some(now);
        self.lost_ticks = if lost { LOST_TICKS } else { 0 };
        reward
    }
}

/// The clips of the skill that learns: the last node's.
pub(super) fn own_clips<'a>(context: &EnvContext<'a>) -> &'a Demonstrations {
    context.demonstrations[context.demonstrations.len() - 1]
}
