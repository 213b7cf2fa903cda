//! The second character of the side-by-side comparison (the paper's figure 4): from the same state, under the same
//! command, another blend mode.

use glam::Vec2;
use physics_bridge::{BodyPoses, Character};
use policy_core::{BlendMode, CharacterState, Command, Controller};

use super::{SteeredCharacter, interpolated};

/// A character that shows what another blend mode would do.
#[derive(Debug)]
pub struct Ghost {
    character: Character,
    controller: Controller,
    state: CharacterState,
    poses: [BodyPoses; 2],
    /// True after its physics diverged: it stands still from then on.
    broken: bool,
}

impl Ghost {
    /// A ghost of `character`, which `steered` steers; `None` when its state can't be copied.
    pub(super) fn of(character: &Character, steered: &SteeredCharacter, mode: BlendMode) -> Option<Self> {
        let mut copy = Character::new(character.model());
        copy.restore(&character.save()).ok()?;
        let mut controller = steered.controller.clone();
        controller.set_blend_mode(mode);
        let mut poses = BodyPoses::new(character.model().skeleton());
        copy.poses_into(&mut poses);
        let state = steered.state.clone();
        Some(Self { character: copy, controller, state, poses: [poses.clone(), poses], broken: false })
    }

    /// Its blend mode.
    #[must_use]
    pub fn mode(&self) -> BlendMode {
        self.controller.config().blend_mode
    }

    /// Horizontal speed of its root body, metres per second.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.state.root().linear_velocity.truncate().length()
    }

    /// True while it lies, gets up, or has diverged.
    #[must_use]
    pub fn is_down(&self) -> bool {
        self.broken || self.controller.report().fallen
    }

    pub(super) fn character_mut(&mut self) -> &mut Character {
        &mut self.character
    }

    pub(super) fn poses(&self, alpha: f32) -> BodyPoses {
        interpolated(&self.poses[0], &self.poses[1], alpha)
    }

    /// One tick of `dt_secs` under the player's command, which stands at `player`.
    pub(super) fn tick(&mut self, command: &Command, player: Vec2, dt_secs: f32) {
        if self.broken {
            return;
        }
        let here = self.state.root().position.truncate();
        let target = command.target.map(|t| t - player + here);
        let command = Command { target, ..*command };
        self.broken = self.character.control_tick(&mut self.controller, &command, dt_secs).is_err();
        self.character.sense_into(&mut self.state);
        self.poses.swap(0, 1);
        self.character.poses_into(&mut self.poses[1]);
    }
}
