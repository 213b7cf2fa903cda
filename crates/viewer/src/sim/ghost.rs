//! The second character of the side-by-side comparison (the paper's figure 4): from the same state, under the
//! same command, another blend mode.

use glam::Vec2;
use physics_bridge::{BodyPoses, Character};
use policy_core::{BlendMode, Body, CharacterState, Command, Controller, JointTargets};

use super::{Actor, TICK_SECS, interpolated};

/// A character that shows what another blend mode would do.
#[derive(Debug)]
pub struct Ghost {
    character: Character,
    controller: Controller,
    mode: BlendMode,
    state: CharacterState,
    poses: [BodyPoses; 2],
    /// True after it blew up: it stands still from then on.
    broken: bool,
}

impl Ghost {
    /// A ghost of `character`, which `actor` steers; `None` when its state can't be copied.
    pub(super) fn of(character: &Character, actor: &Actor, mode: BlendMode) -> Option<Self> {
        let mut copy = Character::new(character.model());
        copy.restore(&character.save()).ok()?;
        let mut ghost = Self {
            character: copy,
            controller: actor.controller.clone(),
            mode,
            state: actor.state,
            poses: [BodyPoses::default(); 2],
            broken: false,
        };
        ghost.character.poses_into(&mut ghost.poses[1]);
        ghost.poses[0] = ghost.poses[1];
        Some(ghost)
    }

    /// Its blend mode.
    #[must_use]
    pub fn mode(&self) -> BlendMode {
        self.mode
    }

    /// Horizontal speed of its pelvis, metres per second.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.state.body(Body::Pelvis).linear_velocity.truncate().length()
    }

    /// True while it lies, rises, or has blown up.
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

    /// One tick under the player's command, which stands at `player`.
    pub(super) fn tick(&mut self, command: &Command, player: Vec2) {
        if self.broken {
            return;
        }
        self.character.sense_into(&mut self.state);
        let here = self.state.body(Body::Pelvis).position.truncate();
        let target = command.target.map(|t| t - player + here);
        let command = Command { mode: self.mode, target, ..*command };
        let targets: JointTargets = *self.controller.tick(&self.state, &command, TICK_SECS);
        self.character.actuate(&targets);
        self.broken = self.character.step().is_err();
        self.poses[0] = self.poses[1];
        self.character.poses_into(&mut self.poses[1]);
    }
}
