//! A [`ControllerState`] as bytes, little-endian, of one length for each pack.
//!
//! Order: version, report, fall timers, frame history, resting blend, interrupted skill, joint targets, targets before the hand-over, times of
//! hand-over, settling and pending skill, steering with the side of a turn, giving way, unevenness, urgency, capture step, catch, rise. An absent value
//! is a zero flag and zeros, so that equal states give equal bytes.

use crate::agility::Urgency;
use crate::blend::{Blend, BlendTerm, MAX_BLEND_TERMS};
use crate::capture_step::CaptureStep;
use crate::controller_state::{ControllerState, StateError};
use crate::evaluator::Evaluation;
use crate::ids::{NodeId, PolicyId, SkillId};
use crate::mlp::MAX_LAYERS;
use crate::pack::CharacterPack;
use crate::path::GraphPosition;
use crate::report::{StateFault, TickReport};
use crate::skill::{Refusal, SkillEnd, SkillProgress};

/// First four bytes: `PSS` and the version.
const VERSION: u32 = u32::from_le_bytes(*b"PSS\x0f");

const POSITION_LEN: usize = 2 + 2 + 4;
const BLEND_LEN: usize = 1 + MAX_BLEND_TERMS * (2 + 4 * MAX_LAYERS);
const SKILL_LEN: usize = 3;
const PROGRESS_LEN: usize = 2 * SKILL_LEN + 4 + 4 + 1 + 4;
const REPORT_LEN: usize =
    2 * POSITION_LEN + BLEND_LEN + 1 + 8 + PROGRESS_LEN + 2 * SKILL_LEN + 2 * (SKILL_LEN + 1) + 3;
const FIXED_LEN: usize = 4 + REPORT_LEN + 8 + 2 + BLEND_LEN + 4 + SKILL_LEN + 12 + 13 + 12 + 57 + 24 + 8 + 6;

impl ControllerState {
    /// Number of bytes; one for all states of a pack.
    #[must_use]
    pub fn byte_len(&self) -> usize {
        FIXED_LEN + 4 * (self.history.parts().0.len() + 2 * self.targets.len())
    }

    /// Writes the state to `out`. Does not allocate.
    ///
    /// # Panics
    /// When `out` is not [`ControllerState::byte_len`] long.
    pub fn write_bytes(&self, out: &mut [u8]) {
        assert_eq!(out.len(), self.byte_len(), "bytes of a controller's state");
        let mut w = Writer { out, at: 0 };
        w.put(VERSION.to_le_bytes());
        w.report(&self.report);
        w.floats(&[self.fall.low_seconds, self.fall.rising_seconds]);
        let (frames, newest, seen) = self.history.parts();
        w.put([newest as u8, seen as u8]);
        w.floats(frames);
        w.blend(&self.rest.last);
        w.put(self.rest.rested.to_le_bytes());
        w.skill(self.interrupted);
        w.floats(&self.targets);
        w.floats(&self.handover_from);
        w.floats(&[self.handover_secs, self.settle_secs, self.pending_secs]);
        let steering = self.steering;
        w.floats(&[steering.velocity.x, steering.velocity.y, steering.trim]);
        w.put([code(&SIDES, steering.side)]);
        w.floats(&[self.give_way.speed, self.give_way.pace, self.give_way.stop_secs]);
        let Urgency { to_move, to_rest, to_stand, at_rest, as_asked, at_pace, start, stop, turn } =
            self.urgency;
        w.floats(&[self.unevenness, to_move, to_rest, to_stand, at_rest, as_asked, at_pace]);
        w.floats(&[start.share, start.secs, stop.share, stop.secs]);
        w.floats(&[turn.share, turn.way.x, turn.way.y]);
        w.put([u8::from(turn.turns)]);
        let CaptureStep { acts, way, facing } = self.capture_step;
        w.floats(&[acts.share, acts.secs, way.x, way.y, facing.x, facing.y]);
        w.floats(&[self.catch.share, self.catch.secs]);
        w.id(self.rising.variant.index());
        w.floats(&[self.rising.share]);
        debug_assert_eq!(w.at, w.out.len());
    }

    /// Overwrites the state with bytes that were written for the same pack. Does not allocate. After an error the state is
    /// that of a new controller.
    ///
    /// # Errors
    /// When length, version or any field is not one of a controller of `pack`.
    pub fn read_bytes(&mut self, pack: &CharacterPack, bytes: &[u8]) -> Result<(), StateError> {
        let read = self.read(bytes).and_then(|()| self.check(pack));
        if read.is_err() {
            self.clear();
        }
        read
    }

