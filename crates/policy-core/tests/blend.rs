//! Blends against their plain definition: build the interpolated network in double precision, evaluate it.

mod common;

use common::{Noise, POLICY_SIZES, mlp, p};
use policy_core::training::{BlendTerm, Evaluation};
use policy_core::{
    Arithmetic, BatchScratch, Blend, BlendEvaluator, BlendMode, Mlp, MlpScratch, evaluate_batch_into,
};
use proptest::prelude::*;

/// The definition: interpolate every parameter, then evaluate, all in double precision.
fn plain(policies: &[Mlp], blend: &Blend, input: &[f32]) -> Vec<f64> {
    let mut x: Vec<f64> = input.iter().map(|&v| f64::from(v)).collect();
    let depth = policies[0].layers().len();
    for l in 0..depth {
        let shape = &policies[0].layers()[l];
        let (mut weight, mut bias) =
            (vec![0.0; shape.inputs() * shape.outputs()], vec![0.0; shape.outputs()]);
        for term in blend.terms() {
            let (layer, w) = (&policies[term.policy.index()].layers()[l], f64::from(term.weights[l]));
            weight.iter_mut().zip(layer.weight()).for_each(|(s, p)| *s += w * f64::from(p));
            bias.iter_mut().zip(layer.bias()).for_each(|(s, p)| *s += w * f64::from(p));
        }
        let mut y = bias;
        for (i, x) in x.iter().enumerate() {
            for (o, y) in y.iter_mut().enumerate() {
                *y += x * weight[i * shape.outputs() + o];
            }
        }
        if l + 1 < depth {
            y.iter_mut().for_each(|y| *y = y.max(0.0));
        }
        x = y;
    }
    x
}

fn assert_close(found: &[f32], expected: &[f64]) {
    let scale = expected.iter().fold(0.0f64, |m, e| m.max(e.abs()));
    for (f, e) in found.iter().zip(expected) {
        assert!((f64::from(*f) - e).abs() <= 1e-5 * scale, "{f} against {e}, scale {scale}");
    }
}

fn policies(count: u32) -> Vec<Mlp> {
    (1..=count).map(|seed| mlp(&POLICY_SIZES, seed)).collect()
}

fn evaluate(policies: &[Mlp], blend: &Blend, arithmetic: Arithmetic, input: &[f32]) -> [f32; 28] {
    let mut scratch = MlpScratch::for_mlp(&policies[0]);
    let mut out = [0.0; 28];
    blend.evaluate_into(policies, arithmetic, input, &mut scratch, &mut out);
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn fused_cached_and_batched_agree_with_the_definition(
        seed in any::<u32>(),
        weights in prop::collection::vec(prop::array::uniform4(-0.5f32..1.5), 1..5),
    ) {
        let policies = policies(4);
        let input = Noise(seed).numbers(225, 3.0);
        let mut blend = Blend::default();
        for (policy, weights) in weights.into_iter().enumerate() {
            blend.push(BlendTerm { policy: p(policy), weights }).unwrap();
        }
        let expected = plain(&policies, &blend, &input);
        for arithmetic in [Arithmetic::Reproducible, Arithmetic::Fused] {
            assert_close(&evaluate(&policies, &blend, arithmetic, &input), &expected);
            let mut batched = [0.0; 28];
            let mut scratch = BatchScratch::for_mlp(&policies[0], 1);
            evaluate_batch_into(&policies, arithmetic, &[blend], &input, &mut scratch, &mut batched);
            assert_close(&batched, &expected);
        }
        let mut cached = policies[3].clone();
        blend.parameters_into(&policies, &mut cached);
        let mut out = [0.0; 28];
        cached.evaluate_into(Arithmetic::Reproducible, &input, &mut MlpScratch::for_mlp(&cached), &mut out);
        assert_close(&out, &expected);
    }

    #[test]
    fn endpoints_are_the_policies_bit_for_bit(seed in any::<u32>()) {
        let policies = policies(2);
        let input = Noise(seed).numbers(225, 3.0);
        for arithmetic in [Arithmetic::Reproducible, Arithmetic::Fused] {
            for (t, policy) in [(0.0, 0), (1.0, 1)] {
                let mut alone = [0.0; 28];
                let mut scratch = MlpScratch::for_mlp(&policies[0]);
                policies[policy].evaluate_into(arithmetic, &input, &mut scratch, &mut alone);
                let blended = evaluate(&policies, &Blend::between(p(0), p(1), t), arithmetic, &input);
                prop_assert_eq!(alone.map(f32::to_bits), blended.map(f32::to_bits));
            }
        }
    }
}

#[test]
fn a_batch_gives_every_character_its_own_blend() {
    let policies = policies(5);
    let mut noise = Noise(3);
    let count = 131;
    let blends: Vec<Blend> = (0..count)
        .map(|i| match i % 3 {
            0 => Blend::single(p(i % 5)),
            1 => Blend::between(p(i % 4), p(i % 4 + 1), noise.number().abs()),
            _ => Blend::between_per_layer(p(i % 5), p((i + 2) % 5), [0.1, noise.number().abs(), 0.9, 0.0]),
        })
        .collect();
    let inputs = noise.numbers(count * 225, 2.0);
    let mut out = vec![0.0; count * 28];
    let mut scratch = BatchScratch::for_mlp(&policies[0], count);
    evaluate_batch_into(&policies, Arithmetic::Reproducible, &blends, &inputs, &mut scratch, &mut out);
    for (i, blend) in blends.iter().enumerate() {
        assert_close(&out[i * 28..][..28], &plain(&policies, blend, &inputs[i * 225..][..225]));
    }
    // In reproducible arithmetic the order of summation is that of one evaluation: the same bits.
    let alone = evaluate(&policies, &blends[7], Arithmetic::Reproducible, &inputs[7 * 225..][..225]);
    assert_eq!(out[7 * 28..][..28], alone);
}

