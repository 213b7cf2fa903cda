//! Agility: while a character does not move yet as it is asked to, a gait is blended with its agile variant; once it has
//! done as it is asked to for a while, with its steady variant; where it has no target and stays in a gait that moves, with its resting
//! variant; while it sets off from a stand, with its starting variant; while it comes to a stand, with its stopping
//! variant; while it turns, with its turning variant.
//!
//! A gait that turns, starts or stops quickly looks hurried while it walks straight ahead. So the variant acts in the moments in which
//! it is needed, and not at all once the character goes as it is asked to; without other variants the gait then acts with the bits that it
//! has alone. Nor does a gait that is ready for anything look at ease: a stand that can brake and set off leans and shuffles, a walk that
//! can turn takes short steps. A steady variant stands upright and still, or goes straight, and does nothing else well.

use glam::Vec2;

use crate::footing::steepest;
use crate::graph::{Edge, PolicyGraph};
use crate::heading::Heading;
use crate::ids::NodeId;
use crate::path::GraphPosition;
use crate::report::TickReport;
use crate::starts_and_stops::{next_start, next_stop};
use crate::state::CharacterState;
use crate::turning::{GOES_MPS, Turn};
use crate::variants::{Lasting, Variant, crossed, within};

/// Velocity errors between which the variant comes in, relative to the speed of the gait.
const OFF_VELOCITY: [f32; 2] = [0.3, 0.6];

/// Angles between heading and target between which it comes in, radians.
const OFF_HEADING: [f32; 2] = [0.5, 1.0];

/// Velocity errors are relative to at least this, metres per second: standing has no speed.
const LEAST_SPEED: f32 = 0.5;

/// Within this distance of its target a character slows down, metres: in a game as in training.
pub const BRAKING_METRES: f32 = 1.0;

/// Time from a gait to its variant, and back, seconds.
const CROSS_SECS: [f32; 2] = [0.1, 0.3];

/// Time in which a character that stands becomes steady, and in which that is over, seconds.
const AT_REST_SECS: [f32; 2] = [1.6, 0.06];

/// The same for one that goes as it is asked to.
const AS_ASKED_SECS: [f32; 2] = [0.8, 0.06];

/// Time from a gait that moves to its resting variant, and back, seconds.
const REST_SECS: [f32; 2] = [0.1, 0.1];

/// A character goes at its pace after this time, seconds.
const PACE_SECS: f32 = 0.3;

/// From where to where on the way to steadiness the steady variant comes in. First the gait itself brakes or gathers speed.
const COMES_IN: [f32; 2] = [0.35, 1.0];

/// Rises and drops below the feet between which the steady variants leave off, metres: they stand and go straight on level ground alone. Feet
/// that stand apart on a slope of 5 degrees differ by the second.
const OFF_LEVEL: [f32; 2] = [0.002, 0.008];

/// Where a character is on the graph, and where it is going.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnGraph<'a> {
    pub(crate) graph: &'a PolicyGraph,
    pub(crate) position: GraphPosition,
    pub(crate) goal: GraphPosition,
}

impl<'a> OnGraph<'a> {
    /// Where the character of a report is, and where it is going.
    pub(crate) fn of(graph: &'a PolicyGraph, report: &TickReport) -> Self {
        Self { graph, position: report.position, goal: report.goal }
    }

    /// Whether all gaits that act here have a variant.
    pub(crate) fn all_have(&self, variant: Variant) -> bool {
        self.acting().iter().all(|node| variant(self.graph.node(*node)).is_some())
    }

    /// Whether all gaits that act here move, so slowly that their turning variants turn on the spot.
    pub(crate) fn all_turn_on_the_spot(&self) -> bool {
        let speed = |node| self.graph.node(node).speed_mps.unwrap_or(0.0);
        self.all_have(|node| node.turning)
            && self.acting().iter().all(|node| speed(*node) > 0.0 && speed(*node) < GOES_MPS)
    }

    /// Whether the gaits that act here are as high as each other, by their fall heights.
    fn keeps_height(&self) -> bool {
        let [one, other] = self.acting().map(|node| self.graph.node(node).fall_height);
        one == other
    }

