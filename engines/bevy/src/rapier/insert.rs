//! Bodies come into Rapier's world with a character and leave with it.

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::RapierContextEntityLink;
use bevy_rapier3d::plugin::context::systemparams::{RapierContextMut, WriteRapierContext};
use physics_rapier::{Articulation, Model};
use policy_core::CharacterState;
use policy_core::contract::Pose;

use crate::axes;
use crate::body::{self, BodyPose, PolicyBodies};
use crate::character::{PolicyCharacter, PolicyController};
use crate::messages::{CharacterError, CharacterProblem, Reported};

use super::place::{GroundPose, stand};
use super::{DefaultContexts, Models, RapierArticulation, RapierCharacter, name_bodies, sets, world_of};

/// Puts characters in whose pack is loaded.
pub(super) fn put_in(
    mut commands: Commands,
    mut waiting: Query<
        (Entity, &mut PolicyController, &RapierCharacter, &Transform),
        (With<PolicyCharacter>, Without<RapierArticulation>),
    >,
    mut context: WriteRapierContext,
    contexts: DefaultContexts,
    mut models: ResMut<Models>,
    mut reported: Local<Reported>,
    mut errors: MessageWriter<CharacterError>,
) {
    reported.keep(|entity| waiting.contains(entity));
    let (Some(mut world), Ok(link)) = (world_of(&mut context), contexts.single()) else { return };
    for (character, mut controller, wanted, transform) in &mut waiting {
        let pack = controller.controller.pack().clone();
        let model = models.of(&pack).map_err(|error| CharacterProblem::Body { message: error.to_string() });
        let place = GroundPose::of(transform);
        let (model, good) = match (model, place) {
            (Ok(model), Ok(place)) => (model, place),
            (Err(problem), _) | (_, Err(problem)) => {
                reported.write(problem, character, &mut errors);
                continue;
            }
        };
        let entities = spawn_bodies(&mut commands, character, &model);
        let links = spawn_links(&mut commands, character);
        let (mut articulation, rest, standing) = build(&model, wanted, &mut world, &entities, links);
        stand(&mut articulation, &standing, &mut world, good).expect("a checked pose of bodies just built");
        name_bodies(&mut world);
        (controller.rest, controller.embodied) = (rest, true);
        let (set, joints) = (&world.rigidbody_set.bodies, &world.joints.multibody_joints);
        articulation
            .sense_into(set, joints, good.point.y, &mut controller.sensed)
            .expect("bodies just built");
        axes::turn_state(&mut controller.sensed);
        for (&entity, at) in entities.iter().zip(body::poses(&controller)) {
            let mut pose = BodyPose::default();
            pose.jump(at);
            // With the link, bevy_rapier can hang colliders of the game on the body.
            commands.entity(entity).try_insert((pose, RapierContextEntityLink(link)));
        }
        let mut pose = BodyPose { written: Some(*transform), ..BodyPose::default() };
        pose.jump(body::ground_pose(&controller));
        let own =
            RapierArticulation { articulation, pack, stand: standing, entities, links, good, fault: None };
        commands.queue(move |world: &mut World| embody(world, character, own, pose));
    }
}

/// Gives a character its body, or takes that out again when the game has despawned the character by now.
fn embody(world: &mut World, character: Entity, own: RapierArticulation, pose: BodyPose) {
    if let Ok(mut character) = world.get_entity_mut(character) {
        character.insert((own, pose));
        return;
    }
    for &entity in own.entities.iter().chain([&own.links]) {
        world.try_despawn(entity).ok();
    }
    let remove = |In(articulation): In<Articulation>, mut context: WriteRapierContext| {
        let Some(mut rapier) = world_of(&mut context) else { return };
        articulation.remove(&mut sets(&mut rapier));
        name_bodies(&mut rapier);
    };
    // A system of these parameters always runs.
    world.run_system_once_with(remove, own.articulation).ok();
}