#[test]
fn reproducible_arithmetic_gives_the_pinned_bits() {
    let policies = policies(3);
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    for seed in 0..50 {
        let input = Noise(seed * 77 + 1).numbers(225, 2.0);
        let blend = match seed % 3 {
            0 => Blend::single(p(0)),
            1 => Blend::between(p(0), p(1), seed as f32 / 50.0),
            _ => Blend::between_per_layer(p(1), p(2), [0.25, 0.5, 0.75, 0.0]),
        };
        for value in evaluate(&policies, &blend, Arithmetic::Reproducible, &input) {
            hash = (hash ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3);
        }
    }
    assert_eq!(hash, PINNED, "found {hash:#x}");
}

/// Of the test above; the same on every processor.
const PINNED: u64 = 0x0014_1df2_a8f3_bd87;

#[test]
fn a_resting_blend_is_cached_and_a_moving_one_is_not() {
    let policies = policies(2);
    let mut evaluator = BlendEvaluator::new(&policies[0], Arithmetic::Reproducible, true);
    let input = Noise(9).numbers(225, 1.0);
    let mut tick = |blend: Blend, mode| {
        let mut out = [0.0; 28];
        (evaluator.evaluate_into(&policies, &blend, mode, &input, &mut out), out)
    };
    let parameters = BlendMode::Parameters;
    let (first, moving) = tick(Blend::between(p(0), p(1), 0.3), parameters);
    assert_eq!(first, Evaluation::Fused);
    let kinds: Vec<Evaluation> =
        (0..8).map(|_| tick(Blend::between(p(0), p(1), 0.3), parameters).0).collect();
    assert!(
        kinds[..3].iter().all(|k| *k == Evaluation::Fused)
            && kinds[4..].iter().all(|k| *k == Evaluation::Cached)
    );
    let (_, resting) = tick(Blend::between(p(0), p(1), 0.3), parameters);
    assert_close(&resting, &moving.map(f64::from));
    assert_eq!(tick(Blend::between(p(0), p(1), 0.31), parameters).0, Evaluation::Fused);
    assert_eq!(tick(Blend::between(p(0), p(1), 0.31), BlendMode::Actions).0, Evaluation::Actions);
    assert_eq!(
        tick(Blend::between(p(0), p(1), 0.31), BlendMode::Switch),
        tick(Blend::single(p(0)), parameters)
    );
}

#[test]
fn blended_actions_are_the_sum_of_the_policies_actions() {
    let policies = policies(2);
    let input = Noise(5).numbers(225, 1.0);
    let mut evaluator = BlendEvaluator::new(&policies[0], Arithmetic::Reproducible, false);
    let mut out = [0.0; 28];
    evaluator.evaluate_into(
        &policies,
        &Blend::between(p(0), p(1), 0.25),
        BlendMode::Actions,
        &input,
        &mut out,
    );
    let [a, b] = [0, 1].map(|i| evaluate(&policies, &Blend::single(p(i)), Arithmetic::Reproducible, &input));
    for i in 0..28 {
        assert!((out[i] - (0.75 * a[i] + 0.25 * b[i])).abs() < 1e-6);
    }
}

#[test]
fn wide_policies_blend_their_actions_too() {
    let policies = [1, 2].map(|seed| mlp(&[20, 16, 200], seed));
    let input = Noise(4).numbers(20, 1.0);
    let mut evaluator = BlendEvaluator::new(&policies[0], Arithmetic::Reproducible, false);
    let mut out = vec![0.0; 200];
    let blend = Blend::between(p(0), p(1), 0.5);
    for _ in 0..2 {
        let kind = evaluator.evaluate_into(&policies, &blend, BlendMode::Actions, &input, &mut out);
        assert_eq!(kind, Evaluation::Actions);
    }
    let mut scratch = MlpScratch::for_mlp(&policies[0]);
    let mut actions = [0, 1].map(|_| vec![0.0; 200]);
    for (policy, action) in policies.iter().zip(&mut actions) {
        policy.evaluate_into(Arithmetic::Reproducible, &input, &mut scratch, action);
    }
    assert!((0..200).all(|i| (out[i] - 0.5 * (actions[0][i] + actions[1][i])).abs() < 1e-6));
}

/// A blend that must not get into a batch.
fn batch_of(blend: Blend) {
    let policies = policies(2);
    let (inputs, mut out) = ([0.1; 225], [0.0; 28]);
    let mut scratch = BatchScratch::for_mlp(&policies[0], 1);
    evaluate_batch_into(&policies, Arithmetic::Reproducible, &[blend], &inputs, &mut scratch, &mut out);
}

#[test]
#[should_panic(expected = "blends of these policies")]
fn a_batch_has_no_empty_blend() {
    batch_of(Blend::default());
}

#[test]
#[should_panic(expected = "blends of these policies")]
fn a_batch_has_no_blend_of_an_unknown_policy() {
    batch_of(Blend::between(p(1), p(2), 0.5));
}
