//! Characters in bevy_rapier's world: bodies put in, sensed, driven, mirrored, repaired, taken out.
//!
//! A character is one multibody in the sets of the default `RapierContext`, put there by physics-rapier. Its bodies have
//! no `RigidBody` component, so bevy_rapier's own systems leave them alone. Each body and its colliders carry the
//! entity of a [`PolicyBody`](crate::PolicyBody) as user data, so queries and events of bevy_rapier name that entity.

mod insert;
mod place;
mod repair;
mod step;

use std::sync::{Arc, Weak};

use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::systemparams::{RapierContextMut, WriteRapierContext};
use bevy_rapier3d::plugin::context::{DefaultRapierContext, RapierContextSimulation};
use bevy_rapier3d::plugin::{
    NoUserData, PhysicsSet, RapierConfiguration, RapierContextInitialization, RapierPhysicsPlugin,
    TimestepMode,
};
use bevy_rapier3d::prelude::{ActiveEvents, CollisionGroups, PhysicsQuarantineEvent};
use physics_rapier::{Articulation, Drive, Model, ModelError, Sets};
use policy_core::CharacterPack;
use policy_core::contract::Pose;

use crate::character::PolicyCharacter;
use crate::core_plugin::PolicySpaceSystems;

use self::place::GroundPose;

/// How a character is in Rapier. Read when its body is built.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct RapierCharacter {
    /// Motors of Rapier, the default, stand any fixed rate of 60 Hz and more. Torques want the physics rate of the
    /// pack, 120 Hz for the humanoid, and one solver iteration; motion is then as in training.
    #[reflect(ignore)]
    pub drive: Drive,
    /// What its colliders touch. Of each other, those touch that do in the pack's MJCF: the humanoid's legs.
    pub groups: CollisionGroups,
    /// Events of its colliders.
    pub events: ActiveEvents,
}

impl Default for RapierCharacter {
    fn default() -> Self {
        Self { drive: Drive::Motors, groups: CollisionGroups::default(), events: ActiveEvents::empty() }
    }
}

/// The body of a character in Rapier's world. The plug-in adds it when the pack is loaded.
#[derive(Component, Clone, Debug)]
pub struct RapierArticulation {
    articulation: Articulation,
    /// The pack that the body is of.
    pack: Arc<CharacterPack>,
    /// Standing, z up.
    stand: Pose,
    /// The [`PolicyBody`](crate::PolicyBody) of each body.
    entities: Vec<Entity>,
    /// Stands for the massless links between the hinges of one body, which Rapier has and the skeleton has not.
    links: Entity,
    /// Where it last stood well.
    good: GroundPose,
    fault: Option<Fault>,
}

impl RapierArticulation {
    /// The articulation, to find its handles.
    #[must_use]
    pub fn articulation(&self) -> &Articulation {
        &self.articulation
    }
}

/// What is to be done about a body that is not as it should be, before the next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// Build it anew where it last stood well.
    Stand,
    /// Build it anew in its pose.
    KeepPose,
}

/// Puts characters into bevy_rapier's world.
///
/// Adds [`RapierPhysicsPlugin`] in the fixed schedule, with the step of [`Time<Fixed>`], unless the game added it before
/// this plug-in, with any hooks. It has to be in the same fixed schedule then.
pub struct PolicyRapierPlugin {
    schedule: InternedScheduleLabel,
}

impl Default for PolicyRapierPlugin {
    /// In [`FixedUpdate`].
    fn default() -> Self {
        Self::in_schedule(FixedUpdate)
    }
}

