//! A replay in the demo: it steers in place of the player, and its end is told.

use policy_core::{GamepadState, Heading};

use super::App;
use crate::replays::Replaying;

/// What is shown of a replay beside its clock.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReplayLine {
    /// Name of its file.
    pub name: String,
    /// How it ended, and why before its time. Forgotten once the player plays on: see [`super::ViewerCommand::Pause`].
    pub ended: Option<Result<(), String>>,
}

impl App {
    /// Pad and camera of the next tick; `None` at the end of a replay, which the clock then waits at.
    pub(super) fn steering(&mut self) -> Option<(GamepadState, Heading)> {
        let (pad, camera) = (self.input(), self.camera.heading());
        let steered = self.replaying.steer(&pad, camera);
        if steered.is_none() {
            self.end_replay(Ok(()));
        }
        steered
    }

    /// After a tick under that pad and camera.
    pub(super) fn follow_replay(&mut self, pad: &GamepadState, camera: Heading) {
        let hash = self.sim.totals().hash.value();
        if let Err(error) = self.replaying.follow(pad, camera, hash) {
            if matches!(self.replaying, Replaying::Playing(_)) {
                self.end_replay(Err(error.to_string()));
            } else {
                self.toasts.error(format!("Recording stopped: {error}."));
            }
            self.replay_stopped.get_or_insert(error);
        }
    }

    /// Gives the pad back to the player, who finds the clock paused.
    fn end_replay(&mut self, ended: Result<(), String>) {
        self.replay_line.ended = Some(ended);
        self.replaying = Replaying::Off;
        self.clock.paused = true;
    }
}
