//! A replay in the demo: it steers in place of the player, and its end is told.

use policy_core::{GamepadState, Heading};

use super::App;
use crate::replays::Replaying;

impl App {
    /// Pad and camera of the next tick; `None` at the end of a replay, which the clock then waits at.
    pub(super) fn steering(&mut self) -> Option<(GamepadState, Heading)> {
        let (pad, camera) = (self.input(), self.camera.heading());
        let steered = self.replaying.steer(&pad, camera);
        if steered.is_none() {
            self.end_replay("The replay is over: every state was the recorded one.".into());
        }
        steered
    }

    /// After a tick under that pad and camera.
    pub(super) fn follow_replay(&mut self, pad: &GamepadState, camera: Heading) {
        let hash = self.sim.totals().hash.value();
        if let Err(error) = self.replaying.follow(pad, camera, hash) {
            if matches!(self.replaying, Replaying::Playing(_)) {
                self.end_replay(format!("The replay stopped: {error}."));
            } else {
                self.toasts.error(format!("Recording stopped: {error}."));
            }
            self.replay_stopped.get_or_insert(error);
        }
    }

    /// Gives the pad back to the player, who finds the clock paused.
    fn end_replay(&mut self, told: String) {
        self.toasts.note(told);
        self.replaying = Replaying::Off;
        self.clock.paused = true;
    }
}
