//! Episodic skills: a policy switch that runs until a discriminator of the skill to return to recognises its
//! motion, or until a time limit (paper, section 3.5).

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

/// When an episodic skill ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndCondition {
    /// The discriminator's score, in [0, 1], must rise to this to start counting.
    pub threshold: f32,
    /// The count goes on until the score falls this far below the threshold, in [0, 1].
    pub hysteresis: f32,
    /// The skill ends when it has counted this many control ticks, at least 1.
    pub ticks: u32,
    /// No end before this, seconds.
    pub minimum_seconds: f32,
    /// The end in any case, seconds.
    pub limit_seconds: f32,
    /// Nothing is counted while the pelvis is lower than this above the ground, metres: a discriminator knows the motion
    /// it returns to and what comes near it, not a heap of limbs. 0 for no such condition.
    #[serde(default)]
    pub minimum_height: f32,
}

/// An episodic skill of a pack.
#[derive(Clone, Debug, PartialEq)]
pub struct Skill {
    /// Unique name.
    pub name: String,
    /// Index of the policy that runs.
    pub policy: usize,
    /// Nodes from which it may start; empty: any.
    pub entry: Vec<usize>,
    /// Node that runs afterwards.
    pub returns_to: usize,
    /// Index of the discriminator that ends it.
    pub discriminator: Option<usize>,
    /// When it ends.
    pub end: EndCondition,
}

impl Skill {
    /// True when it may start from `node`.
    #[must_use]
    pub fn starts_from(&self, node: usize) -> bool {
        self.entry.is_empty() || self.entry.contains(&node)
    }
}

/// Why an episodic skill ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SkillEnd {
    /// The discriminator recognised the motion to return to.
    Recognised,
    /// The time limit was reached.
    TimeLimit,
    /// Another skill was requested, or the controller was reset.
    Interrupted,
}

/// Progress of a running skill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkillProgress {
    /// Index of the skill.
    pub skill: usize,
    /// Seconds since it started.
    pub seconds: f32,
    /// Ticks counted towards the end.
    pub counted: u32,
    /// Latest score of the discriminator, in [0, 1]; `None` before there is one.
    pub score: Option<f32>,
}

impl SkillProgress {
    /// A skill that starts now.
    #[must_use]
    pub fn start(skill: usize) -> Self {
        Self { skill, seconds: 0.0, counted: 0, score: None }
    }

    /// Takes one control tick, the discriminator's score, if there is one, and the pelvis' height above the ground, metres;
    /// says whether the skill ends.
    pub fn tick(
        &mut self,
        end: &EndCondition,
        score: Option<f32>,
        pelvis_height: f32,
        dt_secs: f32,
    ) -> Option<SkillEnd> {
        self.seconds += dt_secs;
        self.score = score;
        let release = end.threshold - end.hysteresis;
        self.counted = match score.filter(|_| pelvis_height >= end.minimum_height) {
            Some(s) if s >= end.threshold || (self.counted > 0 && s >= release) => self.counted + 1,
            _ => 0,
        };
        if self.seconds >= end.minimum_seconds && self.counted >= end.ticks {
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
        ticks: 3,
        minimum_seconds: 0.2,
        limit_seconds: 2.0,
        minimum_height: 0.7,
    };
    const UP: f32 = 0.8;
    const DT: f32 = 0.1;

    fn run(scores: &[f32]) -> Option<(usize, SkillEnd)> {
        let mut progress = SkillProgress::start(0);
        scores.iter().enumerate().find_map(|(i, s)| progress.tick(&END, Some(*s), UP, DT).map(|end| (i, end)))
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
        let mut progress = SkillProgress::start(0);
        let end = EndCondition { minimum_seconds: 1.0, ..END };
        let at = (0..).find(|_| progress.tick(&end, Some(1.0), UP, DT).is_some());
        assert!(at == Some(9) || at == Some(10), "{at:?}");
        assert_eq!(run(&[f32::NAN; 30]).map(|(_, end)| end), Some(SkillEnd::TimeLimit));
    }

    #[test]
    fn it_does_not_end_on_the_ground_whatever_the_score() {
        let mut progress = SkillProgress::start(0);
        for _ in 0..10 {
            assert_eq!(progress.tick(&END, Some(1.0), 0.2, DT), None);
        }
        let up = (1..).find(|_| progress.tick(&END, Some(1.0), UP, DT).is_some());
        assert_eq!(up, Some(3));
    }
}
