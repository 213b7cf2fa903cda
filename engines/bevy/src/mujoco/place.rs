//! Where a character stands: when the game puts it elsewhere, and what is put back when the game removes it.

use bevy::prelude::*;

use crate::axes;
use crate::body::{self, BodyPose, PolicyBody, is_moved};
use crate::character::PolicyController;
use crate::messages::{CharacterError, CharacterProblem};

use super::{MujocoBody, MujocoWorld};

/// Poses in Bevy's world: of the character itself, then of each body.
pub(super) fn poses(controller: &PolicyController) -> Vec<Isometry3d> {
    std::iter::once(body::ground_pose(controller)).chain(body::poses(controller)).collect()
}

/// Puts back what a character needs and a game removed.
pub(super) fn put_back(
    mut commands: Commands,
    posed: Query<Entity, (With<MujocoBody>, Without<BodyPose>)>,
    mut characters: Query<(Entity, &mut MujocoBody, &mut PolicyController)>,
    bodies: Query<(), (With<PolicyBody>, With<BodyPose>, With<Transform>)>,
    mut world: ResMut<MujocoWorld>,
    mut errors: MessageWriter<CharacterError>,
) {
    for character in &posed {
        commands.entity(character).try_insert(BodyPose::default());
        errors.write(CharacterProblem::Component { component: "BodyPose" }.of(character));
    }
    for (character, mut own, mut controller) in &mut characters {
        // One that was removed, and for which one that knows no body was put in its place.
        if !controller.embodied
            && let Ok(described) = world.described(&own.pack)
        {
            (controller.rest, controller.embodied) = (described.rest, true);
            errors.write(CharacterProblem::Component { component: "PolicyController" }.of(character));
        }
        if own.entities.iter().all(|&entity| bodies.contains(entity)) {
            continue;
        }
        errors.write(CharacterProblem::Component { component: "PolicyBody" }.of(character));
        let own = &mut *own;
        let skeleton = own.pack.skeleton();
        for (index, entity) in own.entities.iter_mut().enumerate() {
            if !bodies.contains(*entity) {
                commands.entity(*entity).try_despawn();
                let name = &skeleton.bodies()[index].name;
                *entity = body::spawn_body(&mut commands, character, index, name);
            }
        }
        body::sort_bodies(&mut commands, character);
    }
}

/// Puts characters where the game has set their `Transform`. Their height is that of the ground.
pub(super) fn teleport(
    mut characters: Query<(Entity, &mut Transform, &mut BodyPose, &mut MujocoBody, &mut PolicyController)>,
    mut bodies: Query<&mut BodyPose, (With<PolicyBody>, Without<MujocoBody>)>,
    mut own: ResMut<MujocoWorld>,
    mut errors: MessageWriter<CharacterError>,
) {
    let Some(world) = &mut own.world else { return };
    for (entity, mut transform, mut pose, mut body, mut controller) in &mut characters {
        let Some(written) = pose.written.filter(|written| is_moved(written, &transform)) else { continue };
        let point = axes::ground_from_bevy(transform.translation);
        let heading = axes::heading_from_bevy(transform.rotation);
        let placed = if transform.translation.is_finite() && transform.rotation.is_finite() {
            let stood = world.stand_at(body.handle, point.x, point.y, heading, 0.0);
            stood.map_err(|error| CharacterProblem::OutOfReach { message: error.to_string() })
        } else {
            Err(CharacterProblem::Transform { found: *transform })
        };
        if let Err(problem) = placed {
            errors.write(problem.of(entity));
            *transform = written;
            continue;
        }
        pose.written = Some(*transform);
        if world.sense_into(body.handle, &mut controller.sensed).is_ok() {
            controller.restart();
            jump(&mut body, &controller, &mut pose, &mut bodies);
        }
    }
}

/// Takes the poses of a character that have nothing to do with those before.
pub(super) fn jump(
    own: &mut MujocoBody,
    controller: &PolicyController,
    pose: &mut BodyPose,
    bodies: &mut Query<&mut BodyPose, (With<PolicyBody>, Without<MujocoBody>)>,
) {
    own.after = poses(controller);
    own.before.clone_from(&own.after);
    pose.jump(own.after[0]);
    for (&entity, &at) in own.entities.iter().zip(&own.after[1..]) {
        if let Ok(mut pose) = bodies.get_mut(entity) {
            pose.jump(at);
        }
    }
}
