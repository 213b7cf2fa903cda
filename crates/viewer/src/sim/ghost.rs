//! The second character of the side-by-side comparison: from the same state, under the same command, with one thing
//! different: the blend mode (the paper's figure 4) or the physics engine.

use glam::Vec2;
use physics::{Character, Engine, Model, ModelError, PhysicsCharacter};
use physics_bridge::BodyPoses;
use policy_core::contract::Settings;
use policy_core::{BlendMode, CharacterState, Command, Controller};

use super::steered::take_poses;
use super::{SteeredCharacter, interpolated};

/// What is different about a ghost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GhostKind {
    /// Another blend mode.
    Mode(BlendMode),
    /// Another engine.
    Engine(Engine),
}

/// A character that shows what another blend mode or engine would do.
#[derive(Debug)]
pub struct Ghost {
    kind: GhostKind,
    character: Character,
    controller: Controller,
    state: CharacterState,
    poses: [BodyPoses; 2],
    /// True after its physics diverged: it stands still from then on.
    broken: bool,
}

impl Ghost {
    /// A ghost of `character`, which `steered` steers; `None` when its state can't be copied.
    ///
    /// # Errors
    /// When the other engine can't load the body.
    pub(super) fn of(
        character: &Character,
        steered: &SteeredCharacter,
        kind: GhostKind,
    ) -> Result<Option<Self>, ModelError> {
        let mut controller = steered.controller.clone();
        let copied = match kind {
            GhostKind::Mode(mode) => {
                controller.set_blend_mode(mode);
                copy(character)
            }
            GhostKind::Engine(engine) if engine == character.engine() => copy(character),
            GhostKind::Engine(engine) => {
                let mut other = Character::new(&Model::new(character.model().described(), engine)?);
                let pose = character.pose();
                other.set_pose(&pose.qpos, &pose.qvel).ok().map(|()| other)
            }
        };
        let Some(character) = copied else { return Ok(None) };
        let mut poses = BodyPoses::new(character.skeleton());
        let mut state = steered.state.clone();
        character.sense_into(&mut state);
        take_poses(&state, &mut poses);
        let poses = [poses.clone(), poses];
        Ok(Some(Self { kind, character, controller, state, poses, broken: false }))
    }

    /// What is different about it.
    #[must_use]
    pub fn kind(&self) -> GhostKind {
        self.kind
    }

    /// Horizontal speed of its root body, metres per second.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.state.horizontal_speed()
    }

    /// True while it lies, gets up, or has diverged.
    #[must_use]
    pub fn is_down(&self) -> bool {
        self.broken || self.controller.report().fallen
    }

    /// Changes gravity, friction, strength and mass.
    ///
    /// # Errors
    /// When a setting is out of its range; nothing is changed then.
    pub(super) fn set_settings(&mut self, settings: Settings) -> Result<(), ModelError> {
        let model = self.character.model().with_settings(settings)?;
        // The model is one of its own.
        let set = self.character.set_model(&model);
        debug_assert!(set.is_ok(), "{set:?}");
        Ok(())
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
        self.character.actuate(self.controller.tick(&self.state, &command, dt_secs));
        self.broken = self.character.step().is_err();
        self.character.sense_into(&mut self.state);
        self.poses.swap(0, 1);
        take_poses(&self.state, &mut self.poses[1]);
    }
}

/// A second character in the same state.
fn copy(character: &Character) -> Option<Character> {
    let mut copy = Character::new(character.model());
    copy.restore(&character.save()).ok().map(|()| copy)
}
