//! How fast is a shared world, and where does the time go?
//!
//! 64 characters of the shipped pack walk, jog and run across a square with 200 props in it, in one world on one
//! thread: controllers and physics. Beside it, a crowd of characters apart on all cores. Prints a table, or one JSON
//! object with `--json`.
//!
//! Figures are by processor time where the system tells it (Linux), so that other busy programs count little, and by
//! the clock elsewhere. `realtime_factor_wall` and `characters_apart_wall` are always by the clock.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

use physics_bridge::{
    Character, CharacterHandle, Crowd, Model, Motion, Prop, Solid, StageTimes, World, WorldError,
    measure_stages,
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

/// Time that something took, seconds: of the processor, and by the clock.
#[derive(Clone, Copy)]
struct Took {
    processor: f64,
    clock: f64,
}

/// Runs `work`. Processor time is that of this thread, or of the whole process.
fn took(whole_process: bool, work: impl FnOnce()) -> Took {
    let (start, before) = (Instant::now(), processor_secs(whole_process));
    work();
    let clock = start.elapsed().as_secs_f64();
    let after = processor_secs(whole_process);
    Took { processor: before.zip(after).map_or(clock, |(before, after)| after - before), clock }
}

/// Processor time so far, seconds; `None` where the system does not tell.
fn processor_secs(whole_process: bool) -> Option<f64> {
    if whole_process {
        // Fields 14 and 15, in hundredths of a second; the name before them may have spaces.
        let text = std::fs::read_to_string("/proc/self/stat").ok()?;
        let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
        let mut next = || fields.next()?.parse::<f64>().ok();
        return Some(0.01 * (next()? + next()?));
    }
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// Runs a round. Returns how many contacts there were between two things that move, in the last tick.
fn together(world: &mut World, walkers: &mut [Walker]) -> usize {
    for tick in 0..TICKS {
        if tick % 90 == 89 {
            for (index, walker) in walkers.iter_mut().enumerate() {
                walker.target = grid((index * 13 + tick as usize) % CHARACTERS, CHARACTERS, 2.2);
            }
        }
        world.control_tick_with(walkers, 1.0 / 30.0, |walker| {
            let command = Command { target: Some(walker.target), goal: walker.goal, ..Command::default() };
            (walker.character, &mut walker.controller, command)
        });
    }
    let moves = |part: &physics_bridge::Part| !matches!(part, physics_bridge::Part::Ground);
    world.contacts().iter().filter(|contact| contact.parts.iter().all(moves)).count()
}

/// What characters apart take for a round.
fn apart(
    pack: &Arc<CharacterPack>,
    model: &Model,
    threads: NonZeroUsize,
) -> Result<Took, Box<dyn std::error::Error>> {
    let walk = Goal::Node(pack.graph().node_named("walk").ok_or("expected a node named walk")?);
    let mut crowd = Crowd::new((0..APART).map(|_| Character::new(model)).collect(), Some(threads))?;
    let mut controllers = vec![Controller::new(Arc::clone(pack)); APART];
    let commands: Vec<_> = (0..APART)
        .map(|index| {
            let target = Some(Vec3::new(1000.0, index as f32, 0.0).truncate());
            Command { target, goal: walk, ..Command::default() }
        })
        .collect();
    Ok(took(true, || {
        for _ in 0..TICKS {
            crowd.control_tick(&mut controllers, &commands, 1.0 / 30.0);
        }
    }))
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
    let mut made = None;
    let build = took(false, || made = Some(world(&pack, &model)));
    let (mut world, mut walkers) = made.ok_or("expected a world")??;
    let mut touching = 0;
    let rounds: Vec<_> = (0..ROUNDS)
        .map(|_| took(false, || touching = together(&mut world, &mut walkers).max(touching)))
        .collect();
    let threads = std::thread::available_parallelism()?;
    let crowd = (0..ROUNDS).map(|_| apart(&pack, &model, threads)).collect::<Result<Vec<_>, _>>()?;
    let both = |rounds: &[Took]| {
        [rounds.iter().map(|r| r.processor).collect(), rounds.iter().map(|r| r.clock).collect()].map(median)
    };
    let simulated = f64::from(TICKS) / 30.0;
    let [realtime, realtime_wall] = both(&rounds).map(|secs| simulated / secs);
    let [crowd, crowd_wall] = both(&crowd);
    let crowd = APART as f64 * simulated * threads.get() as f64 / crowd;
    let crowd_wall = APART as f64 * simulated / crowd_wall;
    let step_ms = 1e3 * simulated / realtime / f64::from(TICKS * model.substeps());
    let build_ms = 1e3 * build.processor;
    let times = world.stage_times();
    let stages = stages(&times);
    if std::env::args().any(|argument| argument == "--json") {
        let stages: String = stages.iter().map(|(name, ms)| format!(",\"{name}_ms\":{ms:.4}")).collect();
        println!(
            "{{\"realtime_factor\":{realtime:.3},\"step_ms\":{step_ms:.4},\"characters_apart_realtime\":{crowd:.1},\
             \"realtime_factor_wall\":{realtime_wall:.3},\"characters_apart_wall\":{crowd_wall:.1},\
             \"build_ms\":{build_ms:.1},\"touching\":{touching}{stages},\"threads\":{threads}}}"
        );
    } else {
        println!(
            "{CHARACTERS} characters and {PROPS} props in one world, one thread, {ROUNDS} rounds of {simulated} s"
        );
        println!("real time                {realtime:9.2} times, by the clock {realtime_wall:.2}");
        println!("a step, control included {step_ms:9.3} ms");
        println!("building it              {build_ms:9.1} ms");
        println!("contacts between movers  {touching:9}");
        for (name, ms) in stages {
            println!("  {name:<22} {ms:9.3} ms a step");
        }
        println!("characters apart         {crowd:9.1} on {threads} threads, by the clock {crowd_wall:.1}");
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
