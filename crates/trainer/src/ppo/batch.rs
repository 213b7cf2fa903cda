//! Evaluation of many rows with all threads.

use rayon::prelude::*;

use crate::nn::{Line, Network, Pass};

/// Evaluates a network on many rows with all threads. The result does not depend on their number.
#[derive(Clone, Debug)]
pub struct BatchEvaluator {
    lanes: Vec<Pass>,
    block: usize,
}

impl BatchEvaluator {
    /// An evaluator for networks of these sizes.
    #[must_use]
    pub fn new(sizes: &[usize]) -> Self {
        let block = 128;
        Self { lanes: vec![Pass::new(sizes, block); 4], block }
    }

    /// Writes the outputs of `network` for every row of `input` to `out`.
    ///
    /// # Panics
    /// When `out` is not one output row for each input row.
    pub fn evaluate(&mut self, network: &Network, line: Option<Line<'_>>, input: &[f32], out: &mut [f32]) {
        let (inputs, outputs, block) = (network.inputs(), network.outputs(), self.block);
        let rows = input.len() / inputs;
        assert_eq!(out.len(), rows * outputs, "outputs of a batch");
        let per_lane = rows.div_ceil(self.lanes.len()).max(1);
        let lanes = self.lanes.par_iter_mut().zip(input.par_chunks(per_lane * inputs));
        lanes.zip(out.par_chunks_mut(per_lane * outputs)).enumerate().for_each(
            |(lane, ((pass, input), out))| {
                let blocks = input.chunks(block * inputs).zip(out.chunks_mut(block * outputs));
                for (i, (input, out)) in blocks.enumerate() {
                    let first = lane * per_lane + i * block;
                    let rows = input.len() / inputs;
                    let line = line.map(|l| Line { parent: l.parent, blend: &l.blend[first..first + rows] });
                    pass.forward(network, line, input);
                    out.copy_from_slice(pass.output(rows));
                }
            },
        );
    }
}