/// Reports characters that wait because there is not exactly one default context.
pub(super) fn report_contexts(
    waiting: Query<Entity, (With<PolicyController>, Without<RapierArticulation>)>,
    contexts: DefaultContexts,
    mut reported: Local<Reported>,
    mut errors: MessageWriter<CharacterError>,
) {
    reported.keep(|entity| waiting.contains(entity));
    let found = contexts.iter().count();
    for character in waiting.iter().filter(|_| found != 1) {
        reported.write(CharacterProblem::Context { found }, character, &mut errors);
    }
}

/// An entity for each body.
fn spawn_bodies(commands: &mut Commands, character: Entity, model: &Model) -> Vec<Entity> {
    let bodies = model.skeleton().bodies().iter().enumerate();
    bodies.map(|(index, part)| body::spawn_body(commands, character, index, &part.name)).collect()
}

pub(super) fn spawn_links(commands: &mut Commands, character: Entity) -> Entity {
    commands.spawn((Name::new("massless links"), ChildOf(character))).id()
}

/// Builds a body in Rapier. Returns what it senses with all joints at zero, and its standing pose, both z up.
pub(super) fn build(
    model: &Model,
    wanted: &RapierCharacter,
    world: &mut RapierContextMut,
    entities: &[Entity],
    links: Entity,
) -> (Articulation, CharacterState, Pose) {
    let mut articulation = Articulation::insert(model, &mut sets(world), wanted.drive, wanted.groups.into());
    let skeleton = model.skeleton();
    let (mut standing, zero) = (Pose::new(skeleton), Pose::new(skeleton));
    let set = &world.rigidbody_set.bodies;
    articulation.pose_into(set, &world.joints.multibody_joints, &mut standing).expect("bodies just inserted");
    articulation.set_pose(&mut sets(world), &zero.qpos, &zero.qvel).expect("a sound pose");
    let mut rest = CharacterState::new(skeleton);
    let (set, joints) = (&mut world.rigidbody_set.bodies, &world.joints.multibody_joints);
    articulation.sense_into(set, joints, 0.0, &mut rest).expect("bodies just inserted");

    let root = joints.rigid_body_link(articulation.bodies()[0]).map(|link| link.multibody);
    let multibody = root.and_then(|root| joints.get_multibody(root)).expect("the root is in a multibody");
    for link in multibody.links() {
        if let Some(body) = set.get_mut(link.rigid_body_handle()) {
            body.user_data = links.to_bits().into();
        }
    }
    for (&handle, entity) in articulation.bodies().iter().zip(entities) {
        let Some(body) = set.get_mut(handle) else { continue };
        body.user_data = entity.to_bits().into();
        for &collider in body.colliders() {
            if let Some(collider) = world.colliders.colliders.get_mut(collider) {
                collider.user_data = entity.to_bits().into();
                collider.set_active_events(wanted.events.into());
            }
        }
    }
    (articulation, rest, standing)
}

/// Takes the body out of Rapier's world when its character is despawned.
pub(super) fn take_out(
    removed: On<Remove<RapierArticulation>>,
    bodies: Query<&RapierArticulation>,
    mut context: WriteRapierContext,
    mut commands: Commands,
) {
    let character = removed.entity;
    let (Ok(own), Some(mut world)) = (bodies.get(character), world_of(&mut context)) else { return };
    own.articulation.clone().remove(&mut sets(&mut world));
    name_bodies(&mut world);
    // A character that is despawned takes its bodies along. One that is not gets new ones.
    let links = own.links;
    commands.queue(move |world: &mut World| {
        let Ok(mut character) = world.get_entity_mut(character) else { return };
        character.despawn_related::<PolicyBodies>();
        world.try_despawn(links).ok();
    });
}

/// Takes everything away that came with `PolicyCharacter`, when the game removes that alone.
pub(super) fn forget(removed: On<Remove<PolicyCharacter>>, mut commands: Commands) {
    let character = removed.entity;
    commands.queue(move |world: &mut World| {
        // A character that is despawned takes its bodies along.
        if let Ok(mut character) = world.get_entity_mut(character) {
            character.remove::<(RapierArticulation, PolicyController, BodyPose)>();
        }
    });
}
