//! Bodies that are not as they should be: built anew, in their pose or where they last stood well.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_rapier3d::plugin::context::RapierContextEntityLink;
use bevy_rapier3d::plugin::context::systemparams::{ReadRapierContext, WriteRapierContext};
use bevy_rapier3d::prelude::{ColliderDisabled, RigidBodyDisabled};
use policy_core::contract::Pose;

use crate::body::{self, BodyPose, PolicyBody};
use crate::character::{PolicyCharacter, PolicyController};
use crate::messages::{CharacterError, CharacterProblem};

use super::insert::{build, spawn_links};
use super::place::{settle, stand};
use super::{
    DefaultContexts, Fault, Models, RapierArticulation, RapierCharacter, name_bodies, sets, world_of,
};

/// Puts back what the physics of a character needs and a game removed.
pub(super) fn put_back(
    mut commands: Commands,
    wanted: Query<Entity, (With<PolicyCharacter>, Without<RapierCharacter>)>,
    posed: Query<Entity, (With<RapierArticulation>, Without<BodyPose>)>,
    mut characters: Query<(Entity, &mut RapierArticulation, &PolicyController)>,
    bodies: Query<(), (With<PolicyBody>, With<BodyPose>, With<Transform>)>,
    mut errors: MessageWriter<CharacterError>,
) {
    for character in &wanted {
        commands.entity(character).try_insert(RapierCharacter::default());
        errors.write(CharacterProblem::Component { component: "RapierCharacter" }.of(character));
    }
    for character in &posed {
        commands.entity(character).try_insert(BodyPose::default());
        errors.write(CharacterProblem::Component { component: "BodyPose" }.of(character));
    }
    for (character, mut own, controller) in &mut characters {
        let component = if !controller.embodied {
            // It was removed, and one that knows no body was put in its place.
            "PolicyController"
        } else if !own.entities.iter().all(|&entity| bodies.contains(entity)) {
            "PolicyBody"
        } else {
            continue;
        };
        if own.fault.is_none() {
            own.fault = Some(Fault::KeepPose);
            errors.write(CharacterProblem::Component { component }.of(character));
        }
    }
}

/// Catches numbers that are not finite before Rapier steps, which panics on some of them.
pub(super) fn check(
    mut characters: Query<(Entity, &mut RapierArticulation)>,
    context: ReadRapierContext,
    mut errors: MessageWriter<CharacterError>,
) {
    let Ok(world) = context.single() else { return };
    for (entity, mut own) in characters.iter_mut().filter(|(_, own)| own.fault.is_none()) {
        let joints = &world.joints.multibody_joints;
        let link = joints.rigid_body_link(own.articulation.bodies()[0]);
        let Some(multibody) = link.and_then(|link| joints.get_multibody(link.multibody)) else { continue };
        let moves = multibody.generalized_velocity().iter().all(|speed| speed.is_finite());
        let mut links = multibody.links();
        if !moves || !links.all(|link| link.local_to_world().is_finite()) {
            own.fault = Some(Fault::Stand);
            let message = "a position or velocity is not finite".into();
            errors.write(CharacterProblem::Diverged { message }.of(entity));
        }
    }
}

/// Builds bodies anew that have a fault.
pub(super) fn rebuild(
    mut commands: Commands,
    mut characters: Query<(
        Entity,
        &mut RapierArticulation,
        &mut PolicyController,
        &RapierCharacter,
        &mut BodyPose,
    )>,
    mut bodies: Query<&mut BodyPose, (With<PolicyBody>, With<Transform>, Without<RapierArticulation>)>,
    mut context: WriteRapierContext,
    contexts: DefaultContexts,
) {
    let (Some(mut world), Ok(link)) = (world_of(&mut context), contexts.single()) else { return };
    for (character, mut own, mut controller, wanted, mut pose) in &mut characters {
        let Some(fault) = own.fault else { continue };
        let own = &mut *own;
        let model = own.articulation.model().clone();
        let mut kept = Pose::new(model.skeleton());
        let (set, joints) = (&world.rigidbody_set.bodies, &world.joints.multibody_joints);
        let keeps = fault == Fault::KeepPose && own.articulation.pose_into(set, joints, &mut kept).is_ok();

        for (index, entity) in own.entities.iter_mut().enumerate() {
            if bodies.contains(*entity) {
                commands.entity(*entity).try_remove::<(RigidBodyDisabled, ColliderDisabled)>();
            } else {
                commands.entity(*entity).try_despawn();
                let name = &model.skeleton().bodies()[index].name;
                *entity = body::spawn_body(&mut commands, character, index, name);
                commands.entity(*entity).try_insert(RapierContextEntityLink(link));
            }
        }
        body::sort_bodies(&mut commands, character);
        commands.entity(own.links).try_despawn();
        own.links = spawn_links(&mut commands, character);
        own.articulation.clone().remove(&mut sets(&mut world));
        let (articulation, rest, standing) = build(&model, wanted, &mut world, &own.entities, own.links);
        (own.articulation, controller.rest, own.stand, own.fault) = (articulation, rest, standing, None);
        controller.embodied = true;
        if !keeps || own.articulation.set_pose(&mut sets(&mut world), &kept.qpos, &kept.qvel).is_err() {
            stand(&mut own.articulation, &own.stand, &mut world, own.good)
                .expect("a checked pose of bodies just built");
            settle(own, &mut controller, &world, &mut pose, &mut bodies);
        }
        name_bodies(&mut world);
    }
}

/// Gives a character the body of its new pack, in the pose that it has.
pub(super) fn reload(
    mut characters: Query<(Entity, &mut PolicyController, &mut RapierArticulation, &RapierCharacter)>,
    mut context: WriteRapierContext,
    mut models: ResMut<Models>,
    mut errors: MessageWriter<CharacterError>,
) {
    let Some(mut world) = world_of(&mut context) else { return };
    for (entity, mut controller, mut own, wanted) in &mut characters {
        let pack = controller.controller.pack();
        if Arc::ptr_eq(pack, &own.pack) {
            continue;
        }
        let same_body = pack.mjcf() == own.pack.mjcf() && pack.control_hz() == own.pack.control_hz();
        own.pack = pack.clone();
        if same_body {
            continue;
        }
        let model = match models.of(pack) {
            Ok(model) => model,
            Err(error) => {
                errors.write(CharacterProblem::Body { message: error.to_string() }.of(entity));
                continue;
            }
        };
        let own = &mut *own;
        let mut kept = Pose::new(model.skeleton());
        let (set, joints) = (&world.rigidbody_set.bodies, &world.joints.multibody_joints);
        let keeps = own.articulation.pose_into(set, joints, &mut kept).is_ok();
        own.articulation.clone().remove(&mut sets(&mut world));
        let (articulation, rest, standing) = build(&model, wanted, &mut world, &own.entities, own.links);
        (own.articulation, own.stand, controller.rest) = (articulation, standing, rest);
        if !keeps || own.articulation.set_pose(&mut sets(&mut world), &kept.qpos, &kept.qvel).is_err() {
            own.fault = Some(Fault::Stand);
        }
        name_bodies(&mut world);
    }
}
