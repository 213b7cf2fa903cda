//! What one policy costs: one evaluation, a fused blend, a cached blend, a batch.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use policy_core::training::Layer;
use policy_core::{Arithmetic, BatchScratch, Blend, Mlp, MlpScratch, PolicyId, evaluate_batch_into};

fn p(index: usize) -> PolicyId {
    PolicyId::new(index)
}

const SIZES: [usize; 4] = [225, 128, 32, 28];
const CROWD: usize = 256;

fn noise(seed: &mut u32) -> f32 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*seed >> 8) as f32 / (1 << 23) as f32 - 1.0
}

fn policy(mut seed: u32) -> Mlp {
    let layers = SIZES.windows(2).map(|w| {
        let weight: Vec<f32> = (0..w[0] * w[1]).map(|_| noise(&mut seed) * 0.1).collect();
        let bias: Vec<f32> = (0..w[1]).map(|_| noise(&mut seed) * 0.1).collect();
        Layer::from_input_major(w[0], w[1], &weight, &bias).expect("made to shape")
    });
    Mlp::from_layers(layers.collect()).expect("made to shape")
}

fn benches(c: &mut Criterion) {
    let policies = [policy(1), policy(2), policy(3), policy(4)];
    let mut scratch = MlpScratch::for_mlp(&policies[0]);
    let mut seed = 7;
    let input: Vec<f32> = (0..SIZES[0]).map(|_| noise(&mut seed)).collect();
    let mut out = [0.0; 28];
    let arithmetic = Arithmetic::Reproducible;

    for (name, arithmetic) in [("evaluate", arithmetic), ("evaluate_fused_multiply_add", Arithmetic::Fused)] {
        c.bench_function(name, |b| {
            b.iter(|| {
                policies[0].evaluate_into(arithmetic, black_box(&input), &mut scratch, black_box(&mut out));
            });
        });
    }
    let blend = Blend::between(p(0), p(1), 0.3);
    c.bench_function("fused", |b| {
        b.iter(|| {
            blend.evaluate_into(&policies, arithmetic, black_box(&input), &mut scratch, black_box(&mut out));
        });
    });
    let mut cached = policies[0].clone();
    blend.parameters_into(&policies, &mut cached);
    c.bench_function("cached", |b| {
        b.iter(|| cached.evaluate_into(arithmetic, black_box(&input), &mut scratch, black_box(&mut out)));
    });
    c.bench_function("build_cache", |b| {
        b.iter(|| black_box(&blend).parameters_into(&policies, black_box(&mut cached)));
    });

    let inputs: Vec<f32> = (0..CROWD * SIZES[0]).map(|_| noise(&mut seed)).collect();
    let mut outs = vec![0.0; CROWD * 28];
    let mut batch = BatchScratch::for_mlp(&policies[0], CROWD);
    // Three in four characters rest on a policy, the others are on their way between two.
    let moving: Vec<Blend> =
        (0..CROWD).map(|i| Blend::between(p(i % 3), p(i % 3 + 1), (noise(&mut seed) + 1.0) * 0.5)).collect();
    let resting: Vec<Blend> = (0..CROWD).map(|i| Blend::single(p(i % 4))).collect();
    for (name, blends) in [("batched", &moving), ("batched_resting", &resting)] {
        for (kind, arithmetic) in [("", Arithmetic::Fused), ("_reproducible", Arithmetic::Reproducible)] {
            c.bench_function(&format!("{name}{kind}"), |b| {
                b.iter_batched(
                    || (),
                    |()| {
                        evaluate_batch_into(
                            &policies,
                            arithmetic,
                            blends,
                            &inputs,
                            &mut batch,
                            black_box(&mut outs),
                        );
                    },
                    BatchSize::SmallInput,
                );
            });
        }
    }
}

criterion_group!(policy_benches, benches);
criterion_main!(policy_benches);
