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

/// Ticks after which a character that follows a cycle goes on from the moment that it is most like: a policy that is not
/// told the time keeps its own pace.
const PACE_TICKS: u32 = 60;

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
    /// From this moment of a node's clips on; at once, or after a while, like it.
    pub(super) fn from(node: usize, moment: Moment, at_once: bool) -> Self {
        Self { node, moment, free_ticks: if at_once { 0 } else { FREE_TICKS }, ticks: 0 }
    }

    /// A tick later; `None` when the clip is over.
    fn next(self, clips: &Demonstrations) -> Option<Self> {
        let moment = clips.after(self.moment)?;
        Some(Self { moment, free_ticks: self.free_ticks.saturating_sub(1), ticks: self.ticks + 1, ..self })
    }

    /// The same, or after a while in a cycle the moment that the character is most like.
    fn in_pace(self, is: &Likeness, clips: &Demonstrations) -> Self {
        if self.ticks < PACE_TICKS || !clips.loops(self.moment) {
            return self;
        }
        Self { moment: clips.nearest(is), ticks: 0, ..self }
    }

    /// The same, or its mirror image where that is nearer, as long as it may be far from it. From then on it keeps to one of
    /// them: who may change over at every moment never has to put the other foot forward.
    fn this_way_round(self, is: &Likeness, clips: &Demonstrations) -> Self {
        let other = clips.mirrored(self.moment);
        let nearer = is.reward(clips.likeness(other)) > is.reward(clips.likeness(self.moment));
        if self.free_ticks > 0 && nearer { Self { moment: other, ..self } } else { self }
    }

    /// Reward for being like it, and whether it is lost.
    fn held_against(self, is: &Likeness, clips: &Demonstrations) -> (f32, bool) {
        let wanted = clips.likeness(self.moment);
        (is.reward(wanted), self.free_ticks == 0 && is.is_lost(wanted))
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
        let (reward, lost) = now.held_against(&is, clips);
        (reward, if lost { Done::Failed } else { Done::No })
    }

    /// Reward for being like the clips of the node that it rests at: from the moment that it is most like, wherever it came
    /// from, and again so when it has lost it.
    pub(super) fn imitate_node(&mut self, stage: &Stage<'_>) -> f32 {
        let Some(node) = stage.course.node_at(self.command.place) else {
            self.imitated = None;
            return 0.0;
        };
        let clips = stage.demonstrations[node];
        let is = Likeness::of(&self.state);
        let follow = self.imitated.filter(|before| before.node == node).and_then(|before| before.next(clips));
        let now = follow.unwrap_or_else(|| Imitated::from(node, clips.nearest(&is), false));
        let now = now.in_pace(&is, clips).this_way_round(&is, clips);
        let (reward, lost) = now.held_against(&is, clips);
        self.imitated = (!lost).then_some(now);
        reward
    }
}

/// The clips of the skill that is learned: the last node's.
pub(super) fn own_clips<'a>(stage: &Stage<'a>) -> &'a Demonstrations {
    stage.demonstrations[stage.demonstrations.len() - 1]
}
