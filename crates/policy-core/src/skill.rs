//! Episodic skills: a policy switch that runs until a discriminator of the skill to return to recognises its
//! motion, or until a time limit (paper, section 3.5).

use alloc::string::String;
use alloc::vec::Vec;

use crate::ids::{DiscriminatorId, NodeId, PolicyId, SkillId};
use crate::observation::{TARGET_LEN, TARGET_RANGE_METRES};

/// When an episodic skill ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndCondition {
    /// The discriminator's score, in [0, 1], must rise to this to start counting. With 0 any score will do, so that height alone ends it.
    pub threshold: f32,
    /// The time runs on until the score falls this far below the threshold, in [0, 1].
    pub hysteresis: f32,
    /// The skill ends when the score has held this long, seconds, above 0.
    pub hold_seconds: f32,
    /// It does not end before this, seconds.
    pub minimum_seconds: f32,
    /// It ends after this in any case, seconds.
    pub limit_seconds: f32,
    /// A score counts only while the root is at least this high above the ground, metres: a discriminator knows the motion that
    /// it was trained on, not a heap of limbs. 0 for no such condition.
    pub minimum_height: f32,
}

/// An episodic skill of a pack.
#[derive(Clone, Debug, PartialEq)]
pub struct Skill {
    /// Unique name.
    pub name: String,
    /// The policy that runs.
    pub policy: PolicyId,
    /// Nodes from which it may start; empty: any.
    pub entry: Vec<NodeId>,
    /// Horizontal speed of the root below which it does not start, metres per second: a pending skill takes a run-up.
    pub minimum_speed_mps: f32,
    /// Horizontal speed of the root above which it does not start, metres per second: a pending skill waits until the character is
    /// slow enough, does not tip over, and has settled after another skill. Infinite for no such condition.
    pub maximum_speed_mps: f32,
    /// True for one that starts as a foot comes down, while the character goes straight ahead and once it has settled after another skill: it
    /// continues a stride.
    pub on_footfall: bool,
    /// What acts in its place in the stride of a gait: the first of these that fits gait and speed, as a leap for a jump in a run. Reports go
    /// on naming this skill.
    pub in_stride: Vec<SkillId>,
    /// Seconds in which the clock of a timed skill runs once ([`clock_input`]); `None` for a skill that sees the target.
    pub clock_seconds: Option<f32>,
    /// Node that runs afterwards.
    pub returns_to: NodeId,
    /// The discriminator that ends it; without one the time limit does.
    pub discriminator: Option<DiscriminatorId>,
    /// When it ends.
    pub end: EndCondition,
}

impl Skill {
    /// True when it may start from `node`.
    #[must_use]
    pub fn starts_from(&self, node: NodeId) -> bool {
        self.entry.is_empty() || self.entry.contains(&node)
    }
}

/// What the policy of a timed skill sees in place of the target: the hand of a clock that goes half-way round, from straight ahead
/// over the left to straight behind, in `clock_seconds`. There it stays. Its length is that of a target that is far away.
///
/// A kick needs no target. What it needs is the time: without it the policy has to tell a leg that is about to rise from one that
/// comes down by the pose alone.
#[must_use]
pub fn clock_input(seconds: f32, clock_seconds: f32) -> [f32; TARGET_LEN] {
    let share = if clock_seconds > 0.0 { (seconds / clock_seconds).clamp(0.0, 1.0) } else { 1.0 };
    let share = if share.is_finite() { share } else { 1.0 };
    let (sin, cos) = libm::sincosf(core::f32::consts::PI * share);
    let length = 0.5 * TARGET_RANGE_METRES;
    [length * cos, length * sin]
}

/// Why an episodic skill ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SkillEnd {
    /// The discriminator recognised the motion to return to.
    Recognised,
    /// The time limit was reached.
    TimeLimit,
    /// Another skill took over, or the controller was reset or put elsewhere.
    Interrupted,
}

/// Why a requested skill does not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Refusal {
    /// The recovery skill was requested while the character is up.
    Upright,
    /// The pack has no such skill.
    Unknown,
    /// It was pending for 4 s and could not start: the way to an entry is long, or the run-up is blocked.
    TookTooLong,
    /// It was pending when the recovery skill started after a fall.
    Fell,
}

/// Progress of a running skill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkillProgress {
    /// The skill.
    pub skill: SkillId,
    /// The skill that acts: the same, or one of its [`Skill::in_stride`].
    pub acts: SkillId,
    /// Seconds since it started.
    pub seconds: f32,
    /// Seconds that the score has held.
    pub held_seconds: f32,
    /// Latest score of the discriminator, in [0, 1]; `None` before there is one.
    pub score: Option<f32>,
}

