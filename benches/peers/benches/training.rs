//! What one gradient step of the recipes' networks costs in the trainer and in each training library.
#![allow(missing_docs)]

use std::time::Duration;

use anyhow::Context;
use criterion::{Criterion, criterion_group, criterion_main};
use peers::training::{check, jobs, learners};

fn gradient_step(criterion: &mut Criterion) {
    for job in jobs() {
        let mut group = criterion.benchmark_group(job.name);
        group
            .sample_size(20)
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(2));
        for (name, mut learner) in learners(&job).expect("every library takes the network") {
            let mut expected = learners(&job).expect("they just did").swap_remove(0).1;
            check(learner.as_mut(), expected.as_mut())
                .with_context(|| format!("{name}, {}", job.name))
                .expect("every library agrees with the trainer");
            group.bench_function(name, |bencher| {
                bencher.iter(|| learner.step().expect("it just did"));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, gradient_step);
criterion_main!(benches);
