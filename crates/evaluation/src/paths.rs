//! Survival and speed along a path.

use std::sync::Arc;

use physics::Model;
use policy_core::training::TARGET_RANGE_METRES;
use policy_core::{BlendMode, CharacterPack, Goal, Heading, PathId};
use random::Rng;
use rayon::prelude::*;

use super::eval_character::{EvalCharacter, SETTLE_SECS, Wanderer};
use super::report::ModeReport;
use crate::trial::TICK_SECS;

/// Seconds that the way from Walk to a coordinate takes, before speed is measured.
const TRAVEL_SECS: f32 = 3.0;

/// What one character met.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walked {
    /// Falls.
    pub falls: u32,
    /// Rises out of a low gait that the recovery skill took over.
    pub rises: u32,
    /// Minutes measured.
    pub minutes: f32,
    /// Mean speed along the wanted direction, metres per second.
    pub speed_mps: f32,
}

fn walk(
    model: &Model,
    pack: &Arc<CharacterPack>,
    path: PathId,
    mode: BlendMode,
    coordinate: Option<f32>,
    (secs, seed): (f32, u64),
) -> Walked {
    let graph = pack.graph();
    let nodes = graph.path(path);
    // The second node of a path is where a full stick and free triggers are: Walk.
    let start = &graph.node(nodes.nodes()[1]).name;
    let mut eval = EvalCharacter::new(model, pack, start);
    eval.controller.set_blend_mode(mode);
    let mut player = Wanderer::new(Rng::new(seed, 7), path, nodes.end(), coordinate);
    let mut walked = Walked::default();
    let (mut along, mut ticks) = (0.0, 0);
    let mut settled = 0.0;
    for _ in 0..((secs + SETTLE_SECS) / TICK_SECS) as u32 {
        let before = eval.position();
        let mut command = player.command(before);
        if settled < SETTLE_SECS {
            // Whoever is stood up walks off first, wherever the trigger is.
            command.target = Some(before + TARGET_RANGE_METRES * player.direction());
            command.goal = Goal::Path { path, coordinate: 1.0 };
        }
        let sound = eval.tick(&command);
        walked.rises += u32::from(eval.controller.report().skill_started.is_some());
        settled += TICK_SECS;
        if settled > SETTLE_SECS + TRAVEL_SECS {
            along += (eval.position() - before).dot(player.direction());
            ticks += 1;
        }
        if !sound || eval.controller.report().fallen {
            walked.falls += 1;
            eval.reset(Heading::from_angle(player.direction().to_angle()));
            settled = 0.0;
        }
    }
    walked.minutes = (secs + SETTLE_SECS) / 60.0;
    walked.speed_mps = along / (ticks.max(1) as f32 * TICK_SECS);
    walked
}

/// Falls, and rises by a skill, under a trigger that sweeps over the whole path, with random turns.
#[must_use]
pub fn measure_sweep(
    model: &Model,
    pack: &Arc<CharacterPack>,
    path: PathId,
    mode: BlendMode,
    (characters, secs): (usize, f32),
) -> ModeReport {
    let each = (0..characters).into_par_iter();
    let walked: Vec<Walked> = each.map(|i| walk(model, pack, path, mode, None, (secs, i as u64))).collect();
    ModeReport {
        falls_per_character_minute: per_minute(&walked, |w| w.falls),
        rises_by_skill_per_character_minute: per_minute(&walked, |w| w.rises),
    }
}

/// Falls per character-minute and mean speed at a coordinate, with random turns.
#[must_use]
pub fn measure_coordinates(
    model: &Model,
    pack: &Arc<CharacterPack>,
    path: PathId,
    mode: BlendMode,
    coordinate: f32,
    (characters, secs): (usize, f32),
) -> (f32, f32) {
    let each = (0..characters).into_par_iter();
    let walked: Vec<Walked> =
        each.map(|i| walk(model, pack, path, mode, Some(coordinate), (secs, i as u64))).collect();
    let speed = walked.iter().map(|w| w.speed_mps).sum::<f32>() / walked.len().max(1) as f32;
    (per_minute(&walked, |w| w.falls), speed)
}

fn per_minute(walked: &[Walked], count: impl Fn(&Walked) -> u32) -> f32 {
    let counted: u32 = walked.iter().map(count).sum();
    let minutes: f32 = walked.iter().map(|w| w.minutes).sum();
    counted as f32 / minutes.max(1e-6)
}
