//! What a whole control tick costs: the trigger at rest, the trigger moving.
#![allow(missing_docs, reason = "criterion's macros make a function without any")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use policy_core::glam::{Quat, Vec2, Vec3};
use policy_core::{CharacterState, Command, Controller, Goal, PathId, Skeleton};

fn benches(c: &mut Criterion) {
    let pack = Arc::new(common::pack(0.0));
    let mut noise = common::Noise(5);
    let mut state = CharacterState::new(&Skeleton::humanoid());
    for body in &mut state.bodies {
        let mut vector = || Vec3::new(noise.number(), noise.number(), noise.number());
        (body.position, body.linear_velocity, body.angular_velocity) =
            (vector() + Vec3::Z * 2.0, vector(), vector());
        body.rotation = Quat::from_rotation_x(noise.number());
    }
    let target = Some(Vec2::new(3.0, 1.0));
    let mut controller = Controller::new(pack.clone());
    let resting =
        Command { target, goal: Goal::Path { path: PathId::new(0), coordinate: 1.4 }, ..Command::default() };
    for _ in 0..100 {
        controller.tick(&state, &resting, 0.1);
    }
    c.bench_function("tick", |b| {
        b.iter(|| black_box(controller.tick(black_box(&state), &resting, 1.0 / 30.0))[0]);
    });
    let mut coordinate = 0.0;
    let mut controller = Controller::new(pack);
    c.bench_function("tick_moving", |b| {
        b.iter(|| {
            coordinate = (coordinate + 0.003) % 3.0;
            let moving = Command {
                target,
                goal: Goal::Path { path: PathId::new(0), coordinate },
                ..Command::default()
            };
            black_box(controller.tick(black_box(&state), &moving, 1.0 / 30.0))[0]
        });
    });
}

criterion_group!(tick_benches, benches);
criterion_main!(tick_benches);
