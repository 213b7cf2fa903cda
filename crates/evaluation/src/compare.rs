//! The paper's cost table: multiply-adds of a control step of the humanoid, and their time in policy-core.

use std::hint::black_box;
use std::time::Instant;

use policy_core::training::{Layer, MlpError};
use policy_core::{Arithmetic, Blend, BlendEvaluator, BlendMode, Mlp, MlpScratch, PolicyId, Skeleton};

use random::Rng;

/// Length of the latent code that ASE's high-level policy hands to its low-level policy.
const LATENT_LEN: usize = 64;

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// What is evaluated.
    pub name: String,
    /// Widths of its networks.
    pub networks: Vec<Vec<usize>>,
    /// Products of one control step.
    pub multiply_adds: usize,
    /// Median time of one control step, microseconds.
    pub microseconds: f64,
}

fn random_mlp(widths: &[usize], rng: &mut Rng) -> Result<Mlp, MlpError> {
    let layer = |pair: &[usize], rng: &mut Rng| {
        let deviation = (2.0 / pair[0] as f32).sqrt();
        let weight: Vec<f32> = (0..pair[0] * pair[1]).map(|_| deviation * rng.normal()).collect();
        Layer::from_input_major(pair[0], pair[1], &weight, &vec![0.0; pair[1]])
    };
    let layers = widths.windows(2).map(|pair| layer(pair, rng)).collect::<Result<Vec<_>, _>>()?;
    Mlp::from_layers(layers)
}

/// Counts and times one policy with two hidden layers of these widths, a parameter blend and an action blend of two, and the three networks of ASE (Peng et al.
/// 2022) that a control step may run: high-level policy, a smaller one, low-level policy.
///
/// # Errors
/// When policy-core refuses a network of these sizes.
pub fn costs(hidden: [usize; 2], repeats: usize) -> Result<Vec<Cost>, MlpError> {
    let mut rng = Rng::new(1, 1);
    let skeleton = Skeleton::humanoid();
    let [observation, actions] = [skeleton.observation_len(), skeleton.joint_count()];
    let [first, second] = hidden;
    let ours = vec![skeleton.policy_input_len(), first, second, actions];
    let policies = [random_mlp(&ours, &mut rng)?, random_mlp(&ours, &mut rng)?];
    let one = policies[0].multiply_adds();
    let mut table = Vec::new();
    for (name, blend, mode, count) in [
        ("one policy", Blend::single(PolicyId::new(0)), BlendMode::Parameters, 1),
        (
            "parameter blend of two",
            Blend::between(PolicyId::new(0), PolicyId::new(1), 0.4),
            BlendMode::Parameters,
            2,
        ),
        (
            "action blend of two",
            Blend::between(PolicyId::new(0), PolicyId::new(1), 0.4),
            BlendMode::Actions,
            2,
        ),
    ] {
        let mut evaluator = BlendEvaluator::new(&policies[0], Arithmetic::Fused, false);
        let input = vec![0.3; ours[0]];
        let mut action = vec![0.0; actions];
        let microseconds = median(repeats, || {
            evaluator.evaluate_into(&policies, &blend, mode, black_box(&input), &mut action);
            black_box(action[0]);
        });
        let networks = vec![ours.clone(); count];
        table.push(Cost { name: name.into(), networks, multiply_adds: count * one, microseconds });
    }
    for (name, widths) in [
        ("ASE [1024, 512]", vec![ours[0], 1024, 512, LATENT_LEN]),
        ("ASE [512, 256]", vec![ours[0], 512, 256, LATENT_LEN]),
        ("ASE [1024, 1024, 512]", vec![observation + LATENT_LEN, 1024, 1024, 512, actions]),
    ] {
        let network = random_mlp(&widths, &mut rng)?;
        let mut scratch = MlpScratch::for_mlp(&network);
        let input = vec![0.3; widths[0]];
        let mut out = vec![0.0; widths[widths.len() - 1]];
        let microseconds = median(repeats, || {
            network.evaluate_into(Arithmetic::Fused, black_box(&input), &mut scratch, &mut out);
            black_box(out[0]);
        });
        let multiply_adds = network.multiply_adds();
        table.push(Cost { name: name.into(), networks: vec![widths], multiply_adds, microseconds });
    }
    Ok(table)
}

/// Median time of a call in microseconds, over blocks of 16 calls.
fn median(repeats: usize, mut call: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..repeats.max(1))
        .map(|_| {
            let start = Instant::now();
            (0..16).for_each(|_| call());
            start.elapsed().as_secs_f64() * 1e6 / 16.0
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
