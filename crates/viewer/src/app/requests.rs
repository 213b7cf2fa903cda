//! What the player asks for: triggers take over from panels, and a refused request is said.

use policy_core::{Button, GamepadState, Refusal};

use super::App;

/// How far a trigger has to be pulled to take over from a panel.
const TRIGGER_MOVES: f32 = 0.1;
/// How long a refusal is shown, seconds.
const REFUSAL_SECS: f32 = 2.0;
/// The button that acts as the third trigger.
const STYLE_BUTTON: Button = Button::RightShoulder;

impl App {
    /// Why the last request did nothing, for a moment after it.
    #[must_use]
    pub fn refused(&self) -> Option<&str> {
        self.refused.as_ref().map(|(what, _)| what.as_str())
    }

    pub(super) fn note_refusal(&mut self) {
        let Some((skill, refusal)) = self.sim.player().report().skill_refused else { return };
        let name = self.sim.pack().skills().get(skill.index()).map_or("skill", |s| s.name.as_str());
        let why = match refusal {
            Refusal::Upright => "it is up already",
            Refusal::Unknown => "the pack has no such skill",
            Refusal::TookTooLong => "it could not start in time",
            Refusal::Fell => "the character fell",
        };
        self.refused = Some((format!("{name}: {why}"), REFUSAL_SECS));
    }

    /// A trigger that is pulled takes over again from what a panel asked for.
    pub(super) fn give_back_to_triggers(&mut self, input: &GamepadState) {
        let then = &mut self.overridden_at;
        then.left_trigger = then.left_trigger.min(input.left_trigger);
        then.right_trigger = then.right_trigger.min(input.right_trigger);
        let pulled = input.left_trigger > then.left_trigger + TRIGGER_MOVES
            || input.right_trigger > then.right_trigger + TRIGGER_MOVES;
        if pulled || input.buttons.pressed_since(then.buttons).contains(STYLE_BUTTON) {
            self.sim.overrides.goal = None;
            self.layers.active = false;
        }
        then.buttons = input.buttons;
    }
}
