//! How much of a crowd's tick do controllers and policies take, as a batch and one by one?
//!
//! Humanoids on every part of the path speed: in the first half of a round their coordinates move, in the second they
//! rest. Both ways run in turns, in one process. Prints a table, or one JSON object with `--json`.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec2;
use physics_bridge::{Character, Crowd, Model};
use policy_core::{CharacterPack, Command, Controller, Goal, Heading};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");
const CHARACTERS: usize = 96;
const TICKS: usize = 60;
const ROUNDS: usize = 5;

/// Shares of the time of all threads, in percent: coordinates that move, coordinates that rest.
type Shares = [f64; 2];

fn command(pack: &CharacterPack, index: usize, tick: usize) -> Command {
    let path = pack.graph().path_named("speed").expect("the humanoid has a path named speed");
    let moves = 0.01 * tick.min(TICKS / 2) as f32;
    let coordinate = 2.5 * index as f32 / CHARACTERS as f32 + moves;
    let target = Some(Vec2::new(1000.0, 3.0 * index as f32));
    Command { target, goal: Goal::Path { path, coordinate }, ..Command::default() }
}

/// Resets everything and runs a round. `tick` returns the time that the controllers took.
fn round(
    crowd: &mut Crowd,
    controllers: &mut [Controller],
    mut tick: impl FnMut(&mut Crowd, &mut [Controller], &[Command]) -> Duration,
) -> Shares {
    for (index, (character, controller)) in crowd.characters_mut().zip(controllers.iter_mut()).enumerate() {
        character.stand_at(0.0, 3.0 * index as f32, Heading::FORWARD, 1.0).expect("a finite place");
        controller.reset();
    }
    let pack = Arc::clone(controllers[0].pack());
    let (mut control, mut whole) = ([0.0; 2], [0.0; 2]);
    for at in 0..TICKS {
        let commands: Vec<_> = (0..CHARACTERS).map(|index| command(&pack, index, at)).collect();
        let (half, start) = (2 * at / TICKS, Instant::now());
        control[half] += tick(crowd, controllers, &commands).as_secs_f64();
        whole[half] += start.elapsed().as_secs_f64() * crowd.threads() as f64;
    }
    [0, 1].map(|half| 100.0 * control[half] / whole[half])
}

fn batch(crowd: &mut Crowd, controllers: &mut [Controller], commands: &[Command]) -> Duration {
    crowd.control_tick(controllers, commands, 1.0 / 30.0);
    crowd.control_time()
}

fn one_by_one(crowd: &mut Crowd, controllers: &mut [Controller], commands: &[Command]) -> Duration {
    let mut members: Vec<_> = controllers.iter_mut().zip(commands).map(|c| (c, Duration::ZERO)).collect();
    crowd.tick_with(&mut members, |_, ((controller, command), time), state, targets| {
        let start = Instant::now();
        targets.copy_from_slice(controller.tick(state, command, 1.0 / 30.0));
        *time = start.elapsed();
    });
    members.iter().map(|(_, time)| *time).sum()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?;
    let model = Model::for_pack(&pack)?;
    let threads = std::thread::available_parallelism().ok();
    let mut crowd = Crowd::new((0..CHARACTERS).map(|_| Character::new(&model)).collect(), threads)?;
    let mut controllers = vec![Controller::new(Arc::new(pack)); CHARACTERS];

    let (mut batched, mut single) = (Vec::new(), Vec::new());
    for at in 0..=ROUNDS {
        let pair =
            (round(&mut crowd, &mut controllers, batch), round(&mut crowd, &mut controllers, one_by_one));
        if at > 0 {
            batched.push(pair.0);
            single.push(pair.1);
        }
    }
    let shares = |rounds: &[Shares]| [0, 1].map(|half| median(rounds.iter().map(|r| r[half]).collect()));
    let ([moving, resting], [moving_single, resting_single]) = (shares(&batched), shares(&single));
    let threads = threads.map_or(1, NonZeroUsize::get);
    if std::env::args().any(|argument| argument == "--json") {
        println!(
            "{{\"control_percent_moving\":{moving:.2},\"control_percent_resting\":{resting:.2},\
             \"one_by_one_percent_moving\":{moving_single:.2},\"one_by_one_percent_resting\":{resting_single:.2},\
             \"threads\":{threads}}}"
        );
    } else {
        println!("{CHARACTERS} characters on {threads} threads, share of a crowd's tick that is not physics");
        println!("              coordinates move   coordinates rest");
        println!("batch         {moving:14.2} %   {resting:14.2} %");
        println!("one by one    {moving_single:14.2} %   {resting_single:14.2} %");
    }
    Ok(())
}
