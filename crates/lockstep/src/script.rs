//! A fixed input of 20 seconds that has everything in it, to compare machines by.

use policy_core::{Button, Buttons};
use replay::Pad;

use crate::arena::{Arena, SHOVE_BUTTON};
use crate::loose::{PUT_BUTTON, THROW_BUTTON};

/// Ticks of the script: 20 s at 30 Hz.
pub const SCRIPT_TICKS: u32 = 600;

/// The pad of a player in a tick of the script: walk, run in a bend, roll, walk, a shove and getting up, a crate put
/// down and a ball thrown at it, crouch. Players after the first do the same a little later and steered to other sides.
#[must_use]
pub fn script_pad(tick: u32, player: usize) -> Pad {
    let tick = tick.saturating_sub(7 * player as u32);
    let secs = tick as f32 / 30.0;
    let ramp = |from: f32, over: f32| ((secs - from) / over).clamp(0.0, 1.0);
    // Forward from 0.5 s on; still from the end of the roll until it has got up from the shove; slower at the end.
    let still = (11.0..15.5).contains(&secs);
    let forward = if still { 0.0 } else { ramp(0.5, 1.0) };
    let bend = ramp(4.0, 0.5) - ramp(7.0, 0.5);
    let side = if player.is_multiple_of(2) { 1.0 } else { -1.0 };
    let run = ramp(3.0, 1.0) - ramp(7.0, 0.8);
    let crouch = ramp(17.0, 1.0);
    let mut buttons = Buttons::NONE;
    buttons.set(Button::East, (9.0..9.2).contains(&secs));
    buttons.set(PUT_BUTTON, (15.6..15.8).contains(&secs));
    buttons.set(THROW_BUTTON, (16.4..16.6).contains(&secs));
    buttons.set(SHOVE_BUTTON, player == 0 && (11.6..11.8).contains(&secs));
    Pad {
        left_stick: [(side * bend * 60.0) as i8, (forward * 127.0) as i8],
        triggers: [(crouch * 128.0) as u8, (run * 255.0) as u8],
        camera: 0,
        buttons: buttons.bits(),
    }
}

/// What was seen of the first player while the script ran.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Greatest horizontal speed before the roll, metres per second.
    pub top_speed_mps: f32,
    /// The skill `roll` began.
    pub rolled: bool,
    /// It lay on the ground, and the pack's skill to get up began.
    pub fell: bool,
    /// After that skill it stood again.
    pub got_up: bool,
}

impl Seen {
    /// Looks at an arena after a tick.
    pub fn look(&mut self, arena: &Arena) {
        let Some(player) = arena.player(0) else { return };
        let roll = arena.pack().skill_named("roll");
        let begun = player.report.skill_started;
        self.rolled |= begun.is_some() && begun == roll;
        if !self.rolled {
            let velocity = player.state.root().linear_velocity.truncate();
            self.top_speed_mps = self.top_speed_mps.max(velocity.length());
        }
        self.fell |= begun.is_some() && begun == arena.pack().recovery();
        self.got_up |= self.fell && player.report.skill.is_none() && player.state.root_height() > 0.75;
    }
}
