//! How fast is a shared world, and where does the time go?
//!
//! 64 characters of the shipped pack walk, jog and run across a square with 200 props in it, in one world on one
//! thread: controllers and physics. Beside it, a crowd of characters apart on all cores. Prints a table, or one JSON
//! object with `--json`.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

use physics_bridge::{
    Character, CharacterHandle, Crowd, Model, Motion, Prop, Solid, StageTimes, World, WorldError, measure_stages,
};
use policy_core::glam::{Vec2, Vec3};
use policy_core::{CharacterPack, Command, Controller, Goal, Heading};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");
const CHARACTERS: usize = 64;
const PROPS: usize = 200;
const APART: usize = 128;
/// Ticks of a round: ten seconds.
const TICKS: u32 = 300;
const ROUNDS: usize = 3;

struct Walker {
    character: CharacterHandle,
    controller: Controller,
    goal: Goal,
    target: Vec2,
}

/// Where the i-th of many is on a square grid about the origin, metres.
fn grid(index: usize, count: usize, spacing: f32) -> Vec2 {
    let side = (count as f32).sqrt().ceil() as usize;
    let place = Vec2::new((index % side) as f32, (index / side) as f32);
    (place - 0.5 * (side - 1) as f32) * spacing
}

fn prop(index: usize) -> Prop {
    match index % 5 {
        0 | 1 => Prop::cube(0.3, 4.0),
        2 => Prop::ball(0.12, 0.6),
        3 => Prop::new(Solid::Capsule { radius: 0.1, half_length: 0.2 }, 3.0),
        _ => Prop::new(Solid::Cylinder { radius: 0.2, half_length: 0.2 }, 4.0),
    }
}

fn world(pack: &Arc<CharacterPack>, model: &Model) -> Result<(World, Vec<Walker>), WorldError> {
    let path = pack.graph().path_named("speed").expect("the humanoid has a path named speed");
    let mut world = World::new(model)?;
    let characters = world.edit(|edit| {
        for index in 0..PROPS {
            let at = grid(index, PROPS, 1.3) + Vec2::splat(0.5);
            edit.add_prop(prop(index), Motion::at(at.extend(0.4)))?;
        }
        let stand = |index| {
            let at = grid(index, CHARACTERS, 2.2);
            edit.add_character(model, at.x, at.y, Heading::from_angle(2.4 * index as f32), 1.0)
        };
        (0..CHARACTERS).map(stand).collect::<Result<Vec<_>, _>>()
    })?;
    let walker = |(index, character): (usize, CharacterHandle)| Walker {
        character,
        controller: Controller::new(Arc::clone(pack)),
        goal: Goal::Path { path, coordinate: 0.4 + 2.0 * index as f32 / CHARACTERS as f32 },
        target: grid((index * 29 + 7) % CHARACTERS, CHARACTERS, 2.2),
    };
    Ok((world, characters.into_iter().enumerate().map(walker).collect()))
}

/// Seconds that a round takes, and how many contacts there were between two things that move, in the last tick.
fn together(world: &mut World, walkers: &mut [Walker]) -> (f64, usize) {
    let start = Instant::now();
    for tick in 0..TICKS {
        if tick % 90 == 89 {
            for (index, walker) in walkers.iter_mut().enumerate() {
                walker.target = grid((index * 13 + tick as usize) % CHARACTERS, CHARACTERS, 2.2);
            }
        }
        world.control_tick_with(walkers, 1.0 / 30.0, |walker| {
            let command =
                Command { target: Some(walker.target), goal: walker.goal, ..Command::default() };
            (walker.character, &mut walker.controller, command)
        });
    }
    let moves = |part: &physics_bridge::Part| !matches!(part, physics_bridge::Part::Ground);
    let touching = world.contacts().iter().filter(|contact| contact.parts.iter().all(moves)).count();
    (start.elapsed().as_secs_f64(), touching)
}

/// Seconds that characters apart take for a round.
fn apart(pack: &Arc<CharacterPack>, model: &Model, threads: NonZeroUsize) -> Result<f64, Box<dyn std::error::Error>> {
    let walk = Goal::Node(pack.graph().node_named("walk").ok_or("expected a node named walk")?);
    let mut crowd = Crowd::new((0..APART).map(|_| Character::new(model)).collect(), Some(threads))?;
    let mut controllers = vec![Controller::new(Arc::clone(pack)); APART];
    let commands: Vec<_> = (0..APART)
        .map(|index| {
            let target = Some(Vec3::new(1000.0, index as f32, 0.0).truncate());
            Command { target, goal: walk, ..Command::default() }
        })
        .collect();
    let start = Instant::now();
    for _ in 0..TICKS {
        crowd.control_tick(&mut controllers, &commands, 1.0 / 30.0);
    }
    Ok(start.elapsed().as_secs_f64())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?;
    let model = Model::for_pack(&pack)?;
    let pack = Arc::new(pack);
    measure_stages();
    let started = Instant::now();
    let (mut world, mut walkers) = world(&pack, &model)?;
    let build_ms = 1e3 * started.elapsed().as_secs_f64();
    let rounds: Vec<_> = (0..ROUNDS).map(|_| together(&mut world, &mut walkers)).collect();
    let touching = rounds.iter().map(|round| round.1).max().unwrap_or(0);
    let secs = median(rounds.iter().map(|round| round.0).collect());
    let simulated = f64::from(TICKS) / 30.0;
    let steps = f64::from(TICKS * model.substeps());
    let threads = std::thread::available_parallelism()?;
    let crowd_secs = median((0..ROUNDS).map(|_| apart(&pack, &model, threads)).collect::<Result<_, _>>()?);
    let (realtime, step_ms) = (simulated / secs, 1e3 * secs / steps);
    let crowd = APART as f64 * simulated / crowd_secs;
    let times = world.stage_times();
    let stages = stages(&times);
    if std::env::args().any(|argument| argument == "--json") {
        let stages: String = stages.iter().map(|(name, ms)| format!(",\"{name}_ms\":{ms:.4}")).collect();
        println!(
            "{{\"realtime_factor\":{realtime:.3},\"step_ms\":{step_ms:.4},\"characters_apart_realtime\":{crowd:.1},\
             \"build_ms\":{build_ms:.1},\"touching\":{touching}{stages},\"threads\":{threads}}}"
        );
    } else {
        println!("{CHARACTERS} characters and {PROPS} props in one world, one thread, {ROUNDS} rounds of {simulated} s");
        println!("real time                {realtime:9.2} times");
        println!("a step, control included {step_ms:9.3} ms");
        println!("building it              {build_ms:9.1} ms");
        println!("contacts between movers  {touching:9}");
        for (name, ms) in stages {
            println!("  {name:<22} {ms:9.3} ms a step");
        }
        println!("characters apart         {crowd:9.1} in real time on {threads} threads");
    }
    Ok(())
}

/// Milliseconds a step that MuJoCo spends in each stage, by its own timers.
fn stages(times: &StageTimes) -> [(&'static str, f64); 9] {
    let ms = |secs: f64| 1e3 * secs / times.steps.max(1) as f64;
    [
        ("kinematics", ms(times.kinematics)),
        ("inertia", ms(times.inertia)),
        ("collision", ms(times.collision)),
        ("constraints", ms(times.constraints)),
        ("velocity", ms(times.velocity)),
        ("actuation", ms(times.actuation)),
        ("solver", ms(times.solver)),
        ("advance", ms(times.advance)),
        ("mujoco", ms(times.total)),
    ]
}
