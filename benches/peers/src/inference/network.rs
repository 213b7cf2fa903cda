//! The policy that all libraries evaluate: its sizes are those of a real one, its parameters are made up.

use policy_core::{Arithmetic, Mlp, MlpScratch};

/// Numbers in an observation.
pub const OBSERVATION_LEN: usize = 225;
/// Numbers in an action.
pub const ACTION_LEN: usize = 28;

const SIZES: [usize; 4] = [OBSERVATION_LEN, 128, 32, ACTION_LEN];

/// One dense layer. ReLU follows all but the last.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Numbers that go in.
    pub inputs: usize,
    /// Numbers that come out.
    pub outputs: usize,
    /// Input-major: `weight[input * outputs + output]`.
    pub weight: Vec<f32>,
    /// One number for each output.
    pub bias: Vec<f32>,
}

/// The layers of the policy, first to last.
#[derive(Debug, Clone)]
pub struct Network {
    /// Three layers: 225, 128, 32, 28.
    pub layers: Vec<Layer>,
}

impl Network {
    /// A network whose parameters follow from `seed`, scaled so that activations stay of order one.
    pub fn from_seed(seed: u64) -> Self {
        let mut numbers = Numbers(seed);
        let layers = SIZES.windows(2).map(|sizes| {
            let (inputs, outputs) = (sizes[0], sizes[1]);
            let scale = (6.0 / inputs as f32).sqrt();
            let weight = (0..inputs * outputs).map(|_| numbers.signed() * scale).collect();
            let bias = (0..outputs).map(|_| numbers.signed() * 0.1).collect();
            Layer { inputs, outputs, weight, bias }
        });
        Self { layers: layers.collect() }
    }

    /// An observation that follows from `seed`: numbers in -1 to 1.
    pub fn observation(seed: u64) -> Vec<f32> {
        let mut numbers = Numbers(seed);
        (0..OBSERVATION_LEN).map(|_| numbers.signed()).collect()
    }

    /// What policy-core makes of an observation.
    ///
    /// # Panics
    /// When policy-core does not take the network, which it is made for.
    pub fn expected(&self, observation: &[f32]) -> Vec<f32> {
        let layers = self.layers.iter().map(|layer| {
            policy_core::training::Layer::from_input_major(
                layer.inputs,
                layer.outputs,
                &layer.weight,
                &layer.bias,
            )
            .expect("made to shape")
        });
        let mlp = Mlp::from_layers(layers.collect()).expect("made to shape");
        let mut scratch = MlpScratch::for_mlp(&mlp);
        let mut action = vec![0.0; ACTION_LEN];
        mlp.evaluate_into(Arithmetic::Reproducible, observation, &mut scratch, &mut action);
        action
    }
}

/// Made-up numbers: the same for the same seed, everywhere.
struct Numbers(u64);

impl Numbers {
    /// The next number in -1 to 1.
    fn signed(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }
}
