//! What a run starts from, and what its environments share.

use std::sync::Arc;

use policy_core::{BodyId, Controller, Skeleton};

use crate::env::{
    Demonstrations, EnvContext, EnvironmentConfig, HandOver, Normalisers, TerminationHeights, TrainingGraph,
};
use crate::ppo::Learner;
use crate::style::Discriminators;

/// What a run starts from. Actors, discriminators and clips are in the order of the graph's nodes.
#[derive(Debug)]
pub struct Parts {
    /// Nodes and paths.
    pub graph: TrainingGraph,
    /// Actors and critic.
    pub learner: Learner,
    /// Discriminators of the nodes' styles, with their clips.
    pub discriminators: Discriminators,
    /// Other clips that episodes may start from.
    pub start_demonstrations: Option<Demonstrations>,
    /// Episodic skills whose ends are starts, in the recipe's order.
    pub hand_over: Vec<HandOver>,
    /// What each phase says about the bodies, at least one.
    pub bodies: Vec<PhaseBodies>,
    /// Drives the characters that are met, where a phase has some.
    pub company: Option<Controller>,
}

/// What a phase says about the bodies of the character.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseBodies {
    /// Heights that tell standing from lying.
    pub heights: TerminationHeights,
    /// Bodies that are pushed.
    pub pushed: Vec<BodyId>,
}

/// What the environments share beside the discriminators' clips.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) graph: TrainingGraph,
    pub(super) start_demonstrations: Option<Demonstrations>,
    pub(super) hand_over: Vec<HandOver>,
    pub(super) normalisers: Normalisers,
    pub(super) bodies: Vec<PhaseBodies>,
    /// Index of the phase that is set up; the first one before one is.
    pub(super) phase: usize,
    pub(super) company: Option<Controller>,
    pub(super) skeleton: Arc<Skeleton>,
}

impl Shared {
    /// What environments see of it, with the settings of a phase.
    pub(super) fn context<'a>(
        &'a self,
        config: &'a EnvironmentConfig,
        demonstrations: &'a [&'a Demonstrations],
    ) -> EnvContext<'a> {
        let PhaseBodies { heights, pushed } = &self.bodies[self.phase];
        EnvContext {
            config,
            graph: &self.graph,
            demonstrations,
            start_demonstrations: self.start_demonstrations.as_ref(),
            hand_over: &self.hand_over,
            normalisers: &self.normalisers,
            heights,
            pushed,
            company: self.company.as_ref(),
            skeleton: &self.skeleton,
        }
    }
}
