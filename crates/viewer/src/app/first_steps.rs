//! The five things that a newcomer tries first. Each is ticked off once it is done. Knows nothing of drawing.

use policy_core::CharacterPack;
use policy_core::training::Path;

use super::{KeyAction, KeyMap};

/// Way to walk with the stick pushed, metres.
const WALK_M: f32 = 1.5;
/// Share of the speed path from which it is a run.
const RUN_SHARE: f32 = 0.65;
/// Share of the stance path from which it is a crouch.
const CROUCH_SHARE: f32 = 0.6;
/// Seconds of pulling, and the least force, newtons.
const PULL_SECS: f32 = 0.3;
const PULL_NEWTONS: f32 = 20.0;
/// Seconds for which the list is still shown once all is done.
const FAREWELL_SECS: f32 = 4.0;

/// Something to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum FirstStep {
    Move,
    Run,
    Crouch,
    Roll,
    Pull,
}

impl FirstStep {
    /// All of them, in the order of the list.
    pub const ALL: [FirstStep; 5] =
        [FirstStep::Move, FirstStep::Run, FirstStep::Crouch, FirstStep::Roll, FirstStep::Pull];

    /// What to do, in two words.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            FirstStep::Move => "Move",
            FirstStep::Run => "Run",
            FirstStep::Crouch => "Crouch",
            FirstStep::Roll => "Roll",
            FirstStep::Pull => "Pull me",
        }
    }

    /// How, on a pad or on the keyboard.
    #[must_use]
    pub fn how(self, on_pad: bool, keys: &KeyMap) -> String {
        let key = |action: KeyAction| keys.key(action).name();
        match (self, on_pad) {
            (FirstStep::Move, false) => keys.walk(),
            (FirstStep::Move, true) => "left stick".into(),
            (FirstStep::Run, false) => {
                format!("{} and hold {}", key(KeyAction::Ahead), key(KeyAction::Faster))
            }
            (FirstStep::Run, true) => "left stick and right trigger".into(),
            (FirstStep::Crouch, false) => format!("hold {}", key(KeyAction::Lower)),
            (FirstStep::Crouch, true) => "left trigger".into(),
            (FirstStep::Roll, false) => key(KeyAction::Roll).into(),
            (FirstStep::Roll, true) => "B or circle".into(),
            (FirstStep::Pull, _) => "drag me with the mouse".into(),
        }
    }

    /// False when the character of `pack` has no way to do it.
    #[must_use]
    pub fn is_offered(self, pack: &CharacterPack) -> bool {
        let reaches = |name: &str| path(pack, name).is_some_and(|path| path.end() > 1.0);
        match self {
            FirstStep::Run => reaches("speed"),
            FirstStep::Crouch => reaches("stance"),
            FirstStep::Roll => pack.skill_named("roll").is_some(),
            FirstStep::Move | FirstStep::Pull => true,
        }
    }
}

/// A path of the pack by its name.
pub(crate) fn path<'a>(pack: &'a CharacterPack, name: &str) -> Option<&'a Path> {
    pack.graph().path_named(name).map(|id| pack.graph().path(id))
}

/// What the player did in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Doing {
    /// Length of the tick, seconds.
    pub dt_secs: f32,
    /// The stick is pushed.
    pub steers: bool,
    /// Speed of the character, metres per second.
    pub speed_mps: f32,
    /// How far along the speed path it is, 0 to 1; 0 off the path.
    pub speed_share: f32,
    /// How far along the stance path it is, 0 to 1; 0 off the path.
    pub stance_share: f32,
    /// It rolls.
    pub rolls: bool,
    /// Force with which the mouse pulls, newtons.
    pub pull_newtons: f32,
}

/// Which steps are done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FirstSteps {
    done: [bool; FirstStep::ALL.len()],
    walked_m: f32,
    pulled_secs: f32,
    /// Seconds since all were done.
    over_secs: f32,
}