impl SkillProgress {
    /// A skill that starts now.
    #[must_use]
    pub fn start(skill: SkillId) -> Self {
        Self { skill, acts: skill, seconds: 0.0, held_seconds: 0.0, score: None }
    }

    /// True where what acts is the skill, or what acts in its place in a pack of these skills; both must be among them.
    pub(crate) fn fits(&self, skills: &[Skill]) -> bool {
        self.acts == self.skill || skills[self.skill.index()].in_stride.contains(&self.acts)
    }

    /// Takes one control tick: the discriminator's score, if there is one, and the root's height above the ground, metres.
    /// Returns why the skill ends, if it does.
    pub fn tick(
        &mut self,
        end: &EndCondition,
        score: Option<f32>,
        root_height: f32,
        dt_secs: f32,
    ) -> Option<SkillEnd> {
        self.seconds += dt_secs;
        self.score = score;
        let release = end.threshold - end.hysteresis;
        self.held_seconds = match score.filter(|_| root_height >= end.minimum_height) {
            Some(s) if s >= end.threshold || (self.held_seconds > 0.0 && s >= release) => {
                self.held_seconds + dt_secs
            }
            _ => 0.0,
        };
        // Half a tick of slack, so that rounding does not decide.
        let held = self.held_seconds > 0.0 && self.held_seconds + 0.5 * dt_secs >= end.hold_seconds;
        if self.seconds >= end.minimum_seconds && held {
            Some(SkillEnd::Recognised)
        } else if self.seconds >= end.limit_seconds {
            Some(SkillEnd::TimeLimit)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const END: EndCondition = EndCondition {
        threshold: 0.6,
        hysteresis: 0.2,
        hold_seconds: 0.3,
        minimum_seconds: 0.2,
        limit_seconds: 2.0,
        minimum_height: 0.7,
    };
    const UP: f32 = 0.8;
    const DT: f32 = 0.1;

    fn run(scores: &[f32]) -> Option<(usize, SkillEnd)> {
        let mut progress = SkillProgress::start(SkillId::new(0));
        scores.iter().enumerate().find_map(|(i, s)| progress.tick(&END, Some(*s), UP, DT).map(|end| (i, end)))
    }

    #[test]
    fn a_clock_goes_half_way_round_and_stays_there() {
        let near = |is: [f32; 2], wanted: [f32; 2]| {
            assert!((is[0] - wanted[0]).abs() < 1e-5 && (is[1] - wanted[1]).abs() < 1e-5, "{is:?}");
        };
        near(clock_input(0.0, 1.5), [2.5, 0.0]);
        near(clock_input(0.75, 1.5), [0.0, 2.5]);
        near(clock_input(1.5, 1.5), [-2.5, 0.0]);
        near(clock_input(9.0, 1.5), [-2.5, 0.0]);
        near(clock_input(f32::NAN, 1.5), [-2.5, 0.0]);
        near(clock_input(1.0, 0.0), [-2.5, 0.0]);
    }

    #[test]
    fn a_score_that_stays_within_the_hysteresis_ends_it() {
        assert_eq!(run(&[0.1, 0.7, 0.45, 0.45]), Some((3, SkillEnd::Recognised)));
    }

    #[test]
    fn a_score_that_drops_starts_anew() {
        assert_eq!(run(&[0.7, 0.7, 0.3, 0.5, 0.5, 0.5]), None);
    }

    #[test]
    fn it_does_not_end_before_the_minimum_and_always_at_the_limit() {
        let mut progress = SkillProgress::start(SkillId::new(0));
        let end = EndCondition { minimum_seconds: 1.0, ..END };
        let at = (0..).find(|_| progress.tick(&end, Some(1.0), UP, DT).is_some());
        assert!(at == Some(9) || at == Some(10), "{at:?}");
        assert_eq!(run(&[f32::NAN; 30]).map(|(_, end)| end), Some(SkillEnd::TimeLimit));
    }

    #[test]
    fn it_does_not_end_on_the_ground_whatever_the_score() {
        let mut progress = SkillProgress::start(SkillId::new(0));
        for _ in 0..10 {
            assert_eq!(progress.tick(&END, Some(1.0), 0.2, DT), None);
        }
        let up = (1..).find(|_| progress.tick(&END, Some(1.0), UP, DT).is_some());
        assert_eq!(up, Some(3));
    }
}
