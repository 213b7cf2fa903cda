//! Sense, control, actuate: the characters of a world in the same terms as one alone.

use glam::Vec3;
use policy_core::{CharacterState, Command, Controller};

use super::World;
use super::accuse::is_bad;
use super::handle::CharacterHandle;
use super::recover::{Divergence, Diverging, Remedy};
use super::solids::vec3;
use crate::cause::Cause;
use crate::description::body_poses::BodyPoses;
use crate::description::model::Model;
use crate::description::world_error::WorldError;
use crate::kinematics::{poses_into, sense_into};

impl World {
    /// The model of a character.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn model(&self, character: CharacterHandle) -> Result<&Model, WorldError> {
        Ok(self.scene.characters.at(self.scene.characters.index_of(character)?))
    }

    /// Writes what a policy senses, as [`Character::sense_into`](crate::Character::sense_into). The ground is the terrain, or
    /// what is highest below the height of the root of the fixtures on it, and of the props that the character
    /// [can step onto](CharacterState::step_top). Allocates only when `out` was made for another skeleton.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn sense_into(&self, character: CharacterHandle, out: &mut CharacterState) -> Result<(), WorldError> {
        let index = self.scene.characters.index_of(character)?;
        let skeleton = self.scene.characters.at(index).skeleton();
        if !out.fits(skeleton) {
            *out = CharacterState::new(skeleton);
        }
        sense_into(&self.data, &self.places.character(index).layout, out);
        out.copy_ground(&self.grounds[index]);
        Ok(())
    }

    /// Writes where the bodies of a character are. Allocates only when `out` was made for another skeleton.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn poses_into(&self, character: CharacterHandle, out: &mut BodyPoses) -> Result<(), WorldError> {
        let index = self.scene.characters.index_of(character)?;
        poses_into(&self.data, &self.places.character(index).layout, out);
        Ok(())
    }

    /// Centre of mass of a whole character, metres, world space.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn centre_of_mass(&self, character: CharacterHandle) -> Result<Vec3, WorldError> {
        let index = self.scene.characters.index_of(character)?;
        let root = self.places.character(index).layout.body_ids[0];
        Ok(vec3(self.data.subtree_com()[root]).as_vec3())
    }

    /// Sets the angles that the motors of a character pull its joints to, radians, in the order of the skeleton. They
    /// hold until the next call. Targets of which one is not finite, or beyond 1e10, are ignored; the next [`World::step`]
    /// reports them. For one like that MuJoCo would stop the motors of every character in the world.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn actuate(&mut self, character: CharacterHandle, targets: &[f32]) -> Result<(), WorldError> {
        let index = self.scene.characters.index_of(character)?;
        self.write_targets(index, targets);
        Ok(())
    }

    fn write_targets(&mut self, index: usize, targets: &[f32]) {
        if targets.iter().any(|&target| is_bad(&target.into())) {
            let what = Some(Diverging::Character(self.scene.characters.handle(index)));
            let bad = Divergence { what, cause: Cause::BadControl, excess: None, remedy: Remedy::Ignored };
            if !self.waiting.contains(&bad) && self.waiting.len() < self.waiting.capacity() {
                self.waiting.push(bad);
            }
            return;
        }
        let ctrl = self.data.ctrl_mut();
        for (&target, joint) in targets.iter().zip(&self.places.character(index).layout.joints) {
            ctrl[joint.ctrl] = f64::from(target);
        }
    }

    /// Runs one control tick: senses every character that `steering` names, lets its controller make joint targets,
    /// and steps the physics. `steering` returns the character, controller and command of each of `owners`; one with
    /// a stale handle is passed over. Returns how many things diverged. Does not allocate.
    pub fn control_tick_with<C>(
        &mut self,
        owners: &mut [C],
        dt_secs: f32,
        mut steering: impl FnMut(&mut C) -> (CharacterHandle, &mut Controller, Command),
    ) -> usize {
        for owner in owners {
            let (character, controller, command) = steering(owner);
            let Ok(index) = self.scene.characters.index_of(character) else { continue };
            let sensed = &mut self.sensed[index];
            sense_into(&self.data, &self.places.character(index).layout, sensed);
            sensed.copy_ground(&self.grounds[index]);
            let targets = controller.tick(sensed, &command, dt_secs);
            self.write_targets(index, targets);
        }
        self.step()
    }

    /// As [`World::control_tick_with`], for controllers beside their characters and commands.
    pub fn control_tick(
        &mut self,
        players: &mut [(CharacterHandle, Controller, Command)],
        dt_secs: f32,
    ) -> usize {
        self.control_tick_with(players, dt_secs, |(character, controller, command)| {
            (*character, controller, *command)
        })
    }

    /// What a character sensed at the start of the last control tick.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn sensed(&self, character: CharacterHandle) -> Result<&CharacterState, WorldError> {
        Ok(&self.sensed[self.scene.characters.index_of(character)?])
    }
}
