//! What the pad throws and puts down in a shared world.

use glam::Vec3;
use physics_bridge::Motion;
use policy_core::{Button, GamepadState, Heading};

use super::bodies::Bodies;
use super::{LooseKind, Simulation};

/// Throws a ball from the player to where the camera looks.
pub const THROW_BUTTON: Button = Button::DpadUp;
/// Puts a prop in front of the player.
pub const SPAWN_BUTTON: Button = Button::DpadDown;

/// Speed of a ball that the player throws, metres per second, along the ground and up.
const THROWN_MPS: [f32; 2] = [9.0, 1.2];
/// It leaves the player so far ahead of the root body and above it, metres.
const THROWN_FROM_M: [f32; 2] = [0.55, 0.45];
/// What is put down falls from so far ahead and above, metres.
const SPAWNED_AT_M: [f32; 2] = [1.4, 0.3];

impl Simulation {
    /// Throws and puts down when the buttons of a player go down, between the last tick's pad and this one's; nothing on the empty
    /// floor.
    pub(super) fn throw(&mut self, player: usize, [last, pad]: [&GamepadState; 2], camera: Heading) {
        let pressed = pad.buttons.pressed_since(last.buttons);
        let (throws, spawns) = (pressed.contains(THROW_BUTTON), pressed.contains(SPAWN_BUTTON));
        let Bodies::Together(shared) = &mut self.bodies else { return };
        let ahead = camera.direction().extend(0.0);
        let from = self.steered[player].state.root().position;
        let place = |[far, high]: [f32; 2]| from + ahead * far + Vec3::Z * high;
        // A player at the end of the world throws nothing.
        if throws {
            let velocity = ahead * THROWN_MPS[0] + Vec3::Z * THROWN_MPS[1];
            let _ = shared.add_loose(LooseKind::Ball, Motion::at(place(THROWN_FROM_M)).moving(velocity));
        }
        if spawns {
            let _ = shared.spawn(place(SPAWNED_AT_M));
        }
    }
}
