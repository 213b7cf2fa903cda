//! A pad at random: stick, triggers and buttons as a restless player moves them.

use std::collections::BTreeMap;

use policy_core::training::fall_height;
use policy_core::{CharacterPack, GraphPosition, SkillEnd, SkillId};
use serde::{Deserialize, Serialize};

use super::restless::Player;
use crate::Rig;
use crate::trial::{Gait, TICK_SECS, Trial, ticks};

/// Which controls are moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PadKind {
    /// The stick.
    Stick,
    /// Stick and right trigger.
    Speed,
    /// Stick and left trigger.
    Stance,
    /// Stick and the button of the style path.
    Style,
    /// Stick and the button of the strafing path; while that is held the camera turns.
    Strafe,
    /// Stick, both triggers and the buttons of the paths.
    AllButSkills,
    /// The same, and the buttons of the skills.
    Everything,
}

impl PadKind {
    /// All kinds.
    pub const ALL: [PadKind; 7] = [
        PadKind::Stick,
        PadKind::Speed,
        PadKind::Stance,
        PadKind::Style,
        PadKind::Strafe,
        PadKind::AllButSkills,
        PadKind::Everything,
    ];

    /// Name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            PadKind::Stick => "stick",
            PadKind::Speed => "speed",
            PadKind::Stance => "stance",
            PadKind::Style => "style",
            PadKind::Strafe => "strafe",
            PadKind::AllButSkills => "all_but_skills",
            PadKind::Everything => "everything",
        }
    }

    pub(super) fn moves(self, kind: PadKind) -> bool {
        self == kind || matches!(self, PadKind::AllButSkills | PadKind::Everything)
    }
}

/// Falls under a pad at random.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RandomPadReport {
    /// Falls per minute of one character. It gets up by itself.
    pub falls_per_minute: f32,
    /// Those falls by the skill that had ended less than 3 s before, or that ran; `none` for all others.
    pub falls_after: BTreeMap<String, u32>,
    /// Times per minute that Get-up raised a character out of a crawl that was late to rise.
    pub rises_by_skill_per_minute: f32,
    /// Share of the time in the skill that raises it, 0 to 1, without a press.
    pub down: f32,
}

/// A fall this much later than the end of a skill has nothing to do with it, seconds.
const AFTER_SECS: f32 = 3.0;

/// Counts of one character.
#[derive(Clone, Debug, Default)]
struct Count {
    /// The skill before each fall.
    falls: Vec<Option<SkillId>>,
    rises: u32,
    down_ticks: u32,
}

/// The skill that runs, or that ended less than 3 s ago, and the ticks since then.
#[derive(Clone, Copy, Debug, Default)]
struct LastSkill(Option<(SkillId, u32)>);

impl LastSkill {
    /// Looks at the report of a tick. A skill that starts in it, as after a fall, has not run yet.
    fn look(&mut self, trial: &Trial) {
        self.0 = self.0.map(|(skill, age)| (skill, age + 1)).filter(|(_, age)| *age < ticks(AFTER_SECS));
        let report = trial.controller.report();
        let ran = report.skill_ended.map(|(skill, _)| skill);
        let runs = report.skill.filter(|progress| progress.seconds > 0.0).map(|progress| progress.skill);
        if let Some(skill) = runs.or(ran) {
            self.0 = Some((skill, 0));
        }
    }
}

/// Falls by kind.
#[must_use]
pub fn measure_random_pad(rig: &Rig<'_>) -> BTreeMap<String, RandomPadReport> {
    let Some(walk) = Gait::named(rig.pack, "walk") else { return BTreeMap::new() };
    let seeds: Vec<u64> = (0..rig.effort.pad_players as u64).collect();
    let secs = rig.effort.pad_secs;
    let measure = |kind: PadKind| {
        let counts = rig.each(&seeds, secs, |seed| play(rig, &walk, kind, *seed));
        let minutes = (secs * counts.len() as f32 / 60.0).max(1e-6);
        let per_minute = |count: fn(&Count) -> u32| counts.iter().map(count).sum::<u32>() as f32 / minutes;
        let mut falls_after = BTreeMap::new();
        for skill in counts.iter().flat_map(|count| &count.falls) {
            let name = skill.map_or("none", |skill| &rig.pack.skills()[skill.index()].name);
            *falls_after.entry(name.into()).or_default() += 1;
        }
        RandomPadReport {
            falls_per_minute: per_minute(|count| count.falls.len() as u32),
            falls_after,
            rises_by_skill_per_minute: per_minute(|count| count.rises),
            down: per_minute(|count| count.down_ticks) * TICK_SECS / 60.0,
        }
    };
    PadKind::ALL.into_iter().map(|kind| (kind.name().into(), measure(kind))).collect()
}

fn play(rig: &Rig<'_>, walk: &Gait, kind: PadKind, seed: u64) -> Count {
    let mut trial = Trial::new(rig.model, rig.pack, rig.config, walk);
    let mut player = Player::new(kind, rig.pack, seed);
    let (mut count, mut raised, mut last) = (Count::default(), false, LastSkill::default());
    for _ in 0..ticks(rig.effort.pad_secs) {
        player.hold(&mut trial);
        let position = trial.controller.report().position;
        // A pack without a skill to get up leaves the character lying.
        let sound = trial.tick();
        last.look(&trial);
        let before = last.0.map(|(skill, _)| skill);
        if !sound || trial.is_down() {
            count.falls.push(before);
            trial.place(trial.position(), 0.0);
            (raised, last) = (false, LastSkill::default());
            continue;
        }
        let start = Start::of(&trial, position);
        if start == Start::Fall && !raised {
            count.falls.push(before);
        }
        count.rises += u32::from(start == Start::LateRise && !raised);
        raised = match start {
            Start::Fall | Start::LateRise => true,
            Start::None => raised && trial.controller.report().skill.is_some(),
            Start::Press => false,
        };
        count.down_ticks += u32::from(raised);
    }
    count
}

/// Why a skill started in the last tick, if one did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    None,
    Press,
    Fall,
    LateRise,
}

impl Start {
    /// `before` is the place on the graph before the tick.
    fn of(trial: &Trial, before: GraphPosition) -> Start {
        let (report, pack) = (trial.controller.report(), trial.controller.pack());
        // It starts again at once where its time was over and the character still lies.
        let again = report.skill_ended.is_some_and(|(_, end)| end == SkillEnd::TimeLimit);
        match report.skill_started {
            None => Start::None,
            started if started != pack.recovery() || started == trial.asked_skill() => Start::Press,
            _ if again || !is_rising(pack, before, report.goal) => Start::Fall,
            _ if is_low(pack, before, trial.pelvis_height()) => Start::Fall,
            _ => Start::LateRise,
        }
    }
}

fn is_low(pack: &CharacterPack, position: GraphPosition, pelvis_height: f32) -> bool {
    // The pelvis may have come up by a hair in the tick that the skill has had.
    fall_height(pack.graph(), position).is_some_and(|limit| pelvis_height < limit + 0.05)
}

/// True on the way out of a low gait.
fn is_rising(pack: &CharacterPack, from: GraphPosition, to: GraphPosition) -> bool {
    match (fall_height(pack.graph(), from), fall_height(pack.graph(), to)) {
        (Some(from), Some(to)) => from < to,
        (from, to) => from.is_none() && to.is_some(),
    }
}
