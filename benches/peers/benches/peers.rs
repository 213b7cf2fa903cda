//! What one evaluation of the policy costs in each inference library.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use peers::inference::{ACTION_LEN, Network, check, peers};

fn evaluate(criterion: &mut Criterion) {
    let network = Network::from_seed(1);
    let observation = Network::observation(2);
    let expected = network.expected(&observation);
    let mut group = criterion.benchmark_group("peers");
    for (name, mut peer) in peers(&network).expect("every library takes the network") {
        check(name, peer.as_mut(), &observation, &expected).expect("every library agrees with policy-core");
        let mut action = [0.0; ACTION_LEN];
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                peer.evaluate_into(black_box(&observation), black_box(&mut action)).expect("it just did");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