    fn read(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        if bytes.len() != self.byte_len() {
            return Err(StateError::Length { expected: self.byte_len(), found: bytes.len() });
        }
        let mut r = Reader { bytes };
        let found = u32::from_le_bytes(r.take());
        if found != VERSION {
            return Err(StateError::Version { expected: VERSION, found });
        }
        self.report = r.report()?;
        (self.fall.low_seconds, self.fall.rising_seconds) = (r.float(), r.float());
        let [newest, seen] = r.take();
        if !self.history.set_cursor(newest.into(), seen.into()) {
            return Err(wrong("history", "a slot of the history"));
        }
        r.floats(self.history.frames_mut());
        self.rest.last = r.blend()?;
        self.rest.rested = u32::from_le_bytes(r.take());
        self.interrupted = r.skill()?;
        r.floats(&mut self.targets);
        r.floats(&mut self.handover_from);
        (self.handover_secs, self.settle_secs) = (r.float(), r.float());
        self.pending_secs = r.float();
        let steering = &mut self.steering;
        (steering.velocity.x, steering.velocity.y) = (r.float(), r.float());
        steering.trim = r.float();
        steering.side = r.one_of(&SIDES, "side of a turn")?;
        let give_way = &mut self.give_way;
        (give_way.speed, give_way.pace, give_way.stop_secs) = (r.float(), r.float(), r.float());
        self.unevenness = r.float();
        let urgency = &mut self.urgency;
        (urgency.to_move, urgency.to_rest, urgency.to_stand) = (r.float(), r.float(), r.float());
        (urgency.at_rest, urgency.as_asked, urgency.at_pace) = (r.float(), r.float(), r.float());
        (urgency.start.share, urgency.start.secs) = (r.float(), r.float());
        (urgency.stop.share, urgency.stop.secs) = (r.float(), r.float());
        let turn = &mut urgency.turn;
        (turn.share, turn.way.x, turn.way.y, turn.turns) = (r.float(), r.float(), r.float(), r.flag()?);
        let steps = &mut self.capture_step;
        (steps.acts.share, steps.acts.secs) = (r.float(), r.float());
        (steps.way.x, steps.way.y) = (r.float(), r.float());
        (steps.facing.x, steps.facing.y) = (r.float(), r.float());
        (self.catch.share, self.catch.secs) = (r.float(), r.float());
        self.rising.variant = NodeId::new(r.id());
        self.rising.share = r.float();
        Ok(())
    }
}

fn wrong(field: &'static str, expected: &'static str) -> StateError {
    StateError::Field { field, expected }
}

/// Writes one value behind the other.
struct Writer<'a> {
    out: &'a mut [u8],
    at: usize,
}

impl Writer<'_> {
    fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        self.out[self.at..self.at + N].copy_from_slice(&bytes);
        self.at += N;
    }

    fn floats(&mut self, values: &[f32]) {
        for value in values {
            self.put(value.to_le_bytes());
        }
    }

    fn id(&mut self, index: usize) {
        self.put((index as u16).to_le_bytes());
    }

    fn skill(&mut self, skill: Option<SkillId>) {
        self.put([u8::from(skill.is_some())]);
        self.id(skill.map_or(0, SkillId::index));
    }

    fn position(&mut self, position: GraphPosition) {
        self.id(position.from.index());
        self.id(position.to.index());
        self.floats(&[position.t]);
    }

    fn blend(&mut self, blend: &Blend) {
        let terms = blend.terms();
        self.put([terms.len() as u8]);
        for i in 0..MAX_BLEND_TERMS {
            let term = terms.get(i).copied().unwrap_or_default();
            self.id(term.policy.index());
            self.floats(&term.weights);
        }
    }

    fn report(&mut self, r: &TickReport) {
        self.position(r.position);
        self.position(r.goal);
        self.blend(&r.blend);
        self.put([code(&EVALUATIONS, r.evaluation)]);
        self.floats(&r.target);
        let progress =
            r.skill.unwrap_or(SkillProgress { seconds: 0.0, ..SkillProgress::start(SkillId::new(0)) });
        self.skill(r.skill.map(|s| s.skill));
        self.skill(r.skill.map(|s| s.acts));
        self.floats(&[progress.seconds, progress.held_seconds]);
        self.put([u8::from(progress.score.is_some())]);
        self.floats(&[progress.score.unwrap_or(0.0)]);
        self.skill(r.pending_skill);
        self.skill(r.skill_started);
        self.skill(r.skill_ended.map(|(skill, _)| skill));
        self.put([r.skill_ended.map_or(0, |(_, end)| code(&ENDS, end))]);
        self.skill(r.skill_refused.map(|(skill, _)| skill));
        self.put([r.skill_refused.map_or(0, |(_, why)| code(&REFUSALS, why))]);
        let fault = r.fault.map_or(0, |fault| 1 + code(&FAULTS, fault));
        self.put([u8::from(r.fallen), fault, u8::from(r.off_rate)]);
    }
}

