//! Capture steps: a character that tips over backwards steps back under its body, with the policy that strafes.
//!
//! A gait has learned to go ahead alone, and a push from the front tips it over. A policy that strafes steps backwards too, so it acts
//! until the body would come to rest above its feet again. Its target is where that place lies. The name is that of J. Pratt and
//! others, *Capture Point: A Step toward Humanoid Push Recovery* (Humanoids, 2006).

use glam::Vec2;

use crate::blend::Blend;
use crate::fall::fall_height;
use crate::graph::PolicyGraph;
use crate::heading::Heading;
use crate::path::GraphPosition;
use crate::state::CharacterState;
use crate::strafe::strafing_share;
use crate::variants::Lasting;

/// A body that would come to rest so far behind its ankles tips over, as a share of its height above them: a little sooner than it loses its balance,
/// for the first step takes a while.
const BEHIND: f32 = 0.03;

/// One without a target tips over backwards where that place is at most so many times as far aside as it is behind. What tips it aside is for the
/// agile variant of its stand.
const MOST_ASIDE: f32 = 1.3;

/// Largest angle between heading and target, radians. In a turn a body leans into it.
const MOST_RADIANS: f32 = 0.6;

/// The steps go on for so long after the body last tipped over, seconds.
const SETTLES_SECS: f32 = 0.3;

/// Time from a gait to the policy that strafes, and back, seconds.
const CROSS_SECS: [f32; 2] = [0.07, 0.3];

/// The target lies so far from the root, metres. There the policy goes at its full speed.
const TARGET_METRES: f32 = 1.0;

/// A gait whose fall height is a smaller share of that of the policy that strafes is too low to step out of, such as a crawl.
const LEAST_HEIGHT_SHARE: f32 = 0.7;

/// What a capture step remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CaptureStep {
    /// How far the policy that strafes acts.
    pub(crate) acts: Lasting,
    /// Which way they go, world, of unit length while the share is above 0.
    pub(crate) way: Vec2,
    /// Where the character faced when it tipped over, world, of unit length while the share is above 0.
    pub(crate) facing: Vec2,
}

impl CaptureStep {
    /// What it is after a tick of `dt` seconds at a position on the graph, on the way to `target`; the body comes to rest as
    /// [`comes_to_rest`](crate::balance::comes_to_rest) says.
    pub(crate) fn next(
        self,
        (graph, position): (&PolicyGraph, GraphPosition),
        (state, comes_to_rest): (&CharacterState, Option<Vec2>),
        target: Option<Vec2>,
        dt: f32,
    ) -> Self {
        if !is_within_reach(graph, position) {
            return Self::default();
        }
        let root = state.root();
        let heading = Heading::from_rotation(root.rotation);
        let is_ahead = target
            .and_then(|target| (target - root.position.truncate()).try_normalize())
            .is_none_or(|direction| heading.angle_off(direction) < MOST_RADIANS);
        let is_behind =
            |at: &Vec2| at.x < -BEHIND && (target.is_some() || libm::fabsf(at.y) < -MOST_ASIDE * at.x);
        let tips = comes_to_rest.filter(|at| is_ahead && is_behind(at));
        let way = tips.and_then(|at| heading.world_from_heading_2d(at).try_normalize());
        let acts = self.acts.next(way.is_some(), SETTLES_SECS, CROSS_SECS, dt);
        match acts.share > 0.0 {
            true => Self {
                acts,
                way: way.unwrap_or(self.way),
                facing: if self.acts.share > 0.0 { self.facing } else { heading.direction() },
            },
            false => Self::default(),
        }
    }

    /// Where to step, world, and which way to face meanwhile; `None` while there is no need.
    pub(crate) fn target(&self, state: &CharacterState) -> Option<(Vec2, Vec2)> {
        let target = state.root().position.truncate() + TARGET_METRES * self.way;
        (self.acts.share > 0.0).then_some((target, self.facing))
    }

    /// A blend of gaits with a share given to the policy that strafes.
    pub(crate) fn with_steps(&self, graph: &PolicyGraph, gaits: Blend) -> Blend {
        match graph.strafing() {
            Some(steps) => gaits.with_share(steps.into(), self.acts.share),
            None => gaits,
        }
    }
}

/// Whether all gaits that act at a position are on their feet, and none strafes already.
fn is_within_reach(graph: &PolicyGraph, position: GraphPosition) -> bool {
    let height = graph.strafing().and_then(|node| graph.node(node).fall_height);
    let is_high = |(least, height)| height >= LEAST_HEIGHT_SHARE * least;
    height.zip(fall_height(graph, position)).is_some_and(is_high)
        && strafing_share(graph, &position.blend()) == 0.0
}
