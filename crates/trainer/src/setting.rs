//! What a run's characters act in.

use crate::env::{Course, Demonstrations, EnvironmentConfig, Normalisers, Stage};

/// What the characters of a run act in, beside the clips that the judges hold.
#[derive(Debug)]
pub(crate) struct Setting {
    /// The recipe's, as the phase that is on has it.
    pub(crate) environment: EnvironmentConfig,
    /// Where they go.
    pub(crate) course: Course,
    /// Other clips that episodes may start from.
    pub(crate) start_demonstrations: Option<Demonstrations>,
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
            normalisers: &self.normalisers,
        }
    }
}
