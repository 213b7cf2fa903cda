//! The playground's course, by a scripted pad: past every checkpoint, over ramps and stairs, through a door and a tunnel.

use std::sync::Arc;

use glam::Vec2;
use physics_bridge::{PropHandle, WorldError};
use playground::{Playground, Race, RaceState, WanderPath, Wanderer};
use policy_core::Heading;
use random::Rng;
use serde::{Deserialize, Serialize};

use super::cast::{Cast, Mark, Player};
use crate::trial::{Gait, TICK_SECS, ticks};
use crate::{EvaluationError, Rig};

/// A run that takes longer is given up, seconds.
const LIMIT_SECS: f32 = 180.0;

/// About how long a run takes with the four others that wander, in seconds of one character's time.
pub(in super::super) const NOMINAL_SECS: f32 = 5.0 * 110.0;

/// How far a start is moved, and a point of the way, metres.
const JITTER_METRES: f32 = 0.15;

/// How a stretch of the way is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pace {
    Walk,
    Jog,
    /// On hands and shins.
    Crawl,
    /// Waits here until the pendulum has swung past, then walks on.
    PastPendulum,
}

/// The way: points, how near they are passed, metres, and the pace towards them.
const WAY: [(f32, f32, f32, Pace); 26] = [
    (2.0, 0.0, 0.5, Pace::Walk),
    // Round the crates.
    (4.4, 1.3, 0.4, Pace::Walk),
    (6.2, 0.5, 0.5, Pace::Walk),
    (11.7, 0.0, 0.6, Pace::Walk),
    (17.2, 0.0, 0.5, Pace::Walk),
    // The door turns about its left post.
    (18.6, -0.2, 0.3, Pace::Walk),
    // It opens towards the far wall: round it.
    (21.3, -0.2, 0.5, Pace::Walk),
    (21.6, 2.4, 0.6, Pace::Walk),
    (20.5, 4.6, 0.8, Pace::Jog),
    (19.6, 6.6, 0.7, Pace::Walk),
    (17.2, 6.3, 0.4, Pace::Walk),
    (14.4, 6.4, 0.6, Pace::Walk),
    (11.0, 6.6, 0.5, Pace::Walk),
    (9.6, 8.0, 0.3, Pace::Walk),
    (5.6, 8.0, 0.8, Pace::PastPendulum),
    (0.0, 7.0, 0.8, Pace::Jog),
    // Over the beams.
    (-3.0, 6.2, 0.4, Pace::Walk),
    (-3.0, 2.0, 0.6, Pace::Walk),
    (-3.0, -4.0, 0.8, Pace::Jog),
    (-2.0, -8.0, 0.5, Pace::Walk),
    (0.6, -8.0, 0.4, Pace::Walk),
    (4.8, -8.0, 0.4, Pace::Walk),
    (9.0, -8.0, 0.5, Pace::Crawl),
    (11.0, -8.0, 0.5, Pace::Crawl),
    (13.4, -8.0, 0.4, Pace::Crawl),
    (15.0, -8.0, 0.5, Pace::Walk),
];

/// Runs over the course.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RaceReport {
    /// Runs, each with its own seed.
    pub runs: usize,
    /// Runs that came to the end without a fall.
    pub without_a_fall: usize,
    /// Runs that came to the end.
    pub finished: usize,
    /// Mean seconds of those.
    pub secs: Option<f32>,
    /// By seed: falls, each with the place where it happened, metres.
    pub falls: Vec<Vec<[f32; 2]>>,
}

/// One run: its time if it came to the end, and where it fell.
type Run = (Option<f32>, Vec<[f32; 2]>);

/// Runs over the course of the playground that ships, for packs with a walk.
///
/// # Errors
/// When the scene is none, or the character can't be put into it.
pub fn measure_race(rig: &Rig<'_>) -> Result<RaceReport, EvaluationError> {
    let Some(walk) = Gait::named(rig.pack, "walk") else { return Ok(RaceReport::default()) };
    let scene = Playground::shipped()?;
    let seeds: Vec<u64> = (0..rig.effort.races as u64).collect();
    let runs = rig.each(&seeds, NOMINAL_SECS, |seed| run(rig, &walk, &scene, *seed));
    let runs: Vec<Run> = runs.into_iter().collect::<Result<_, WorldError>>()?;
    let secs: Vec<f32> = runs.iter().filter_map(|(secs, _)| *secs).collect();
    Ok(RaceReport {
        runs: runs.len(),
        without_a_fall: runs.iter().filter(|(secs, falls)| secs.is_some() && falls.is_empty()).count(),
        finished: secs.len(),
        secs: (!secs.is_empty()).then(|| secs.iter().sum::<f32>() / secs.len() as f32),
        falls: runs.into_iter().map(|(_, falls)| falls).collect(),
    })
}

