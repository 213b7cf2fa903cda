//! What the pad throws and puts down in a shared world.

use policy_core::{Button, GamepadState, Heading};

use super::bodies::Bodies;
use super::{LooseKind, Simulation};

/// Throws a ball from the player to where the camera looks.
pub const THROW_BUTTON: Button = Button::DpadUp;
/// Puts a prop in front of the player.
pub const SPAWN_BUTTON: Button = Button::DpadDown;

impl Simulation {
    /// Throws and puts down when the buttons of a player go down, between the last tick's pad and this one's; nothing on the empty
    /// floor.
    pub(super) fn throw(&mut self, player: usize, [last, pad]: [&GamepadState; 2], camera: Heading) {
        let pressed = pad.buttons.pressed_since(last.buttons);
        let (throws, spawns) = (pressed.contains(THROW_BUTTON), pressed.contains(SPAWN_BUTTON));
        let Bodies::Together(shared) = &mut self.bodies else { return };
        let root = self.steered[player].state.root().position;
        // A player at the end of the world throws nothing.
        if throws {
            let _ = shared.add_loose(LooseKind::Ball, playground::thrown(root, camera));
        }
        if spawns {
            let _ = shared.spawn(playground::put_down(root, camera).position);
        }
    }
}
