//! The playground's course, by a scripted pad: past every checkpoint, over ramps and stairs, through a door and a tunnel.

use std::sync::Arc;

use glam::Vec2;
use physics_bridge::{PropHandle, WorldError};
use playground::{Follower, Playground, Race, RaceState, WanderPath, Wanderer, Waypoint};
use policy_core::Heading;
use random::Rng;
use serde::{Deserialize, Serialize};

use super::cast::{Cast, Mark};
use crate::trial::{Gait, TICK_SECS, ticks};
use crate::{EvaluationError, Rig};

/// A run that takes longer is given up, seconds.
const LIMIT_SECS: f32 = 180.0;

/// About how long a run takes with the four others that wander, in seconds of one character's time.
pub(in super::super) const NOMINAL_SECS: f32 = 5.0 * 110.0;

/// How far a start is moved, and a point of the way, metres.
const JITTER_METRES: f32 = 0.15;

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
    let moved = |waypoint: &Waypoint| Waypoint { at: moved(waypoint.at), ..*waypoint };
    let way: Vec<Waypoint> = scene.way.iter().map(moved).collect();
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
    let wander_path = WanderPath::of(rig.pack);
    let mut wanderers: Vec<Wanderer> = (1..)
        .zip(&scene.starts[1..])
        .map(|(index, start)| Wanderer::new(start.zone, start.heading, seed, index))
        .collect();
    let (mut race, mut falls, mut follower) = (Race::default(), Vec::new(), Follower::default());
    for _ in 0..ticks(LIMIT_SECS) {
        let player = &mut cast.players[0];
        let view =
            (player.position(), Heading::from_rotation(player.state.root().rotation), Heading::FORWARD);
        let motion = |index: usize| cast.world.motion(props[index]).ok();
        let Some(pad) = follower.tick(&way, view, motion, TICK_SECS) else { break };
        player.pad = pad;
        for (prop, placed) in props.iter().zip(&scene.props) {
            // A prop that diverged may have been taken out.
            let Ok(motion) = cast.world.motion(*prop) else { continue };
            if let Some(force) = placed.swing_force(&motion) {
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