impl PolicyRapierPlugin {
    /// In another fixed schedule.
    #[must_use]
    pub fn in_schedule(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Plugin for PolicyRapierPlugin {
    fn build(&self, app: &mut App) {
        // Every `RapierPhysicsPlugin` brings this one, whatever its hooks.
        if !app.world().contains_resource::<Messages<PhysicsQuarantineEvent>>() {
            let mut world = RapierContextInitialization::default();
            if let RapierContextInitialization::InitializeDefaultRapierContext {
                integration_parameters,
                ..
            } = &mut world
            {
                Drive::Motors.tune(integration_parameters);
            }
            app.insert_resource(TimestepMode::Fixed { dt: 1.0 / 64.0, substeps: 1 })
                .add_plugins(
                    RapierPhysicsPlugin::<NoUserData>::default()
                        .with_custom_initialization(world)
                        .in_schedule(self.schedule),
                )
                .add_systems(self.schedule, match_timestep.before(PhysicsSet::SyncBackend));
        }
        app.init_resource::<Models>()
            .register_type::<RapierCharacter>()
            .register_required_components::<PolicyCharacter, RapierCharacter>()
            .add_observer(insert::take_out)
            .add_observer(insert::forget);
        app.configure_sets(
            self.schedule,
            (PolicySpaceSystems::Sense, PolicySpaceSystems::Decide, PolicySpaceSystems::Actuate)
                .chain()
                .before(PhysicsSet::SyncBackend)
                .run_if(is_active),
        );
        app.add_systems(
            self.schedule,
            (
                (
                    repair::put_back,
                    repair::check,
                    repair::rebuild,
                    insert::put_in,
                    place::teleport,
                    repair::reload,
                    step::sense,
                )
                    .chain()
                    .in_set(PolicySpaceSystems::Sense),
                step::actuate.in_set(PolicySpaceSystems::Actuate),
                step::mirror.after(PhysicsSet::Writeback).run_if(is_active),
                insert::report_contexts.after(PhysicsSet::Writeback),
            ),
        );
    }
}

/// Steps Rapier by the step of the schedule.
fn match_timestep(time: Res<Time>, mut mode: ResMut<TimestepMode>) {
    if let TimestepMode::Fixed { dt, .. } = &mut *mode
        && *dt != time.delta_secs()
        && time.delta_secs() > 0.0
    {
        *dt = time.delta_secs();
    }
}

/// The default contexts: there should be one.
type DefaultContexts<'w, 's> =
    Query<'w, 's, Entity, (With<RapierContextSimulation>, With<DefaultRapierContext>)>;

/// False while the game has stopped Rapier.
fn is_active(
    worlds: Query<&RapierConfiguration, (With<RapierContextSimulation>, With<DefaultRapierContext>)>,
) -> bool {
    worlds.iter().any(|world| world.physics_pipeline_active)
}

/// The sets of a world.
fn sets<'a>(world: &'a mut RapierContextMut) -> Sets<'a> {
    let (bodies, joints) = (&mut *world.rigidbody_set, &mut *world.joints);
    Sets {
        bodies: &mut bodies.bodies,
        colliders: &mut world.colliders.colliders,
        impulse_joints: &mut joints.impulse_joints,
        multibody_joints: &mut joints.multibody_joints,
        islands: &mut world.simulation.islands,
        soft_bodies: &mut bodies.soft_bodies,
    }
}

/// Tells bevy_rapier which entity is which body, after bodies came or went.
fn name_bodies(world: &mut RapierContextMut) {
    world.rigidbody_set.rebuild_entity_maps();
    world.colliders.rebuild_entity_maps();
}

/// The default world, if there is one.
fn world_of<'a>(context: &'a mut WriteRapierContext) -> Option<RapierContextMut<'a>> {
    context.single_mut().ok()
}

/// One model for each pack in use.
#[derive(Resource, Default)]
struct Models(Vec<(Weak<CharacterPack>, Model)>);

impl Models {
    fn of(&mut self, pack: &Arc<CharacterPack>) -> Result<Model, ModelError> {
        self.0.retain(|(owner, _)| owner.strong_count() > 0);
        let known = self.0.iter().find(|(owner, _)| owner.as_ptr() == Arc::as_ptr(pack));
        if let Some((_, model)) = known {
            return Ok(model.clone());
        }
        let model = Model::for_pack(pack)?;
        self.0.push((Arc::downgrade(pack), model.clone()));
        Ok(model)
    }
}
