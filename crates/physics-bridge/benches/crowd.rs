//! How much of MuJoCo's own stepping rate is left when a crowd senses, actuates and steps?
//!
//! Both run the golden walk's joint targets with the same number of characters on the same number of threads,
//! in turns, in one process: `bare` is `mj_step` four times a tick over data that nobody reads. Prints a
//! table, or one JSON object with `--json`.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use physics_bridge::{CONTROL_HZ, Character, Crowd, Model, Pose};
use policy_core::JointTargets;

const HUMANOID: &str = include_str!("../../../assets/humanoid.xml");
const GOLDEN: &str = include_str!("../../../tests/golden/golden_walk.json");
const CHARACTERS: usize = 128;
const ROUNDS: usize = 12;

/// The recorded start and joint targets.
struct Walk {
    start: Pose,
    targets: Vec<JointTargets>,
}

fn golden_walk() -> Walk {
    let golden: serde_json::Value = serde_json::from_str(GOLDEN).expect("the golden file is JSON");
    let ticks = golden["ticks"].as_array().expect("a list of ticks");
    let numbers = |tick: usize, field: &str| -> Vec<f64> {
        serde_json::from_value(ticks[tick][field].clone()).expect("a list of numbers")
    };
    let targets = |tick| {
        let ctrl = numbers(tick, "ctrl");
        JointTargets::from(ctrl.iter().map(|&target| target as f32).collect::<Vec<_>>())
    };
    Walk {
        start: Pose { qpos: numbers(0, "qpos"), qvel: numbers(0, "qvel") },
        targets: (0..ticks.len()).map(targets).collect(),
    }
}

/// Seconds that bare MuJoCo takes for the walk.
fn bare(walk: &Walk, shares: &mut [Vec<MjData<Arc<MjModel>>>]) -> f64 {
    for data in shares.iter_mut().flatten() {
        data.reset();
        data.qpos_mut().copy_from_slice(&walk.start.qpos);
        data.qvel_mut().copy_from_slice(&walk.start.qvel);
    }
    let start = Instant::now();
    std::thread::scope(|scope| {
        for share in shares {
            scope.spawn(|| {
                for targets in &walk.targets {
                    for data in share.iter_mut() {
                        for (to, &from) in data.ctrl_mut().iter_mut().zip(&**targets) {
                            *to = from.into();
                        }
                        (0..4).for_each(|_| data.step());
                    }
                }
            });
        }
    });
    start.elapsed().as_secs_f64()
}

/// Seconds that the crowd takes for the walk.
fn crowd(walk: &Walk, crowd: &mut Crowd) -> f64 {
    for character in crowd.characters_mut() {
        character.set_pose(&walk.start.qpos, &walk.start.qvel).expect("the recording is a pose");
    }
    let start = Instant::now();
    for recorded in &walk.targets {
        let diverged = crowd.tick(|_, state, targets| {
            std::hint::black_box(state);
            targets.copy_from_slice(recorded);
        });
        assert_eq!(diverged, 0, "the recording is stable");
    }
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let walk = golden_walk();
    let threads = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let model = Model::from_mjcf(HUMANOID).expect("the humanoid is valid");
    let bare_model = Arc::new(MjModel::from_xml_string(HUMANOID).expect("the humanoid is valid"));
    let mut shares: Vec<Vec<_>> = (0..threads).map(|_| Vec::new()).collect();
    (0..CHARACTERS).for_each(|index| shares[index % threads].push(MjData::new(Arc::clone(&bare_model))));
    let characters = (0..CHARACTERS).map(|_| Character::new(&model)).collect();
    let mut members = Crowd::new(characters, NonZeroUsize::new(threads)).expect("threads");

    let (mut bare_secs, mut crowd_secs) = (Vec::new(), Vec::new());
    for round in 0..=ROUNDS {
        let (b, c) = (bare(&walk, &mut shares), crowd(&walk, &mut members));
        if round > 0 {
            bare_secs.push(b);
            crowd_secs.push(c);
        }
    }
    let ticks = (CHARACTERS * walk.targets.len()) as f64;
    let realtime = |secs: Vec<f64>| ticks / median(secs) / f64::from(CONTROL_HZ);
    let shares: Vec<f64> = bare_secs.iter().zip(&crowd_secs).map(|(b, c)| b / c).collect();
    let (share, bare, crowd) = (median(shares), realtime(bare_secs), realtime(crowd_secs));
    if std::env::args().any(|argument| argument == "--json") {
        println!(
            "{{\"characters_realtime\":{crowd:.1},\"bare_mujoco_characters\":{bare:.1},\"share\":{share:.4},\
             \"threads\":{threads}}}"
        );
    } else {
        println!(
            "{threads} threads, {CHARACTERS} characters, {ROUNDS} rounds of {} ticks",
            walk.targets.len()
        );
        println!("bare MuJoCo            {bare:8.1} characters in real time");
        println!("crowd, sense and step  {crowd:8.1} characters in real time");
        println!("share                  {:8.1} %", 100.0 * share);
    }
}
