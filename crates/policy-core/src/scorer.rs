//! Scores with discriminators how much a character's motion looks like a skill.

use alloc::vec::Vec;

use crate::features::{FrameHistory, discriminator_frame_into};
use crate::ids::DiscriminatorId;
use crate::kernel::Arithmetic;
use crate::mlp::MlpScratch;
use crate::pack::CharacterPack;
use crate::state::CharacterState;

/// Room to score one character's motion.
#[derive(Clone, Debug)]
pub(crate) struct Scorer {
    input: Vec<f32>,
    scratch: Option<MlpScratch>,
}

impl Scorer {
    pub(crate) fn new(pack: &CharacterPack) -> Self {
        let networks = &pack.tensors().discriminators;
        let widest = networks.iter().max_by_key(|d| d.layers().iter().map(|l| l.outputs()).max());
        Self {
            input: alloc::vec![0.0; pack.skeleton().discriminator_input_len()],
            scratch: widest.map(MlpScratch::for_mlp),
        }
    }

    /// Adds a frame to the history and returns the score in [0, 1] of the motion so far; `None` until the history is full.
    pub(crate) fn score(
        &mut self,
        pack: &CharacterPack,
        discriminator: DiscriminatorId,
        state: &CharacterState,
        history: &mut FrameHistory,
    ) -> Option<f32> {
        let frame = history.push();
        discriminator_frame_into(pack.skeleton(), state, frame);
        pack.tensors().discriminator_normaliser.normalise_in_place(frame);
        if !history.input_into(&mut self.input) {
            return None;
        }
        let mut logit = [0.0];
        // The pack took the id from its own list and checked inputs and the one output of every discriminator.
        let network = &pack.tensors().discriminators[discriminator.index()];
        network.evaluate_into(Arithmetic::Reproducible, &self.input, self.scratch.as_mut()?, &mut logit);
        Some(1.0 / (1.0 + libm::expf(-logit[0])))
    }
}