    /// The gaits that act: one twice where it acts alone.
    fn acting(&self) -> [NodeId; 2] {
        let GraphPosition { from, to, .. } = self.position;
        self.position.as_node().map_or([from, to], |node| [node; 2])
    }

    /// Speed of a variant of the nearest gait, metres per second, where it has one.
    pub(crate) fn variant_mps(&self, variant: Variant) -> Option<f32> {
        let variant = variant(self.graph.node(self.position.nearest_node()))?;
        self.graph.node(variant).speed_mps
    }

    /// On an edge that is only crossed.
    pub(crate) fn crosses(&self) -> bool {
        self.graph.edge_at(self.position).is_some_and(|edge| edge.transit)
    }

    /// The edge that is only crossed on which this is, or to whose beginning it is nearest, on the way over it.
    pub(crate) fn crossing(&self) -> Option<&Edge> {
        let [here, there] = [self.position, self.goal].map(GraphPosition::nearest_node);
        let edges = [self.graph.edge_at(self.position), self.graph.edge_between(here, there)];
        edges.into_iter().flatten().find(|edge| edge.transit)
    }
}

/// How far a character is from what it is asked to do, and how long it has done it, each in [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Urgency {
    /// From going where it is asked to go: for the variants of gaits that move.
    pub(crate) to_move: f32,
    /// 1 where it has no target and is to stay in a gait that moves: it is to rest there. Moving is all that the gait itself has learned.
    pub(crate) to_rest: f32,
    /// From standing, while it has no target: for the variants of gaits that stand.
    pub(crate) to_stand: f32,
    /// How long it has stood still, 1 from 1.6 s on: see [`steady_share`].
    pub(crate) at_rest: f32,
    /// How long it has gone as it is asked to, 1 from 0.8 s on.
    pub(crate) as_asked: f32,
    /// How long it has gone no faster than its place on the graph asks for, 1 from 0.3 s on; kept while it stays there, and forgotten once it
    /// leaves. From then on a faster one has been pushed.
    pub(crate) at_pace: f32,
    /// While it sets off from a stand: for the starting variants. Its seconds are all that a start may take while it has stood still for a
    /// while, and none once it is fast enough.
    pub(crate) start: Lasting,
    /// While it comes to a stand: for the stopping variants. Its seconds are all that a stop may take while it goes.
    pub(crate) stop: Lasting,
    /// While it turns: for the turning variants.
    pub(crate) turn: Turn,
}

/// Share of the steady variants after so long.
pub(crate) fn steady_share(steadiness: f32) -> f32 {
    within(steadiness, COMES_IN)
}

