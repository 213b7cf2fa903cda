//! Bodies come into the MuJoCo world with a character and leave with it.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::prelude::*;
use physics_bridge::{Character, CharacterHandle, Model, World, WorldError};
use policy_core::contract::Pose;
use policy_core::glam::Vec2;
use policy_core::{CharacterPack, CharacterState, FixedRate, Heading};

use crate::axes;
use crate::body::{self, BodyPose, PolicyBodies, is_moved};
use crate::character::{PolicyCharacter, PolicyController};
use crate::messages::{CharacterError, CharacterProblem, Reported};

use super::place::poses;
use super::{Described, Leaving, MujocoBody, MujocoWorld};

/// What a body senses with all joints at zero.
pub(super) fn describe(model: Model) -> Described {
    let mut alone = Character::new(&model);
    let zero = Pose::new(model.skeleton());
    alone.set_pose(&zero.qpos, &zero.qvel).expect("a sound pose");
    let mut rest = CharacterState::new(model.skeleton());
    alone.sense_into(&mut rest);
    Described { model, rest }
}

/// A character that is to come in.
struct Arriving {
    character: Entity,
    described: Described,
    point: Vec2,
    heading: Heading,
}

/// What was refused of a character that waits. It is tried again when its pack or its place is another.
pub(super) struct Refused {
    pack: Arc<CharacterPack>,
    place: Transform,
}

/// Puts characters in whose pack is loaded, and takes out what left.
pub(super) fn put_in(
    mut commands: Commands,
    mut waiting: Query<
        (Entity, &mut PolicyController, &Transform),
        (With<PolicyCharacter>, Without<MujocoBody>),
    >,
    mut own: ResMut<MujocoWorld>,
    (mut tried, mut reported): (Local<HashMap<Entity, Refused>>, Local<Reported>),
    mut errors: MessageWriter<CharacterError>,
) {
    reported.keep(|entity| waiting.contains(entity));
    tried.retain(|&entity, refused| {
        let now = waiting.get(entity);
        now.is_ok_and(|(_, controller, place)| {
            Arc::ptr_eq(controller.controller.pack(), &refused.pack) && !is_moved(&refused.place, place)
        })
    });
    let mut arriving = Vec::new();
    let mut refused = Vec::new();
    for (character, controller, transform) in waiting.iter().filter(|(new, ..)| !tried.contains_key(new)) {
        match arrive(&mut own, character, controller, transform) {
            Ok(wanted) => arriving.push(wanted),
            Err(problem) => refused.push((character, problem)),
        }
    }
    let outcomes = exchange_all(&mut own, &arriving);
    for (wanted, outcome) in arriving.into_iter().zip(outcomes) {
        match (outcome, waiting.get_mut(wanted.character)) {
            (Ok(handle), Ok((_, mut controller, transform))) => {
                embody(&mut commands, &own, wanted, handle, &mut controller, transform);
            }
            (Err(message), _) => refused.push((wanted.character, CharacterProblem::Body { message })),
            (Ok(_), Err(_)) => {}
        }
    }
    for (character, problem) in refused {
        reported.write(problem, character, &mut errors);
        let Ok((_, controller, &place)) = waiting.get(character) else { continue };
        tried.insert(character, Refused { pack: Arc::clone(controller.controller.pack()), place });
    }
}

/// Lets characters in, and what left out: in one edit, or in one for each character when MuJoCo refuses that.
fn exchange_all(own: &mut MujocoWorld, arriving: &[Arriving]) -> Vec<Result<CharacterHandle, String>> {
    match exchange(own, arriving) {
        Ok(handles) => handles.into_iter().map(|handle| handle.map_err(|error| error.to_string())).collect(),
        Err(error) if arriving.len() < 2 => arriving.iter().map(|_| Err(error.to_string())).collect(),
        Err(_) => {
            let alone = arriving.iter().flat_map(|wanted| exchange_all(own, std::slice::from_ref(wanted)));
            alone.collect()
        }
    }
}

fn arrive(
    own: &mut MujocoWorld,
    character: Entity,
    controller: &PolicyController,
    transform: &Transform,
) -> Result<Arriving, CharacterProblem> {
    let described = own.described(controller.controller.pack());
    let described = described.map_err(|error| CharacterProblem::Body { message: error.to_string() })?;
    if !transform.translation.is_finite() || !transform.rotation.is_finite() {
        return Err(CharacterProblem::Transform { found: *transform });
    }
    let point = axes::ground_from_bevy(transform.translation);
    let heading = axes::heading_from_bevy(transform.rotation);
    Ok(Arriving { character, described, point, heading })
}

/// Lets characters in, and what left out, in one edit.
fn exchange(
    own: &mut MujocoWorld,
    arriving: &[Arriving],
) -> Result<Vec<Result<CharacterHandle, WorldError>>, WorldError> {
    if arriving.is_empty() && own.leaving.is_empty() {
        return Ok(Vec::new());
    }
    let is_new = own.world.is_none();
    if let (None, Some(first)) = (&own.world, arriving.first()) {
        let ground = first.described.model.with_terrain(own.terrain)?;
        own.rate = FixedRate::new(ground.control_hz());
        own.world = Some(World::new(&ground)?);
    }
    let Some(world) = &mut own.world else { return Ok(Vec::new()) };
    let leaving = std::mem::take(&mut own.leaving);
    let result = world.edit(|edit| {
        for &thing in &leaving {
            // The game may have removed it there itself.
            let _ = match thing {
                Leaving::Character(handle) => edit.remove_character(handle),
                Leaving::Prop(handle) => edit.remove_prop(handle),
                Leaving::Fixture(handle) => edit.remove_fixture(handle),
            };
        }
        let add = |wanted: &Arriving| {
            let (model, point) = (&wanted.described.model, wanted.point);
            edit.add_character(model, point.x, point.y, wanted.heading, 0.0)
        };
        Ok(arriving.iter().map(add).collect())
    });
    if result.is_err() {
        own.leaving = leaving;
        if is_new {
            own.world = None;
        }
    }
    result
}

