//! Where a character stands: at first, and when the game puts it elsewhere.

use bevy::prelude::*;
use bevy_rapier3d::plugin::context::systemparams::{RapierContextMut, WriteRapierContext};
use physics_rapier::{Articulation, PlaceError};
use policy_core::Heading;
use policy_core::contract::{MAX_DISTANCE_M, Pose};
use policy_core::glam::Quat;

use crate::axes;
use crate::body::{self, BodyPose, PolicyBody, is_moved};
use crate::character::PolicyController;
use crate::messages::{CharacterError, CharacterProblem};

use super::{Fault, RapierArticulation, sets, world_of};

/// How far a character may reach from the point that it stands on, metres.
const REACH_M: f32 = 10.0;

/// A point on the ground, Bevy's world, and a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GroundPose {
    pub point: Vec3,
    pub heading: Heading,
}

impl GroundPose {
    /// The place of a `Transform`.
    ///
    /// # Errors
    /// When it is not finite, or so far away that what stands there is implausible at once.
    pub fn of(transform: &Transform) -> Result<Self, CharacterProblem> {
        if !transform.translation.is_finite() || !transform.rotation.is_finite() {
            return Err(CharacterProblem::Transform { found: *transform });
        }
        let (most, found) = (MAX_DISTANCE_M - REACH_M, transform.translation.length());
        if found > most {
            let message = format!("expected at most {most} m from the origin, found {found} m");
            return Err(CharacterProblem::OutOfReach { message });
        }
        let heading = axes::heading_from_bevy(transform.rotation);
        Ok(Self { point: transform.translation, heading })
    }
}

/// Stands a character at a place, at rest, its lowest point on the ground.
pub(super) fn stand(
    articulation: &mut Articulation,
    stand: &Pose,
    world: &mut RapierContextMut,
    place: GroundPose,
) -> Result<(), PlaceError> {
    let mut pose = stand.clone();
    let q = &stand.qpos;
    let own = Quat::from_xyzw(q[4] as f32, q[5] as f32, q[6] as f32, q[3] as f32);
    let turned = Quat::from_rotation_z(place.heading.angle()) * own;
    let rotation = axes::rotation_to_bevy(turned).normalize();
    pose.qpos[3..7].copy_from_slice(&[rotation.w, rotation.x, rotation.y, rotation.z].map(f64::from));
    pose.qpos[..3].copy_from_slice(&place.point.to_array().map(f64::from));
    pose.qvel.fill(0.0);
    articulation.set_pose(&mut sets(world), &pose.qpos, &pose.qvel)?;
    pose.qpos[1] += f64::from(place.point.y - lowest_point(articulation, world));
    articulation.set_pose(&mut sets(world), &pose.qpos, &pose.qvel)
}

/// Height of the lowest point of the colliders' boxes, metres.
fn lowest_point(articulation: &Articulation, world: &RapierContextMut) -> f32 {
    let bodies = articulation.bodies().iter().filter_map(|&body| world.rigidbody_set.bodies.get(body));
    let boxes = bodies.flat_map(|body| {
        let colliders = body.colliders().iter().filter_map(|&handle| world.colliders.colliders.get(handle));
        colliders.map(|collider| {
            let within = collider.position_wrt_parent().copied().unwrap_or_default();
            collider.shape().compute_aabb(&(*body.position() * within)).mins.y
        })
    });
    boxes.fold(f32::INFINITY, f32::min)
}

/// Puts characters where the game has set their `Transform`.
pub(super) fn teleport(
    mut characters: Query<(
        Entity,
        &mut Transform,
        &mut BodyPose,
        &mut RapierArticulation,
        &mut PolicyController,
    )>,
    mut bodies: Query<&mut BodyPose, (With<PolicyBody>, With<Transform>, Without<RapierArticulation>)>,
    mut context: WriteRapierContext,
    mut errors: MessageWriter<CharacterError>,
) {
    let Some(mut world) = world_of(&mut context) else { return };
    for (entity, mut transform, mut pose, mut own, mut controller) in &mut characters {
        let Some(written) = pose.written.filter(|written| is_moved(written, &transform)) else { continue };
        let place = match GroundPose::of(&transform) {
            Ok(place) => place,
            Err(problem) => {
                errors.write(problem.of(entity));
                *transform = written;
                continue;
            }
        };
        let own = &mut *own;
        pose.written = Some(*transform);
        own.good = place;
        if let Err(error) = stand(&mut own.articulation, &own.stand, &mut world, place) {
            errors.write(CharacterProblem::Removed { message: error.to_string() }.of(entity));
            own.fault = Some(Fault::Stand);
            continue;
        }
        settle(own, &mut controller, &world, &mut pose, &mut bodies);
    }
}

/// Starts a character anew after its bodies were put elsewhere: what it sensed, and the poses of its entities.
pub(super) fn settle(
    own: &RapierArticulation,
    controller: &mut PolicyController,
    world: &RapierContextMut,
    pose: &mut BodyPose,
    bodies: &mut Query<&mut BodyPose, (With<PolicyBody>, With<Transform>, Without<RapierArticulation>)>,
) {
    let (set, joints) = (&world.rigidbody_set.bodies, &world.joints.multibody_joints);
    let ground = own.good.point.y;
    if own.articulation.sense_into(set, joints, ground, &mut controller.sensed).is_ok() {
        axes::turn_state(&mut controller.sensed);
    }
    controller.restart();
    pose.jump(body::ground_pose(controller));
    for (&entity, at) in own.entities.iter().zip(body::poses(controller)) {
        if let Ok(mut pose) = bodies.get_mut(entity) {
            pose.jump(at);
        }
    }
}