/// Values by their codes, in both directions.
const EVALUATIONS: [Evaluation; 4] =
    [Evaluation::Single, Evaluation::Cached, Evaluation::Fused, Evaluation::Actions];
const ENDS: [SkillEnd; 3] = [SkillEnd::Recognised, SkillEnd::TimeLimit, SkillEnd::Interrupted];
const REFUSALS: [Refusal; 4] = [Refusal::Upright, Refusal::Unknown, Refusal::TookTooLong, Refusal::Fell];
/// To no side, to the left, to the right.
const SIDES: [f32; 3] = [0.0, 1.0, -1.0];
const FAULTS: [StateFault; 2] = [StateFault::NonFinite, StateFault::WrongSize];

fn code<T: PartialEq>(values: &[T], value: T) -> u8 {
    values.iter().position(|v| *v == value).expect("the table lists every value") as u8
}

/// Reads one value behind the other. The length was checked before.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.bytes.split_first_chunk().expect("the length was checked against the layout");
        self.bytes = rest;
        *head
    }

    fn float(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    fn floats(&mut self, out: &mut [f32]) {
        out.iter_mut().for_each(|value| *value = self.float());
    }

    fn id(&mut self) -> usize {
        u16::from_le_bytes(self.take()).into()
    }

    fn flag(&mut self) -> Result<bool, StateError> {
        match self.take() {
            [0] => Ok(false),
            [1] => Ok(true),
            [_] => Err(wrong("a flag", "0 or 1")),
        }
    }

    fn skill(&mut self) -> Result<Option<SkillId>, StateError> {
        let some = self.flag()?;
        let id = SkillId::new(self.id());
        Ok(some.then_some(id))
    }

    fn position(&mut self) -> GraphPosition {
        GraphPosition { from: NodeId::new(self.id()), to: NodeId::new(self.id()), t: self.float() }
    }

    fn blend(&mut self) -> Result<Blend, StateError> {
        let [len] = self.take();
        if usize::from(len) > MAX_BLEND_TERMS {
            return Err(wrong("blend", "at most as many policies as a blend may have"));
        }
        let mut blend = Blend::default();
        for i in 0..MAX_BLEND_TERMS {
            let mut term = BlendTerm { policy: PolicyId::new(self.id()), weights: [0.0; MAX_LAYERS] };
            self.floats(&mut term.weights);
            if i < usize::from(len) {
                blend.push(term).map_err(|_| wrong("blend", "room for its policies"))?;
            }
        }
        Ok(blend)
    }

    fn one_of<T: Copy>(&mut self, values: &[T], field: &'static str) -> Result<T, StateError> {
        let [code] = self.take();
        values.get(usize::from(code)).copied().ok_or(wrong(field, "a known code"))
    }

    fn report(&mut self) -> Result<TickReport, StateError> {
        let (position, goal, blend) = (self.position(), self.position(), self.blend()?);
        let evaluation = self.one_of(&EVALUATIONS, "evaluation")?;
        let target = [self.float(), self.float()];
        let running = self.skill()?;
        let acts = self.skill()?.unwrap_or_default();
        let [seconds, held_seconds] = [self.float(), self.float()];
        let scored = self.flag()?;
        let score = Some(self.float()).filter(|_| scored);
        let skill = running.map(|skill| SkillProgress { skill, acts, seconds, held_seconds, score });
        let (pending_skill, skill_started) = (self.skill()?, self.skill()?);
        let (ended, end) = (self.skill()?, self.one_of(&ENDS, "end of a skill")?);
        let (refused, why) = (self.skill()?, self.one_of(&REFUSALS, "refusal")?);
        let fallen = self.flag()?;
        let [fault] = self.take();
        let fault = match fault {
            0 => None,
            n => Some(*FAULTS.get(usize::from(n) - 1).ok_or(wrong("fault", "a known code"))?),
        };
        Ok(TickReport {
            position,
            goal,
            blend,
            evaluation,
            target,
            skill,
            pending_skill,
            skill_started,
            skill_ended: ended.map(|skill| (skill, end)),
            skill_refused: refused.map(|skill| (skill, why)),
            fallen,
            fault,
            off_rate: self.flag()?,
        })
    }
}
