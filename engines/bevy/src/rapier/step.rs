//! The fixed step: sense before the controllers, drive after them, look at the outcome after Rapier.

use bevy::prelude::*;
use bevy_rapier3d::plugin::context::systemparams::WriteRapierContext;
use bevy_rapier3d::prelude::{ExternalForce, ExternalImpulse};
use bevy_rapier3d::rapier::dynamics::RigidBodySet;
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, ColliderSet, InteractionGroups, Ray};
use bevy_rapier3d::rapier::pipeline::QueryFilter;
use physics_rapier::{Articulation, Cause, Diverged};

use crate::axes;
use crate::body::{self, BodyPose, PolicyBody};
use crate::character::{CharacterReport, PolicyController};
use crate::messages::{CharacterError, CharacterProblem};

use super::place::GroundPose;
use super::{Fault, RapierArticulation, world_of};

/// How far below a character its ground may be, metres.
const GROUND_RANGE: f32 = 200.0;

/// Senses the characters whose control tick is due, and the ground below them.
pub(super) fn sense(
    mut characters: Query<(Entity, &CharacterReport, &mut PolicyController, &mut RapierArticulation)>,
    parts: Query<(), With<PolicyBody>>,
    mut context: WriteRapierContext,
    mut errors: MessageWriter<CharacterError>,
) {
    let Some(world) = world_of(&mut context) else { return };
    let (set, joints) = (&world.rigidbody_set.bodies, &world.joints.multibody_joints);
    // A character stands on what is fixed or kinematic, and on what moves where it is no higher than a step: a board, not a crate that it
    // kicks, nor another character.
    // The body tells: a game may have hung colliders of its own on it.
    let is_prop = |_: ColliderHandle, collider: &Collider| {
        let body = collider.parent().and_then(|parent| set.get(parent));
        let entity = body.and_then(|body| Entity::try_from_bits(body.user_data as u64));
        entity.is_none_or(|entity| !parts.contains(entity))
    };
    let colliders = &world.colliders.colliders;
    let rays_through = |filter| {
        let dispatcher = world.simulation.narrow_phase.query_dispatcher();
        world.simulation.broad_phase.as_query_pipeline(dispatcher, set, colliders, filter)
    };
    for (entity, report, mut controller, mut own) in &mut characters {
        if controller.due == 0 || own.fault.is_some() {
            continue;
        }
        let controller = &mut *controller;
        // What its colliders pass through is no ground to it.
        let groups = groups_of(&own.articulation, set, colliders);
        let loose =
            rays_through(QueryFilter::only_dynamic().exclude_sensors().groups(groups).predicate(&is_prop));
        let query = rays_through(QueryFilter::exclude_dynamic().exclude_sensors().groups(groups));
        let mut ground = controller.sensed.ground_height;
        if let Some(root) = set.get(own.articulation.bodies()[0]) {
            let ray = Ray::new(root.translation(), Vec3::NEG_Y);
            if let Some((_, distance)) = query.cast_ray(&ray, GROUND_RANGE, true) {
                ground = root.translation().y - distance;
                if !report.fallen {
                    let at = Transform::from_isometry(body::ground_pose(controller));
                    own.good = GroundPose::of(&at).unwrap_or(own.good);
                }
            }
        }
        match own.articulation.sense_into(set, joints, ground, &mut controller.sensed) {
            Ok(()) => {
                axes::turn_state(&mut controller.sensed);
                let skeleton = own.articulation.model().skeleton();
                let root = controller.sensed.root().position;
                let top = controller.sensed.step_top(skeleton);
                let ray = |at: Vec2, from: f32| Ray::new(axes::to_bevy(at.extend(from)), Vec3::NEG_Y);
                let stepped_onto = |at: Vec2, ground: f32| {
                    let met = loose.intersect_ray(ray(at, top), GROUND_RANGE, true);
                    // A ray that begins inside of something meets it at once: that one is higher.
                    let distances =
                        met.map(|(.., hit)| hit.time_of_impact).filter(|distance| *distance > 0.0);
                    distances.fold(ground, |height, distance| height.max(top - distance))
                };
                let level = stepped_onto(root.truncate(), ground);
                let below = |at: Vec2| {
                    let met = query.cast_ray(&ray(at, root.z), GROUND_RANGE, true);
                    stepped_onto(at, met.map_or(ground, |(_, distance)| root.z - distance))
                };
                controller.sensed.set_ground(skeleton, level, |_, at| below(at));
            }
            Err(removed) => {
                own.fault = Some(Fault::Stand);
                errors.write(CharacterProblem::Removed { message: removed.to_string() }.of(entity));
            }
        }
    }
}

