//! The legs while a gait goes on: feet that slide under load, shins and feet that are inside each other.

mod convex;
mod overlap;
mod slide;

use std::collections::BTreeMap;

use policy_core::{BodyId, Skeleton};
use serde::Serialize;

use super::Rig;
use super::trial::{Settled, Trial, mean, ticks};

pub use overlap::{PlacedShape, overlap_depth};
pub use slide::FootSlide;

/// Seconds that a gait is watched.
const WATCHED_SECS: f32 = 8.0;

/// Legs that are deeper inside each other overlap, metres.
const OVERLAP_METRES: f32 = 0.01;

/// What the legs of a gait do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LegReport {
    /// Mean horizontal speed of the lowest point of feet that bear at least 5 % of the weight, metres per second.
    pub foot_slide_mps: f32,
    /// Share of ticks in which a shin or foot is more than 1 cm inside one of another leg, 0 to 1.
    pub self_overlap: f32,
    /// Greatest depth, metres.
    pub self_overlap_depth_m: f32,
}

/// Bodies of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Leg {
    foot: BodyId,
    /// What the foot hangs on.
    shin: Option<BodyId>,
}

impl Leg {
    fn all(skeleton: &Skeleton) -> Vec<Leg> {
        skeleton.feet().iter().map(|foot| Leg { foot: *foot, shin: skeleton.parent(*foot) }).collect()
    }

    fn contains(&self, body: BodyId) -> bool {
        body == self.foot || Some(body) == self.shin
    }
}

/// The legs in every gait, straight ahead, by gait; gaits in which every character falls are left out.
#[must_use]
pub fn measure_legs(rig: &Rig<'_>) -> BTreeMap<String, LegReport> {
    let measure = |gait: &super::trial::Gait| {
        let settled = rig.settled(gait);
        let watched: Vec<Watched> =
            rig.each(&settled, WATCHED_SECS, |from| watch(rig, from)).into_iter().flatten().collect();
        let of = |value: fn(&Watched) -> f32| mean(watched.iter().map(value));
        let report = LegReport {
            foot_slide_mps: of(|w| w.slide)?,
            self_overlap: of(|w| w.overlap)?,
            self_overlap_depth_m: watched.iter().map(|w| w.depth).fold(0.0, f32::max),
        };
        Some((gait.name.into(), report))
    };
    rig.gaits().iter().filter_map(measure).collect()
}

/// One character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Watched {
    slide: f32,
    overlap: f32,
    depth: f32,
}

fn watch(rig: &Rig<'_>, from: &Settled) -> Option<Watched> {
    let mut trial = from.resume(rig.model);
    let legs = Leg::all(rig.pack.skeleton());
    let (mut slide, mut overlaps, mut depth) = (FootSlide::default(), 0, 0.0_f32);
    for _ in 0..ticks(WATCHED_SECS) {
        if !trial.tick() || trial.is_down() {
            return None;
        }
        slide.tick(&trial);
        let deep = legs_depth(&trial, &legs);
        overlaps += u32::from(deep > OVERLAP_METRES);
        depth = depth.max(deep);
    }
    Some(Watched { slide: slide.mean_mps(), overlap: overlaps as f32 / ticks(WATCHED_SECS) as f32, depth })
}

/// How deep a shin or foot is inside one of another leg, metres; negative or 0 when they are apart.
fn legs_depth(trial: &Trial, legs: &[Leg]) -> f32 {
    let shapes_of = |leg: &Leg| -> Vec<PlacedShape> {
        let shapes =
            trial.character.model().described().shapes().iter().filter(|shape| leg.contains(shape.body));
        shapes.map(|shape| PlacedShape::new(shape, trial.state.body(shape.body))).collect()
    };
    let placed: Vec<Vec<PlacedShape>> = legs.iter().map(shapes_of).collect();
    let pairs =
        placed.iter().enumerate().flat_map(|(i, leg)| placed[..i].iter().map(move |other| (leg, other)));
    let depths = pairs.flat_map(|(leg, other)| {
        leg.iter().flat_map(move |a| other.iter().map(move |b| overlap_depth(a, b)))
    });
    depths.fold(f32::NEG_INFINITY, f32::max)
}
