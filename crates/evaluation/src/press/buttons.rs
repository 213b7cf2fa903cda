//! Presses of every bound button in every gait: does a skill start, does it succeed, does the character come to lie?

use std::collections::BTreeMap;

use policy_core::bindings::{Bindings, Control};
use policy_core::{Button, CharacterPack, SkillId};
use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::skills::ended_well;
use crate::trial::{Settled, TICK_SECS, median, ticks};

/// A pelvis below this is low, metres.
const LOW_METRES: f32 = 0.4;

/// Seconds that a character is watched after a press.
const WATCHED_SECS: f32 = 6.0;

/// A skill has succeeded when the character still goes on well after this time, seconds.
const AFTER_SECS: f32 = 1.0;

/// Presses of one button in one gait.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PressReport {
    /// The skill that the button starts, if the pack has it.
    pub skill: Option<String>,
    /// Presses.
    pub trials: usize,
    /// Presses that started the skill.
    pub started: usize,
    /// Presses that the controller refused.
    pub refused: usize,
    /// Presses whose skill the discriminator ended, and that left the character without a fall for a second.
    pub succeeded: usize,
    /// Median of the seconds from the press until the skill had ended so; `None` when half of the presses did not get there.
    pub median_s: Option<f32>,
    /// Presses after which the pelvis came below 0.4 m.
    pub low: usize,
    /// Presses after which the character fell.
    pub falls: usize,
}

/// By gait, and in it by button. A button of a path is held for a second.
#[must_use]
pub fn measure_buttons(rig: &Rig<'_>) -> BTreeMap<String, BTreeMap<String, PressReport>> {
    let measure = |gait: &_| {
        let settled = rig.settled(gait);
        let pressed = &settled[..settled.len().min(rig.effort.pressed)];
        let report = |(button, skill): &(Button, Option<SkillId>)| {
            let presses = rig.each(pressed, WATCHED_SECS, |from| press(rig, from, *button, *skill));
            let count = |which: fn(&Press) -> bool| presses.iter().filter(|press| which(press)).count();
            let report = PressReport {
                skill: skill.map(|skill| rig.pack.skills()[skill.index()].name.clone()),
                trials: presses.len(),
                started: count(|press| press.started),
                refused: count(|press| press.refused),
                succeeded: count(|press| press.secs.is_some()),
                median_s: median(presses.iter().map(|press| press.secs)),
                low: count(|press| press.low),
                falls: count(|press| press.fell),
            };
            (button_name(*button), report)
        };
        bound_buttons(rig.pack).iter().map(report).collect()
    };
    rig.gaits().iter().map(|gait| (gait.name.into(), measure(gait))).collect()
}

/// The buttons that are bound, each with the skill that it starts, if the pack has it.
pub(crate) fn bound_buttons(pack: &CharacterPack) -> Vec<(Button, Option<SkillId>)> {
    let bindings = Bindings::default();
    let skills = bindings.skills.iter().map(|(button, name)| (*button, pack.skill_named(name)));
    let paths = bindings.paths.iter().filter_map(|binding| match binding.control {
        Control::Button(button) => Some((button, None)),
        _ => None,
    });
    skills.chain(paths).collect()
}

/// Name of a button for reports, such as `right_shoulder`.
#[must_use]
pub fn button_name(button: Button) -> String {
    let mut name = String::new();
    for letter in format!("{button:?}").chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

/// One press.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Press {
    started: bool,
    refused: bool,
    /// When the skill had ended well.
    secs: Option<f32>,
    low: bool,
    fell: bool,
}

fn press(rig: &Rig<'_>, from: &Settled, button: Button, skill: Option<SkillId>) -> Press {
    let mut trial = from.resume(rig.model);
    let held = trial.pad.buttons;
    trial.pad.buttons = held.with(button);
    let hold_ticks = if skill.is_some() { ticks(0.1) } else { ticks(1.0) };
    let mut press = Press::default();
    for tick in 1..=ticks(WATCHED_SECS) {
        if tick > hold_ticks {
            trial.pad.buttons = held;
        }
        let secs = tick as f32 * TICK_SECS;
        let sound = trial.tick();
        let report = trial.controller.report();
        press.low |= trial.pelvis_height() < LOW_METRES;
        press.started |= skill.is_some() && report.skill_started == skill;
        press.refused |= report.skill_refused.is_some();
        match report.skill_ended {
            Some((ended, end)) if Some(ended) == skill && ended_well(rig.pack, ended, end) => {
                press.secs = Some(secs);
            }
            Some(_) => press.secs = None,
            None => {}
        }
        if !sound || trial.is_down() {
            press.fell = true;
            press.secs = press.secs.filter(|ended| secs - ended > AFTER_SECS);
            break;
        }
    }
    press
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_buttons_are_in_snake_case() {
        assert_eq!(button_name(Button::South), "south");
        assert_eq!(button_name(Button::RightShoulder), "right_shoulder");
        assert_eq!(button_name(Button::DpadUp), "dpad_up");
    }
}
