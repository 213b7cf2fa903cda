//! Characters in MuJoCo, the engine that they were trained in, behind the same components. Feature `mujoco`.
//!
//! Characters, [`MujocoProp`]s and [`MujocoFixture`]s are in one world of physics-bridge, apart from any other physics of
//! the game. That world steps by whole control ticks. Between them the poses of entities are interpolated, so what is
//! drawn is one control tick late: 33 ms for the humanoid.

mod insert;
mod place;
mod put_things;
mod step;
mod things;

use std::sync::{Arc, Weak};

use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use physics_bridge::{CharacterHandle, FixtureHandle, Model, ModelError, PropHandle, Terrain, World};
use policy_core::{CharacterPack, CharacterState, FixedRate};

use crate::core_plugin::PolicySpaceSystems;
use crate::rapier::PolicyRapierPlugin;

pub use self::things::{MujocoFixture, MujocoProp, MujocoPropBody, MujocoRefusal};

/// The body of a character in the MuJoCo world. The plug-in adds it when the pack is loaded.
#[derive(Component, Clone, Debug)]
pub struct MujocoBody {
    handle: CharacterHandle,
    /// The pack that the body is of.
    pack: Arc<CharacterPack>,
    /// The [`PolicyBody`](crate::PolicyBody) of each body.
    entities: Vec<Entity>,
    /// Poses at the last two control ticks, Bevy's world: of the character itself, then of each body.
    before: Vec<Isometry3d>,
    after: Vec<Isometry3d>,
}

impl MujocoBody {
    /// Names the character in [`MujocoWorld::world`].
    #[must_use]
    pub fn handle(&self) -> CharacterHandle {
        self.handle
    }
}

/// The MuJoCo world of a game. It is made with the first character, on the plane or the terrain of the plug-in.
#[derive(Resource)]
pub struct MujocoWorld {
    world: Option<World>,
    terrain: Terrain,
    rate: FixedRate,
    /// Control ticks that this fixed step is to run.
    due: u32,
    has_ticked: bool,
    models: Vec<(Weak<CharacterPack>, Described)>,
    leaving: Vec<Leaving>,
}

/// A body, and what it senses with all joints at zero.
#[derive(Clone)]
struct Described {
    model: Model,
    rest: CharacterState,
}

/// What is to be taken out of the world.
#[derive(Clone, Copy)]
enum Leaving {
    Character(CharacterHandle),
    Prop(PropHandle),
    Fixture(FixtureHandle),
}

impl MujocoWorld {
    fn new(terrain: Terrain) -> Self {
        Self {
            world: None,
            terrain,
            rate: FixedRate::new(policy_core::contract::CONTROL_HZ as f32),
            due: 0,
            has_ticked: false,
            models: Vec::new(),
            leaving: Vec::new(),
        }
    }

    /// The world, z up, to look for contacts, read motions, save; `None` before the first character. Rays need
    /// [`MujocoWorld::world_mut`].
    #[must_use]
    pub fn world(&self) -> Option<&World> {
        self.world.as_ref()
    }

    /// The world, to push, join props, restore. A character that is removed here is reported and comes in again; a prop
    /// is reported and stays out until its component is inserted anew.
    #[must_use]
    pub fn world_mut(&mut self) -> Option<&mut World> {
        self.world.as_mut()
    }

    /// Counts the control ticks of a fixed step. The first step of a world has one.
    fn advance(&mut self, step_secs: f32) {
        self.due = match (&self.world, self.has_ticked) {
            (None, _) => 0,
            (Some(_), false) => 1,
            (Some(_), true) => self.rate.advance(step_secs),
        };
        self.has_ticked = self.world.is_some();
    }

    /// The body of a pack.
    fn described(&mut self, pack: &Arc<CharacterPack>) -> Result<Described, ModelError> {
        self.models.retain(|(owner, _)| owner.strong_count() > 0);
        let known = self.models.iter().find(|(owner, _)| owner.as_ptr() == Arc::as_ptr(pack));
        if let Some((_, described)) = known {
            return Ok(described.clone());
        }
        let described = insert::describe(Model::for_pack(pack)?);
        self.models.push((Arc::downgrade(pack), described.clone()));
        Ok(described)
    }
}

/// Puts characters into a MuJoCo world, in place of [`PolicyRapierPlugin`].
///
/// # Panics
/// When an app has both.
pub struct PolicyMujocoPlugin {
    /// The ground.
    pub terrain: Terrain,
    schedule: InternedScheduleLabel,
}

impl Default for PolicyMujocoPlugin {
    /// On the plane of the pack, in [`FixedUpdate`].
    fn default() -> Self {
        Self::in_schedule(FixedUpdate)
    }
}

impl PolicyMujocoPlugin {
    /// In another fixed schedule.
    #[must_use]
    pub fn in_schedule(schedule: impl ScheduleLabel) -> Self {
        Self { terrain: Terrain::Flat, schedule: schedule.intern() }
    }

    /// On other ground.
    #[must_use]
    pub fn on(self, terrain: Terrain) -> Self {
        Self { terrain, ..self }
    }
}

impl Plugin for PolicyMujocoPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(MujocoWorld::new(self.terrain))
            .register_type::<MujocoProp>()
            .register_type::<MujocoFixture>()
            .add_message::<MujocoRefusal>()
            .add_observer(insert::take_out)
            .add_observer(insert::forget)
            .add_observer(things::take_out_prop)
            .add_observer(things::forget_prop)
            .add_observer(things::take_out_fixture)
            .add_observer(things::forget_fixture);
        app.configure_sets(
            self.schedule,
            (PolicySpaceSystems::Sense, PolicySpaceSystems::Decide, PolicySpaceSystems::Actuate).chain(),
        );
        app.add_systems(
            self.schedule,
            (
                (
                    place::put_back,
                    insert::put_in,
                    // Bodies are there from now on.
                    ApplyDeferred,
                    things::try_again,
                    put_things::put_in,
                    things::teleport,
                    place::teleport,
                    insert::reload,
                    step::sense,
                )
                    .chain()
                    .in_set(PolicySpaceSystems::Sense),
                step::actuate.in_set(PolicySpaceSystems::Actuate),
                (step::step, things::mirror).chain().after(PolicySpaceSystems::Actuate),
            ),
        );
        app.add_systems(PostUpdate, things::log_refusals);
    }

    fn finish(&self, app: &mut App) {
        assert!(
            !app.is_plugin_added::<PolicyRapierPlugin>(),
            "expected characters in one physics, found PolicyRapierPlugin beside PolicyMujocoPlugin: \
             add PolicySpaceMujocoPlugins in place of PolicySpacePlugins"
        );
    }
}