impl FirstSteps {
    /// True once the player has done it.
    #[must_use]
    pub fn is_done(&self, step: FirstStep) -> bool {
        self.done[step as usize]
    }

    /// True when every step that the character offers was done a while ago.
    #[must_use]
    pub fn are_over(&self) -> bool {
        self.over_secs > FAREWELL_SECS
    }

    /// True when every step that the character of `pack` offers is done.
    #[must_use]
    pub fn are_done(&self, pack: &CharacterPack) -> bool {
        FirstStep::ALL.into_iter().all(|step| self.is_done(step) || !step.is_offered(pack))
    }

    /// Takes a tick.
    pub fn observe(&mut self, doing: &Doing, pack: &CharacterPack) {
        if doing.steers {
            self.walked_m += doing.speed_mps.max(0.0) * doing.dt_secs;
        }
        self.pulled_secs =
            if doing.pull_newtons > PULL_NEWTONS { self.pulled_secs + doing.dt_secs } else { 0.0 };
        let mut tick_off = |step: FirstStep, done: bool| self.done[step as usize] |= done;
        tick_off(FirstStep::Move, self.walked_m > WALK_M);
        tick_off(FirstStep::Run, doing.steers && doing.speed_share > RUN_SHARE);
        tick_off(FirstStep::Crouch, doing.stance_share > CROUCH_SHARE);
        tick_off(FirstStep::Roll, doing.rolls);
        tick_off(FirstStep::Pull, self.pulled_secs > PULL_SECS);
        if self.are_done(pack) {
            self.over_secs += doing.dt_secs;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::HUMANOID_PACK;

    const REST: Doing = Doing {
        dt_secs: 1.0 / 30.0,
        steers: false,
        speed_mps: 0.0,
        speed_share: 0.0,
        stance_share: 0.0,
        rolls: false,
        pull_newtons: 0.0,
    };

    fn done_after(doing: Doing, ticks: usize) -> Vec<FirstStep> {
        let pack = CharacterPack::from_bytes(HUMANOID_PACK).unwrap();
        let mut steps = FirstSteps::default();
        (0..ticks).for_each(|_| steps.observe(&doing, &pack));
        FirstStep::ALL.into_iter().filter(|step| steps.is_done(*step)).collect()
    }

    #[test]
    fn each_step_is_ticked_off_by_what_it_names_alone() {
        assert_eq!(done_after(REST, 300), []);
        let walks = Doing { steers: true, speed_mps: 1.2, speed_share: 0.33, ..REST };
        assert_eq!(done_after(walks, 60), [FirstStep::Move]);
        assert_eq!(done_after(Doing { speed_share: 0.9, ..walks }, 1), [FirstStep::Run]);
        // Who is pushed around has not walked.
        assert_eq!(done_after(Doing { steers: false, ..walks }, 300), []);
        assert_eq!(done_after(Doing { stance_share: 0.7, ..REST }, 1), [FirstStep::Crouch]);
        assert_eq!(done_after(Doing { rolls: true, ..REST }, 1), [FirstStep::Roll]);
        let pulls = Doing { pull_newtons: 100.0, ..REST };
        assert_eq!((done_after(pulls, 3), done_after(pulls, 12)), (vec![], vec![FirstStep::Pull]));
    }

    #[test]
    fn a_while_after_the_last_one_they_are_over() {
        let pack = CharacterPack::from_bytes(HUMANOID_PACK).unwrap();
        let all = Doing {
            steers: true,
            speed_mps: 3.0,
            speed_share: 1.0,
            stance_share: 1.0,
            rolls: true,
            pull_newtons: 99.0,
            ..REST
        };
        let mut steps = FirstSteps::default();
        (0..30).for_each(|_| steps.observe(&all, &pack));
        assert!(steps.are_done(&pack) && !steps.are_over());
        (0..150).for_each(|_| steps.observe(&REST, &pack));
        assert!(steps.are_over());
    }
}
