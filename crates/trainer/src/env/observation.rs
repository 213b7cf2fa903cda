//! What policies and critic see. The policy's input is policy-core's; the critic also sees the position on the graph, where it
//! is going and whether a clip is tracked.

use policy_core::training::face_in_observation;
use policy_core::{observe_into, target_input};

use super::command::INTENT_LEN;
use super::env::{Env, EnvContext};

impl EnvContext<'_> {
    /// Inputs of the critic: the policy's and those of [`TrainingGraph::context_len`](super::TrainingGraph::context_len).
    #[must_use]
    pub fn critic_inputs(&self) -> usize {
        self.skeleton.policy_input_len() + self.graph.context_len()
    }
}

impl Env {
    /// Writes the critic's input. It begins with the policy's: the normalised observation and the target.
    ///
    /// # Panics
    /// When `out` is not [`EnvContext::critic_inputs`] long.
    pub fn observe_into(&self, context: &EnvContext<'_>, out: &mut [f32]) {
        assert_eq!(out.len(), context.critic_inputs(), "input of a critic");
        let (input, rest) = out.split_at_mut(context.skeleton.policy_input_len());
        let (observation, target) = input.split_at_mut(context.skeleton.observation_len());
        observe_into(context.skeleton, &self.state, observation);
        let facing = (self.command.facing(), context.graph.strafe(self.command.position).0);
        face_in_observation(context.skeleton, &self.state, facing, observation);
        context.normalisers.observation.normalise_in_place(observation);
        let clock = self.clock(context);
        target.copy_from_slice(&clock.unwrap_or_else(|| target_input(&self.state, self.command.seen_target)));
        let (position, intent) = rest.split_at_mut(context.graph.position_len());
        context.graph.position_into(self.command.position, position);
        self.command.intent_into(intent);
        if let Some(tracks) = intent.get_mut(INTENT_LEN) {
            *tracks = f32::from(u8::from(self.tracks()));
        }
    }
}
