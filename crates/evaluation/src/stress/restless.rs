//! A restless player: stick, triggers and buttons at random.

use policy_core::bindings::{Bindings, Control};
use policy_core::{Button, Buttons, CharacterPack, Heading};
use random::Rng;

use super::random_pad::PadKind;
use crate::trial::{TICK_SECS, Trial};

/// A restless player.
pub(super) struct Player {
    kind: PadKind,
    rng: Rng,
    skills: Vec<Button>,
    style: Option<Button>,
    /// Seconds until the stick, the triggers, the style button and the skill buttons change.
    change_in: [f32; 5],
    strafe: StrafeHand,
}

/// The hand that holds the button of the strafing path, and turns the camera meanwhile.
struct StrafeHand {
    button: Option<Button>,
    rng: Rng,
    change_in: f32,
    /// How fast the camera turns, radians a second.
    turn_rate: f32,
}

impl StrafeHand {
    /// Without a strafing path in the pack it does nothing.
    fn new(bindings: &Bindings, pack: &CharacterPack, rng: Rng) -> Self {
        let strafes = pack.graph().path_named("strafe").is_some();
        let button = button_of(bindings, "strafe").filter(|_| strafes);
        Self { button, rng, change_in: 2.0, turn_rate: 0.0 }
    }

    /// Holds the button for a third of the time.
    fn hold(&mut self, trial: &mut Trial, buttons: &mut Buttons) {
        let Some(button) = self.button else { return };
        let mut held = trial.pad.buttons.contains(button);
        self.change_in -= TICK_SECS;
        if self.change_in <= 0.0 {
            self.change_in = self.rng.range(0.5, 4.0);
            held = self.rng.chance(0.35);
            self.turn_rate = if self.rng.chance(0.5) { self.rng.range(-3.0, 3.0) } else { 0.0 };
        }
        buttons.set(button, held);
        if held {
            trial.camera = Heading::from_angle(trial.camera.angle() + self.turn_rate * TICK_SECS);
        }
    }
}

impl Player {
    pub(super) fn new(kind: PadKind, pack: &CharacterPack, seed: u64) -> Self {
        let (bindings, rng) = (Bindings::default(), Rng::new(seed, 41));
        let skills = bindings.skills.iter().map(|(button, _)| *button).collect();
        let style = button_of(&bindings, "style");
        // A hand of its own, so that the other kinds do what they do without it.
        let strafe = StrafeHand::new(&bindings, pack, Rng::new(seed, 47));
        Self { kind, rng, skills, style, change_in: [1.0, 2.0, 2.0, 2.0, 3.0], strafe }
    }

    /// Moves the controls of the pad.
    pub(super) fn hold(&mut self, trial: &mut Trial) {
        let Self { kind, rng, skills, style: button, change_in, strafe: hand } = self;
        change_in.iter_mut().for_each(|secs| *secs -= TICK_SECS);
        let [stick, speed, stance, style, skill] = change_in;
        if *stick <= 0.0 {
            *stick = rng.range(0.4, 3.0);
            let push = mostly_ends(rng, 0.15, 0.6);
            trial.steer(rng.angle(), push);
        }
        if kind.moves(PadKind::Speed) && *speed <= 0.0 {
            *speed = rng.range(0.5, 4.0);
            trial.pad.right_trigger = mostly_ends(rng, 0.4, 0.3);
        }
        if kind.moves(PadKind::Stance) && *stance <= 0.0 {
            *stance = rng.range(0.5, 4.0);
            trial.pad.left_trigger = mostly_ends(rng, 0.4, 0.3);
        }
        let mut buttons = Buttons::NONE;
        if let Some(button) = *button {
            buttons.set(button, trial.pad.buttons.contains(button));
        }
        if kind.moves(PadKind::Style) && *style <= 0.0 {
            *style = rng.range(0.5, 4.0);
            let held = rng.chance(0.3);
            if let Some(button) = *button {
                buttons.set(button, held);
            }
        }
        if *kind == PadKind::Everything && *skill <= 0.0 {
            *skill = rng.range(1.0, 8.0);
            buttons = buttons.with(skills[rng.index(skills.len())]);
        }
        if kind.moves(PadKind::Strafe) {
            hand.hold(trial, &mut buttons);
        }
        trial.pad.buttons = buttons;
    }
}

/// 0 and 1 with the given probabilities, else anything between.
fn mostly_ends(rng: &mut Rng, zero: f32, one: f32) -> f32 {
    let draw = rng.uniform();
    if draw < zero {
        0.0
    } else if draw < zero + one {
        1.0
    } else {
        rng.uniform()
    }
}

/// The button that a path is bound to.
fn button_of(bindings: &Bindings, path: &str) -> Option<Button> {
    bindings.paths.iter().find_map(|binding| match binding.control {
        Control::Button(button) if binding.path == path => Some(button),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_path_has_its_own_button() {
        let button = |path| button_of(&Bindings::default(), path);
        assert_eq!(button("style"), Some(Button::RightShoulder));
        assert_eq!(button("strafe"), Some(Button::RightStick));
        assert_eq!(button("stance"), None, "a trigger's");
    }
}
