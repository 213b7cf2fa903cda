//! What a [`ControllerState`] may hold: checked before it is restored, so that damaged bytes can't stop a character for good.

use crate::agility::Urgency;
use crate::blend::Blend;
use crate::capture_step::CaptureStep;
use crate::controller_state::{ControllerState, StateError};
use crate::features::FrameHistory;
use crate::pack::CharacterPack;
use crate::path::GraphPosition;
use crate::turning::Turn;

/// Longest time that is counted down and that a game chooses, seconds.
const LONGEST_SECS: f32 = 3600.0;

/// Longest time that is counted down and that is fixed here, seconds: those of starts, stops and capture steps.
const LONGEST_MOMENT_SECS: f32 = 10.0;

/// Longest time that is counted up, seconds. A number that grows by a tick's 0.25 s at most stops growing at half of it.
const LONGEST_COUNT_SECS: f32 = (1 << 24) as f32;

/// Largest joint target, radians: the largest centre and gain of a pack, and the largest action.
const MOST_TARGET_RADIANS: f32 = 12_000.0;

/// Squares of lengths that count as 1. A direction that was made of a very short vector is coarse.
const UNIT_SQUARES: core::ops::RangeInclusive<f32> = 0.25..=4.0;

/// A time that a game chooses, as a state counts it down: 0 to 3600 s. NaN counts as 0.
pub(crate) fn countdown_secs(secs: f32) -> f32 {
    if secs > 0.0 { secs.min(LONGEST_SECS) } else { 0.0 }
}

fn field(field: &'static str, expected: &'static str, holds: bool) -> Result<(), StateError> {
    if holds { Ok(()) } else { Err(StateError::Field { field, expected }) }
}

impl ControllerState {
    /// Checks every index and number against a pack, so that nothing restored can fail later.
    pub(crate) fn check(&self, pack: &CharacterPack) -> Result<(), StateError> {
        let skeleton = pack.skeleton();
        let sized = self.targets.len() == skeleton.joint_count()
            && self.history.parts().0.len() == FrameHistory::new_len(skeleton.frame_len());
        field("size", "the sizes of the pack's skeleton", sized)?;
        self.check_indices(pack)?;
        self.check_finite()?;
        self.check_ranges()
    }

    fn check_indices(&self, pack: &CharacterPack) -> Result<(), StateError> {
        let place = |position: GraphPosition| pack.graph().contains(position);
        field("position", "a position on the graph", place(self.report.position))?;
        field("goal", "a position on the graph", place(self.report.goal))?;
        let policies = pack.policies().len();
        field("rising variant", "a policy of the pack", self.rising.variant.index() < policies)?;
        let known = |blend: &Blend| {
            let good = |w: &f32| w.is_finite();
            blend.terms().iter().all(|t| t.policy.index() < policies && t.weights.iter().all(good))
        };
        field("blend", "finite weights of the pack's policies", known(&self.report.blend))?;
        field("resting blend", "finite weights of the pack's policies", known(&self.rest.last))?;
        let some = self.rest.rested == 0 || !self.rest.last.terms().is_empty();
        field("resting blend", "a policy", some)?;
        let r = &self.report;
        let skills = [
            r.skill.map(|s| s.skill),
            r.skill.map(|s| s.acts),
            r.pending_skill,
            r.skill_started,
            self.interrupted,
        ];
        let ended = [r.skill_ended.map(|(s, _)| s)];
        let all = skills.iter().chain(&ended).flatten().all(|s| s.index() < pack.skills().len());
        field("skill", "skills of the pack", all)?;
        let acts = r.skill.is_none_or(|s| s.fits(pack.skills()));
        field("skill that acts", "the skill or what acts in its place out of a run", acts)
    }

    fn check_finite(&self) -> Result<(), StateError> {
        let numbers = self.targets.iter().chain(&self.handover_from).chain(self.history.parts().0);
        let steering = [self.steering.velocity.x, self.steering.velocity.y, self.steering.trim];
        let give_way = [self.give_way.speed, self.give_way.pace];
        let mut numbers = numbers.chain(&steering).chain(&give_way).chain(&self.report.target);
        field("numbers", "finite numbers", numbers.all(|n| n.is_finite()))
    }

    fn check_ranges(&self) -> Result<(), StateError> {
        let Self { fall, urgency, capture_step, catch, rising, .. } = self;
        let within = |most: f32| move |number: &f32| (0.0..=most).contains(number);
        let progress = self.report.skill.map_or([0.0; 2], |s| [s.seconds, s.held_seconds]);
        let counts = [fall.low_seconds, fall.rising_seconds, self.pending_secs, progress[0], progress[1]];
        field("counted times", "at least 0 s", counts.iter().all(within(LONGEST_COUNT_SECS)))?;
        let times = [self.handover_secs, self.settle_secs, self.give_way.stop_secs, catch.secs];
        field("times", "0 to 3600 s", times.iter().all(within(LONGEST_SECS)))?;
        let Urgency { to_move, to_rest, to_stand, at_rest, as_asked, at_pace, start, stop, turn } = *urgency;
        let CaptureStep { acts, way, facing } = *capture_step;
        let moments = [start.secs, stop.secs, acts.secs];
        field("times of moments", "0 to 10 s", moments.iter().all(within(LONGEST_MOMENT_SECS)))?;
        let Turn { share, way: turns_to, .. } = turn;
        let shares = [self.unevenness, to_move, to_rest, to_stand, at_rest, as_asked, at_pace];
        let lasting = [start.share, stop.share, share, acts.share, catch.share, rising.share];
        field("shares", "0 to 1", shares.iter().chain(&lasting).all(within(1.0)))?;
        let is_direction = |squared: f32| squared == 0.0 || UNIT_SQUARES.contains(&squared);
        let directions = [turns_to, way, facing].map(|way| is_direction(way.length_squared()));
        field("directions", "vectors of length 1 or 0", directions == [true; 3])?;
        let score = self.report.skill.and_then(|s| s.score).filter(|score| !score.is_nan());
        field("score", "0 to 1", score.is_none_or(|score| within(1.0)(&score)))?;
        let mut targets = self.targets.iter().chain(&self.handover_from);
        field("joint targets", "at most 12000 rad", targets.all(|t| t.abs() <= MOST_TARGET_RADIANS))
    }
}
