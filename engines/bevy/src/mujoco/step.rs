//! The fixed step: sense before the controllers, drive after them, step the world, look at the outcome.

use bevy::prelude::*;
use bevy_rapier3d::prelude::{ExternalForce, ExternalImpulse};
use physics_bridge::{Diverging, Movable, Remedy};
use policy_core::BodyId;

use crate::axes;
use crate::body::{BodyPose, PolicyBody};
use crate::character::PolicyController;
use crate::messages::{CharacterError, CharacterProblem};

use super::place::{jump, poses};
use super::{MujocoBody, MujocoWorld};

/// Counts the control ticks of this step, and senses the characters when there are any.
pub(super) fn sense(
    mut commands: Commands,
    mut characters: Query<(Entity, &mut PolicyController, &MujocoBody)>,
    mut own: ResMut<MujocoWorld>,
    time: Res<Time>,
    mut errors: MessageWriter<CharacterError>,
) {
    own.advance(time.delta_secs());
    let Some(world) = &own.world else { return };
    for (entity, mut controller, body) in &mut characters {
        controller.due = own.due;
        if own.due > 0
            && let Err(error) = world.sense_into(body.handle, &mut controller.sensed)
        {
            controller.due = 0;
            errors.write(CharacterProblem::Removed { message: error.to_string() }.of(entity));
            // It comes in again in the next step, where its `Transform` says.
            commands.entity(entity).try_remove::<MujocoBody>();
        }
    }
}

/// Writes joint targets and the forces of the game to MuJoCo.
pub(super) fn actuate(
    characters: Query<(Entity, &PolicyController, &MujocoBody)>,
    mut forces: Query<
        (Option<&ExternalForce>, Option<&mut ExternalImpulse>, &Name),
        (With<PolicyBody>, Or<(With<ExternalForce>, With<ExternalImpulse>)>),
    >,
    mut own: ResMut<MujocoWorld>,
    mut errors: MessageWriter<CharacterError>,
) {
    let (due, period_secs) = (own.due, own.rate.period_secs());
    let Some(world) = own.world.as_mut().filter(|_| due > 0) else { return };
    for (entity, controller, body) in &characters {
        // A stale handle was reported when it was sensed.
        let _ = world.actuate(body.handle, controller.controller.joint_targets());
        for (index, &part) in body.entities.iter().enumerate() {
            let Ok((force, impulse, name)) = forces.get_mut(part) else { continue };
            let target = Movable::Body(body.handle, BodyId::new(index));
            let force = force.map_or(Vec3::ZERO, |force| force.force);
            let mut outcomes = Vec::new();
            if force != Vec3::ZERO {
                let secs = due as f32 * period_secs;
                outcomes.push((force, world.push(target, axes::from_bevy(force), secs)));
            }
            if let Some(mut impulse) = impulse.filter(|impulse| **impulse != ExternalImpulse::default()) {
                let wanted = impulse.impulse;
                outcomes.push((wanted, world.impulse(target, axes::from_bevy(wanted))));
                *impulse = ExternalImpulse::default();
            }
            for (found, outcome) in outcomes {
                if outcome.is_err() {
                    errors.write(CharacterProblem::Force { body: name.to_string(), found }.of(entity));
                }
            }
        }
    }
}

/// Steps the world by the control ticks that are due, and hands the poses to the entities.
pub(super) fn step(
    mut commands: Commands,
    mut characters: Query<(Entity, &mut PolicyController, &mut MujocoBody, &mut BodyPose)>,
    mut bodies: Query<&mut BodyPose, (With<PolicyBody>, Without<MujocoBody>)>,
    mut own: ResMut<MujocoWorld>,
    mut errors: MessageWriter<CharacterError>,
) {
    let (due, fraction) = (own.due, own.rate.fraction());
    let Some(world) = &mut own.world else { return };
    let mut diverged = Vec::new();
    for _ in 0..due {
        world.step();
        diverged.extend_from_slice(world.divergences());
    }
    for (entity, mut controller, mut body, mut pose) in &mut characters {
        let body = &mut *body;
        let mine = diverged.iter().find(|found| found.what == Some(Diverging::Character(body.handle)));
        if let Some(divergence) = mine {
            let message = match divergence.excess {
                Some(excess) => format!("{}: {} of at most {}", divergence.cause, excess.value, excess.limit),
                None => divergence.cause.to_string(),
            };
            errors.write(CharacterProblem::Diverged { message }.of(entity));
            if divergence.remedy == Remedy::TakenOut {
                commands.entity(entity).try_remove::<MujocoBody>();
                continue;
            }
        }
        if due > 0 {
            if world.sense_into(body.handle, &mut controller.sensed).is_err() {
                continue;
            }
            if mine.is_some_and(|divergence| divergence.remedy == Remedy::PutBack) {
                controller.restart();
                jump(body, &controller, &mut pose, &mut bodies);
                continue;
            }
            std::mem::swap(&mut body.before, &mut body.after);
            body.after = poses(&controller);
        }
        let at = |index: usize| between(body.before[index], body.after[index], fraction);
        pose.advance(at(0));
        for (index, &entity) in body.entities.iter().enumerate() {
            if let Ok(mut pose) = bodies.get_mut(entity) {
                pose.advance(at(index + 1));
            }
        }
    }
}

/// A pose between two.
pub(super) fn between(a: Isometry3d, b: Isometry3d, fraction: f32) -> Isometry3d {
    Isometry3d {
        translation: a.translation.lerp(b.translation, fraction),
        rotation: a.rotation.slerp(b.rotation, fraction),
    }
}