/// Gives a character that is in the world its entities.
fn embody(
    commands: &mut Commands,
    own: &MujocoWorld,
    wanted: Arriving,
    handle: CharacterHandle,
    controller: &mut PolicyController,
    transform: &Transform,
) {
    (controller.rest, controller.embodied) = (wanted.described.rest, true);
    let Some(world) = &own.world else { return };
    world.sense_into(handle, &mut controller.sensed).expect("a character just added");
    let skeleton = wanted.described.model.skeleton();
    let names = skeleton.bodies().iter().enumerate();
    let entities: Vec<Entity> =
        names.map(|(index, part)| body::spawn_body(commands, wanted.character, index, &part.name)).collect();
    let at = poses(controller);
    for (&entity, &at) in entities.iter().zip(&at[1..]) {
        let mut pose = BodyPose::default();
        pose.jump(at);
        commands.entity(entity).try_insert(pose);
    }
    let mut pose = BodyPose { written: Some(*transform), ..BodyPose::default() };
    pose.jump(at[0]);
    let pack = Arc::clone(controller.controller.pack());
    let body = MujocoBody { handle, pack, entities, before: at.clone(), after: at };
    let character = wanted.character;
    commands.queue(move |world: &mut bevy::prelude::World| {
        if let Ok(mut character) = world.get_entity_mut(character) {
            character.insert((body, pose));
            return;
        }
        // The game has despawned it by now.
        for entity in body.entities {
            world.try_despawn(entity).ok();
        }
        world.resource_mut::<MujocoWorld>().leaving.push(Leaving::Character(body.handle));
    });
}

/// Takes the body out of the world when its character is despawned or loses it.
pub(super) fn take_out(
    removed: On<Remove<MujocoBody>>,
    bodies: Query<&MujocoBody>,
    mut own: ResMut<MujocoWorld>,
    mut commands: Commands,
) {
    let character = removed.entity;
    if let Ok(body) = bodies.get(character) {
        own.leaving.push(Leaving::Character(body.handle));
    }
    commands.queue(move |world: &mut bevy::prelude::World| {
        // A character that is despawned takes its bodies along.
        if let Ok(mut character) = world.get_entity_mut(character) {
            character.despawn_related::<PolicyBodies>();
        }
    });
}

/// Takes everything away that came with `PolicyCharacter`, when the game removes that alone.
pub(super) fn forget(removed: On<Remove<PolicyCharacter>>, mut commands: Commands) {
    let character = removed.entity;
    commands.queue(move |world: &mut bevy::prelude::World| {
        if let Ok(mut character) = world.get_entity_mut(character) {
            character.remove::<(MujocoBody, PolicyController, BodyPose)>();
        }
    });
}

/// Gives a character the body of its new pack, in the pose that it has.
pub(super) fn reload(
    mut characters: Query<(Entity, &mut PolicyController, &mut MujocoBody), With<PolicyCharacter>>,
    mut own: ResMut<MujocoWorld>,
    mut errors: MessageWriter<CharacterError>,
) {
    for (entity, mut controller, mut body) in &mut characters {
        let pack = controller.controller.pack();
        if Arc::ptr_eq(pack, &body.pack) {
            continue;
        }
        let same_body = pack.mjcf() == body.pack.mjcf() && pack.control_hz() == body.pack.control_hz();
        body.pack = Arc::clone(pack);
        if same_body {
            continue;
        }
        match replace(&mut own, &mut body, pack) {
            Ok(rest) => controller.rest = rest,
            Err(message) => {
                errors.write(CharacterProblem::Body { message }.of(entity));
            }
        }
    }
}

/// Puts the body of another pack in the place of a character's. Returns what that senses with all joints at zero.
fn replace(
    own: &mut MujocoWorld,
    body: &mut MujocoBody,
    pack: &Arc<CharacterPack>,
) -> Result<CharacterState, String> {
    let Described { model, rest } = own.described(pack).map_err(|error| error.to_string())?;
    let world = own.world.as_mut().ok_or("the world is gone")?;
    let mut kept = Pose::new(model.skeleton());
    world.pose_into(body.handle, &mut kept).map_err(|error| error.to_string())?;
    let (x, y) = (kept.qpos[0] as f32, kept.qpos[1] as f32);
    let exchanged = world.edit(|edit| {
        edit.remove_character(body.handle)?;
        edit.add_character(&model, x, y, Heading::FORWARD, 0.0)
    });
    body.handle = exchanged.map_err(|error| error.to_string())?;
    world.set_pose(body.handle, &kept.qpos, &kept.qvel).map_err(|error| error.to_string())?;
    Ok(rest)
}