/// The collision groups that a character was built with.
fn groups_of(articulation: &Articulation, set: &RigidBodySet, colliders: &ColliderSet) -> InteractionGroups {
    let bodies = articulation.bodies().iter().filter_map(|&body| set.get(body));
    let mut own = bodies.flat_map(|body| body.colliders()).filter_map(|&collider| colliders.get(collider));
    own.next().map_or(InteractionGroups::all(), |collider| collider.collision_groups())
}

/// Writes joint targets and the forces of the game to Rapier.
pub(super) fn actuate(
    mut characters: Query<(Entity, &PolicyController, &mut RapierArticulation)>,
    mut forces: Query<
        (Option<&ExternalForce>, Option<&mut ExternalImpulse>, &Name),
        (With<PolicyBody>, Or<(With<ExternalForce>, With<ExternalImpulse>)>),
    >,
    mut context: WriteRapierContext,
    time: Res<Time>,
    mut errors: MessageWriter<CharacterError>,
) {
    let Some(mut world) = world_of(&mut context) else { return };
    let (set, joints) = (&mut world.rigidbody_set.bodies, &mut world.joints.multibody_joints);
    for (entity, controller, mut own) in &mut characters {
        if own.fault.is_some() {
            continue;
        }
        let own = &mut *own;
        if controller.due > 0 {
            own.articulation.actuate(controller.controller.joint_targets());
        }
        if let Err(removed) = own.articulation.before_step(set, joints) {
            own.fault = Some(Fault::Stand);
            errors.write(CharacterProblem::Removed { message: removed.to_string() }.of(entity));
            continue;
        }
        for (&handle, &body) in own.articulation.bodies().iter().zip(&own.entities) {
            let Ok((force, impulse, name)) = forces.get_mut(body) else { continue };
            let (mut linear, mut angular) = force.map_or((Vec3::ZERO, Vec3::ZERO), |f| (f.force, f.torque));
            // Rapier loses impulses on links of a multibody.
            if let Some(mut impulse) = impulse.filter(|impulse| **impulse != ExternalImpulse::default()) {
                linear += impulse.impulse / time.delta_secs();
                angular += impulse.torque_impulse / time.delta_secs();
                *impulse = ExternalImpulse::default();
            }
            if !linear.is_finite() || !angular.is_finite() {
                let found = if linear.is_finite() { angular } else { linear };
                errors.write(CharacterProblem::Force { body: name.to_string(), found }.of(entity));
            } else if let Some(body) = set.get_mut(handle) {
                body.add_force(linear, true);
                body.add_torque(angular, true);
            }
        }
    }
}

/// How far below the ground under its root a part of a character may hang, metres: over the edge of a platform, say.
const HANGS_M: f32 = 3.0;

/// True for a body that hangs over an edge.
fn hangs(diverged: &Diverged) -> bool {
    diverged.cause == Cause::BelowGround && diverged.found < HANGS_M
}

/// Looks at what Rapier did: catches divergence, and hands the poses to the entities.
pub(super) fn mirror(
    mut characters: Query<(Entity, &mut PolicyController, &mut RapierArticulation, &mut BodyPose)>,
    mut bodies: Query<&mut BodyPose, (With<PolicyBody>, Without<RapierArticulation>)>,
    mut context: WriteRapierContext,
    mut errors: MessageWriter<CharacterError>,
) {
    let Some(world) = world_of(&mut context) else { return };
    let (set, joints) = (&world.rigidbody_set.bodies, &world.joints.multibody_joints);
    for (entity, mut controller, mut own, mut pose) in &mut characters {
        if own.fault.is_some() {
            continue;
        }
        let controller = &mut *controller;
        let ground = controller.sensed.ground_height;
        let sensed = own.articulation.sense_into(set, joints, ground, &mut controller.sensed);
        axes::turn_state(&mut controller.sensed);
        let problem = match sensed {
            Err(removed) => Some(CharacterProblem::Removed { message: removed.to_string() }),
            Ok(()) => {
                let skeleton = own.articulation.model().skeleton();
                let disabled = own.articulation.bodies().iter().any(|&body| !set[body].is_enabled());
                match Diverged::check(skeleton, &controller.sensed, 0) {
                    Err(diverged) if !hangs(&diverged) => Some(diverged.to_string()),
                    _ => disabled.then(|| "Rapier disabled a body that was not finite".into()),
                }
                .map(|message| CharacterProblem::Diverged { message })
            }
        };
        if let Some(problem) = problem {
            own.fault = Some(Fault::Stand);
            errors.write(problem.of(entity));
            continue;
        }
        pose.advance(body::ground_pose(controller));
        for (&entity, at) in own.entities.iter().zip(body::poses(controller)) {
            if let Ok(mut pose) = bodies.get_mut(entity) {
                pose.advance(at);
            }
        }
    }
}