fn run(rig: &Rig<'_>, walk: &Gait, scene: &Arc<Playground>, seed: u64) -> Result<Run, WorldError> {
    let mut rng = Rng::new(seed, 61);
    let mut moved = |at: Vec2| at + JITTER_METRES * Vec2::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0));
    let mut marks: Vec<Mark> =
        scene.starts.iter().map(|start| Mark { at: start.at, angle: start.heading }).collect();
    marks[0].at = moved(marks[0].at);
    let way = WAY.map(|(x, y, near, pace)| (moved(Vec2::new(x, y)), near, pace));
    let (mut cast, props) = Cast::new(rig, walk, &marks, |edit| {
        for painted in &scene.fixtures {
            edit.add_fixture(painted.fixture.clone())?;
        }
        let add = |placed: &playground::PlacedProp| {
            let prop = edit.add_prop(placed.prop.clone(), placed.start())?;
            placed.joint.map(|joint| edit.join(prop, None, joint)).transpose()?;
            Ok(prop)
        };
        scene.props.iter().map(add).collect::<Result<Vec<PropHandle>, WorldError>>()
    })?;
    let pendulum = scene.props.iter().position(|prop| prop.swing_m.is_some()).map(|index| props[index]);
    let wander_path = WanderPath::of(rig.pack);
    let mut wanderers: Vec<Wanderer> = (1..)
        .zip(&scene.starts[1..])
        .map(|(index, start)| Wanderer::new(start.zone, start.heading, seed, index))
        .collect();
    let (mut race, mut falls, mut next, mut waits) = (Race::default(), Vec::new(), 0, true);
    for _ in 0..ticks(LIMIT_SECS) {
        let at = cast.players[0].position();
        let swings = pendulum.map(|pendulum| cast.world.motion(pendulum)).transpose()?;
        let Some((to, near, pace)) = way.get(next) else { break };
        let clear = swings.is_none_or(|motion| is_clear(motion.position.y - at.y, motion.velocity.y));
        waits &= *pace != Pace::PastPendulum || !clear;
        take(&mut cast.players[0], *to, *pace, waits);
        next += usize::from(at.distance(*to) < *near);
        for (prop, placed) in props.iter().zip(&scene.props) {
            if let Some(force) = placed.swing_force(&cast.world.motion(*prop)?) {
                cast.world.push(*prop, force, TICK_SECS)?;
            }
        }
        cast.tick_with(|index, player| {
            let wanderer = wanderers.get_mut(index.checked_sub(1)?)?;
            let at = player.position();
            Some(wander_path.command(wanderer.tick(at, TICK_SECS), at))
        })?;
        let player = &cast.players[0];
        let before = race.falls();
        race.tick(&scene.checkpoints, player.position(), player.is_down());
        if race.falls() > before {
            falls.push(player.position().into());
        }
        if race.state() == RaceState::Finished {
            break;
        }
    }
    Ok(((race.state() == RaceState::Finished).then(|| race.secs(TICK_SECS)), falls))
}

/// True when it is time to set out: a pendulum `aside` of the way, metres, that moves by `mps` is about to turn back. It passes
/// the way before a walker from its waiting place is there, and once more after it has gone.
fn is_clear(aside: f32, mps: f32) -> bool {
    aside.abs() > 1.6 && aside * mps > 0.0
}

/// Moves the pad so that a player goes to a point; `held_up` makes it wait where it is told to.
fn take(player: &mut Player, to: Vec2, pace: Pace, held_up: bool) {
    let way = to - player.position();
    let heading = Heading::from_rotation(player.state.root().rotation).direction();
    let ahead = way.normalize_or_zero().dot(heading) > 0.8;
    player.pad.right_trigger = if pace == Pace::Jog && ahead { 0.4 } else { 0.0 };
    player.pad.left_trigger = if pace == Pace::Crawl { 1.0 } else { 0.0 };
    let waits = pace == Pace::PastPendulum && held_up;
    player.steer(way.to_angle(), if waits { 0.0 } else { 1.0 });
}
