//! What a run's characters act in.

use crate::env::{
    Course, Demonstrations, EnvironmentConfig, Normalisers, Place, Recovery, RewardTerms, Stage,
};
use crate::ppo::Done;

/// What the characters of a run act in, beside the clips that the judges hold.
#[derive(Debug)]
pub(crate) struct Setting {
    /// The recipe's, as the phase that is on has it.
    pub(crate) environment: EnvironmentConfig,
    /// Weight of the task reward in the phase that is on.
    pub(crate) task: f32,
    /// Where they go.
    pub(crate) course: Course,
    /// Other clips that episodes may start from.
    pub(crate) start_demonstrations: Option<Demonstrations>,
    /// What raises characters that were dropped, for starts.
    pub(crate) recovery: Option<Recovery>,
    /// The graph's.
    pub(crate) normalisers: Normalisers,
}

impl Setting {
    /// What the characters see of it.
    pub(crate) fn stage<'a>(&'a self, demonstrations: &'a [&'a Demonstrations]) -> Stage<'a> {
        Stage {
            config: &self.environment,
            course: &self.course,
            demonstrations,
            start_demonstrations: self.start_demonstrations.as_ref(),
            recovery: self.recovery.as_ref(),
            normalisers: &self.normalisers,
        }
    }

    /// Reward of a tick, without that for style.
    pub(crate) fn reward(&self, place: Place, terms: &RewardTerms, end: Done) -> f32 {
        let fall = if end == Done::Failed { self.environment.fall_cost } else { 0.0 };
        let cost = fall + self.environment.slide_cost * terms.slide_mps;
        self.task_share(place) * terms.task + self.environment.imitation * terms.imitation - cost
    }

    /// Weight of the task reward at a place.
    pub(crate) fn task_share(&self, place: Place) -> f32 {
        self.task * self.course.task(place)
    }

    /// Weight of the style reward at a place: what the others leave. Imitators of skills trained together get theirs beside.
    pub(crate) fn style_share(&self, place: Place) -> f32 {
        let together = self.environment.imitators > 0.0;
        1.0 - self.task_share(place) - if together { 0.0 } else { self.environment.imitation }
    }
}
