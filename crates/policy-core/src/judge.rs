//! Judges with discriminators how much a character's motion looks like a skill.

use alloc::boxed::Box;

use crate::features::{DISCRIMINATOR_INPUT_LEN, FrameHistory, discriminator_frame_into};
use crate::kernel::Arithmetic;
use crate::mlp::MlpScratch;
use crate::pack::CharacterPack;
use crate::state::CharacterState;

/// One character's motion history and room to judge it.
#[derive(Clone, Debug)]
pub(crate) struct Judge {
    history: FrameHistory,
    input: Box<[f32; DISCRIMINATOR_INPUT_LEN]>,
    scratch: Option<MlpScratch>,
}

impl Judge {
    pub(crate) fn new(pack: &CharacterPack) -> Self {
        let networks = &pack.tensors().discriminators;
        let widest = networks.iter().max_by_key(|d| d.layers().iter().map(|l| l.outputs()).max());
        Self {
            history: FrameHistory::default(),
            input: Box::new([0.0; DISCRIMINATOR_INPUT_LEN]),
            scratch: widest.map(MlpScratch::for_mlp),
        }
    }

    /// Forgets what it has seen.
    pub(crate) fn reset(&mut self) {
        self.history.clear();
    }

    /// Score in [0, 1] of the motion so far; `None` until the history is full.
    pub(crate) fn score(
        &mut self,
        pack: &CharacterPack,
        discriminator: usize,
        state: &CharacterState,
    ) -> Option<f32> {
        let frame = self.history.push();
        discriminator_frame_into(state, frame);
        pack.tensors().discriminator_normaliser.normalise_in_place(frame);
        if !self.history.input_into(&mut self.input) {
            return None;
        }
        let mut logit = [0.0];
        let network = &pack.tensors().discriminators[discriminator];
        network.evaluate_into(Arithmetic::Reproducible, &*self.input, self.scratch.as_mut()?, &mut logit);
        Some(1.0 / (1.0 + libm::expf(-logit[0])))
    }
}