impl Urgency {
    /// What it is after a tick of `dt` seconds at a position on the graph, on the way to another.
    ///
    /// Nothing is steady where the ground rises or drops below the feet.
    ///
    /// A speed beyond the one asked for is no error at first: the way back to a slower gait brakes. Of a character that has gone at its pace
    /// it is a push from behind. Gaits without a speed ask for nothing, and on an edge that is only crossed the body stands up, or goes
    /// down, before it goes anywhere. Of one that turns on the spot the velocity sways: it counts as steady in its turns
    /// too, and comes out of one by its steady variant.
    pub(crate) fn next(
        self,
        place: OnGraph<'_>,
        state: &CharacterState,
        target: Option<Vec2>,
        dt: f32,
    ) -> Self {
        let OnGraph { graph, position, goal } = place;
        let node = position.as_node();
        let arrived = position.is_same_place(goal);
        let stands = node.is_some_and(|node| graph.node(node).stands());
        let off_level = within(steepest(state), OFF_LEVEL);
        let steady = |can_be: bool, off: f32| if arrived && can_be { 1.0 - off.max(off_level) } else { 0.0 };
        let on_the_spot = place.all_turn_on_the_spot();
        let start = next_start(self.start, self.at_rest, place, state, target, dt);
        let turn = self.turn.next(start.share > 0.0, place, state, target, dt);
        let now = match (target, moving_mps(graph, position)) {
            _ if place.crosses() => Self::default(),
            (None, _) => {
                let moves = off_velocity(state.root().linear_velocity.truncate(), 0.0);
                let stays = moving_mps(graph, goal).is_some();
                Self {
                    to_stand: moves,
                    to_rest: if stays { 1.0 } else { 0.0 },
                    at_rest: steady(stands, moves),
                    ..Self::default()
                }
            }
            (Some(target), Some(speed)) => {
                let [at_first, at_pace] = off_course(state, target, speed);
                let off = if self.at_pace < 1.0 { at_first } else { at_pace };
                Self {
                    to_move: off,
                    as_asked: steady(
                        !mostly_stands(graph, position) && place.keeps_height(),
                        if on_the_spot { 0.0 } else { off },
                    ),
                    at_pace: match arrived {
                        false => 0.0,
                        true if at_pace > 0.0 => self.at_pace,
                        true => (self.at_pace + dt / PACE_SECS).min(1.0),
                    },
                    ..Self::default()
                }
            }
            (Some(_), None) => Self::default(),
        };
        let follow = |before: f32, now: f32, secs: [f32; 2]| {
            crossed(before, if now.is_finite() { now } else { 0.0 }, secs, dt)
        };
        Self {
            to_move: follow(self.to_move, now.to_move, CROSS_SECS),
            to_rest: follow(self.to_rest, now.to_rest, REST_SECS),
            to_stand: follow(self.to_stand, now.to_stand, CROSS_SECS),
            at_rest: follow(self.at_rest, now.at_rest, AT_REST_SECS),
            as_asked: follow(self.as_asked, now.as_asked, AS_ASKED_SECS),
            // A body that turns leans: no push has tipped it over.
            at_pace: if turn.share > 0.0 { 0.0 } else { now.at_pace },
            start,
            stop: next_stop(self.stop, place, state, target, dt),
            turn,
        }
    }
}

/// Whether more than half of a position is a gait that stands. A steady variant has learned to go straight at the speed of its gait, and goes
/// aside there.
fn mostly_stands(graph: &PolicyGraph, position: GraphPosition) -> bool {
    let standing = |node, share: f32| if graph.node(node).stands() { share } else { 0.0 };
    standing(position.from, 1.0 - position.t) + standing(position.to, position.t) > 0.5
}

/// Speed that a position on the graph asks for, metres per second, where its gaits have one and it does not stand: between two gaits that move,
/// that of the slower one, which is all that its variant has learned.
pub(crate) fn moving_mps(graph: &PolicyGraph, position: GraphPosition) -> Option<f32> {
    let speed = |node| graph.node(node).speed_mps;
    let asked = match position.as_node() {
        Some(node) => speed(node)?,
        None => {
            let (from, to) = (speed(position.from)?, speed(position.to)?);
            let slower = from.min(to);
            if slower > 0.0 { slower } else { from + position.t * (to - from) }
        }
    };
    (asked > 0.0).then_some(asked)
}

/// How far the velocity and the heading are from those that lead to a target at `speed`, each in [0, 1]: where a higher speed is no error,
/// and where it is one.
fn off_course(state: &CharacterState, target: Vec2, speed: f32) -> [f32; 2] {
    let root = state.root();
    let to_target = target - root.position.truncate();
    let distance = libm::sqrtf(to_target.length_squared());
    if !(distance.is_finite() && distance > 1e-3) {
        return [0.0; 2];
    }
    let near = (distance / BRAKING_METRES).min(1.0);
    let direction = to_target / distance;
    let velocity = root.linear_velocity.truncate();
    let along = velocity.dot(direction);
    let missing = near * speed - along;
    let off_heading = within(near * Heading::from_rotation(root.rotation).angle_off(direction), OFF_HEADING);
    [missing.max(0.0), missing].map(|missing| {
        let error = velocity - (along + missing) * direction;
        off_velocity(error, speed).max(off_heading)
    })
}

/// How far a velocity error counts at a speed, in [0, 1].
fn off_velocity(error: Vec2, speed: f32) -> f32 {
    within(libm::sqrtf(error.length_squared()) / speed.max(LEAST_SPEED), OFF_VELOCITY)
}
