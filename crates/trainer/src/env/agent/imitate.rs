//! Imitation: one skill from a moment of its clip on until it has lost the clip, or, of skills trained together, whatever
//! node the character rests at.

use policy_core::ActionScaling;

use super::super::demonstrations::{Demonstrations, Moment};
use super::super::imitation::Likeness;
use super::super::population::Stage;
use super::Agent;
use crate::ppo::Done;

/// Ticks for which a character that did not start in the clip may be far from it.
const FREE_TICKS: u32 = 20;

/// The same for a cycle, which it may join at any moment: a change of stance takes longer than a beginning.
const FREE_TICKS_OF_CYCLE: u32 = 45;

/// Ticks after which a character that follows a cycle goes on from the moment that it is most like, of those around: a policy
/// that is not told the time keeps its own pace.
const PACE_TICKS: u32 = 60;

/// Ticks before and after that count as around. Who could go on from any moment would never have to step.
const AROUND_TICKS: usize = 15;

/// Ticks for which a character that has lost the clip of a node is not held against it, nor rewarded.
const STRAYED_TICKS: u32 = 30;

/// What a character imitates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Imitated {
    /// Whose clips.
    node: usize,
    /// What it is to be like now.
    moment: Moment,
    /// Ticks for which it may still be far from it.
    free_ticks: u32,
    /// Ticks since the moment was chosen.
    ticks: u32,
}

impl Imitated {
    /// Like it from this moment of a node's clips on.
    pub(super) fn at_once(node: usize, moment: Moment) -> Self {
        Self { node, moment, free_ticks: 0, ticks: 0 }
    }

    /// From this moment of a node's clips on, and after a while like it.
    pub(super) fn soon(node: usize, moment: Moment) -> Self {
        Self { free_ticks: FREE_TICKS, ..Self::at_once(node, moment) }
    }

    /// From elsewhere into these clips of a node: to this beginning soon, or into a cycle wherever it is nearest after a while.
    pub(super) fn into_clips(node: usize, beginning: Moment, clips: &Demonstrations) -> Self {
        let free_ticks = if clips.loops(beginning) { FREE_TICKS_OF_CYCLE } else { FREE_TICKS };
        Self { free_ticks, ..Self::at_once(node, beginning) }
    }

    /// A tick later; `None` when the clip is over.
    fn next(self, clips: &Demonstrations) -> Option<Self> {
        let moment = clips.after(self.moment)?;
        Some(Self { moment, free_ticks: self.free_ticks.saturating_sub(1), ticks: self.ticks + 1, ..self })
    }

    /// The same, or in a cycle the moment that the character is most like: any when it has to be like it from now on, one
    /// around after a while.
    fn in_pace(self, is: &Likeness, clips: &Demonstrations) -> Self {
        if !clips.loops(self.moment) || (self.ticks < PACE_TICKS && self.free_ticks != 1) {
            return self;
        }
        if self.free_ticks == 1 {
            return Self { moment: clips.nearest(is), ticks: 0, ..self };
        }
        Self { moment: clips.nearest_around(self.moment, AROUND_TICKS, is), ticks: 0, ..self }
    }

    /// The same, or its mirror image where that is nearer, as long as it may be far from it. From then on it keeps to one of
    /// them: who may change over at every moment never has to put the other foot forward.
    fn this_way_round(self, is: &Likeness, clips: &Demonstrations) -> Self {
        if self.free_ticks == 0 {
            return self;
        }
        let other = clips.mirrored(self.moment);
        let nearer = is.reward(clips.likeness(other)) > is.reward(clips.likeness(self.moment));
        if nearer { Self { moment: other, ..self } } else { self }
    }

    /// Reward for being like it, and whether it is lost.
    fn held_against(self, is: &Likeness, stage: &Stage<'_>) -> (f32, bool) {
        let wanted = stage.demonstrations[self.node].likeness(self.moment);
        let lost_metres = stage.course.nodes()[self.node].lost_metres;
        (is.reward(wanted), self.free_ticks == 0 && is.is_lost(wanted, lost_metres))
    }
}

impl Agent {
    /// Writes the action that would follow the imitated clip from here; NaN when there is none.
    pub fn guide_into(&self, stage: &Stage<'_>, scaling: &ActionScaling, out: &mut [f32]) {
        match self.imitated {
            Some(Imitated { node, moment, .. }) => {
                let angles = stage.demonstrations[node].ahead(moment);
                let scales = angles.iter().zip(scaling.centre()).zip(scaling.gain());
                let actions =
                    scales.map(|((angle, centre), gain)| ((angle - centre) / gain).clamp(-1.0, 1.0));
                out.iter_mut().zip(actions).for_each(|(out, action)| *out = action);
            }
            None => out.fill(f32::NAN),
        }
    }

    /// True while it is rewarded for being like a clip.
    #[must_use]
    pub fn imitates(&self) -> bool {
        self.imitated.is_some()
    }

    /// Moves what is imitated on by a tick; the reward for being like it and how the episode ends by it.
    pub(super) fn imitate(&mut self, stage: &Stage<'_>) -> (f32, Done) {
        let Some(imitated) = self.imitated else { return (0.0, Done::No) };
        let clips = stage.demonstrations[imitated.node];
        let is = Likeness::of(&self.state);
        self.imitated = imitated.next(clips).map(|now| now.in_pace(&is, clips).this_way_round(&is, clips));
        let Some(now) = self.imitated else { return (0.0, Done::TimedOut) };
        let (reward, lost) = now.held_against(&is, stage);
        (reward, if lost { Done::Failed } else { Done::No })
    }

    /// Reward for being like the clips of the node that it rests at: from the moment that it is most like, wherever it came
    /// from, and again so a while after it has lost it. Without that while, who rests in one pose is found again and again.
    pub(super) fn imitate_node(&mut self, stage: &Stage<'_>) -> f32 {
        let Some(node) = stage.course.node_at(self.command.place) else {
            self.imitated = None;
            return 0.0;
        };
        if self.strayed_ticks > 0 {
            self.strayed_ticks -= 1;
            return 0.0;
        }
        let clips = stage.demonstrations[node];
        let is = Likeness::of(&self.state);
        let follow = self.imitated.filter(|before| before.node == node).and_then(|before| before.next(clips));
        let now = follow.unwrap_or_else(|| Imitated::soon(node, clips.nearest(&is)));
        let now = now.in_pace(&is, clips).this_way_round(&is, clips);
        let (reward, lost) = now.held_against(&is, stage);
        self.imitated = (!lost).then_some(now);
        self.strayed_ticks = if lost { STRAYED_TICKS } else { 0 };
        reward
    }
}

/// The clips of the skill that is learned: the last node's.
pub(super) fn own_clips<'a>(stage: &Stage<'a>) -> &'a Demonstrations {
    stage.demonstrations[stage.demonstrations.len() - 1]
}
