//! What a fixed step costs with 1 and with 20 walking characters, without a window.
//!
//! It takes the least time of steps with a control tick and of steps without one, so that other programs on the machine
//! count little, and their mean by how many there are of each.
//!
//! `cargo run --release --example bench_tick -- --json`

use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_policy_space::prelude::*;
use bevy_rapier3d::prelude::RapierContextSimulation;

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
const HZ: f64 = 64.0;
const WARM_UP: usize = 128;
const STEPS: usize = 640;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let bytes = std::fs::read(PACK)?;
    let [(one, one_own), (twenty, twenty_own)] = [measure(&bytes, 1)?, measure(&bytes, 20)?];
    if std::env::args().any(|word| word == "--json") {
        println!(
            "{{\"bevy_tick_us_1\": {one:.1}, \"bevy_tick_us_20\": {twenty:.1}, \
             \"bevy_plugin_us_1\": {one_own:.1}, \"bevy_plugin_us_20\": {twenty_own:.1}}}"
        );
    } else {
        println!("microseconds of a fixed step at {HZ} Hz; in brackets without Rapier's step");
        println!("1 character: {one:.1} ({one_own:.1})   20 characters: {twenty:.1} ({twenty_own:.1})");
    }
    Ok(())
}

/// Microseconds of an update with so many characters, and the same without Rapier's step.
fn measure(bytes: &[u8], count: usize) -> Result<(f64, f64), Box<dyn std::error::Error>> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), PolicySpacePlugins))
        .insert_resource(Time::<Fixed>::from_hz(HZ))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / HZ)));
    app.finish();
    app.cleanup();
    let world = app.world_mut();
    world.spawn((Collider::cuboid(500.0, 0.5, 500.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    let pack = world.resource_mut::<Assets<PackAsset>>().add(PackAsset::from_bytes(bytes)?);
    for index in 0..count {
        let place = Vec3::new(4.0 * index as f32 - 40.0, 0.0, 0.0);
        let ahead = place - Vec3::Z * 1000.0;
        let command = CharacterCommand::along("speed", 1.0, ahead);
        world.spawn((PolicyCharacter::new(pack.clone()), command, Transform::from_translation(place)));
    }
    for _ in 0..WARM_UP {
        app.update();
    }
    // Of steps without and with a control tick: how many, and the least times.
    let mut kinds = [(0.0, f64::MAX, f64::MAX); 2];
    let mut contexts = app.world_mut().query::<&RapierContextSimulation>();
    let mut reports = app.world_mut().query::<&CharacterReport>();
    let mut ticks = 0;
    for _ in 0..STEPS {
        let start = Instant::now();
        app.update();
        let whole = start.elapsed().as_secs_f64() * 1e6;
        let own = whole - contexts.single(app.world())?.step_stats().step_time_ms * 1e3;
        let now: u64 = reports.iter(app.world()).map(|report| report.ticks).sum();
        let kind = &mut kinds[usize::from(now > ticks)];
        *kind = (kind.0 + 1.0, kind.1.min(whole), kind.2.min(own));
        ticks = now;
    }
    let mean = |pick: fn(&(f64, f64, f64)) -> f64| {
        kinds.iter().filter(|kind| kind.0 > 0.0).map(|kind| kind.0 * pick(kind)).sum::<f64>() / STEPS as f64
    };
    Ok((mean(|kind| kind.1), mean(|kind| kind.2)))
}
