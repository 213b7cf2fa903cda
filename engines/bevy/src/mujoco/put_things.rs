//! Props and fixtures come into the MuJoCo world.

use bevy::prelude::*;
use physics_bridge::{Fixture, FixtureHandle, Motion, Prop, PropHandle, World};

use crate::axes;
use crate::body::BodyPose;

use super::things::{FixtureInWorld, MujocoFixture, MujocoProp, MujocoPropBody, MujocoRefusal, Refused};
use super::{Leaving, MujocoWorld};

/// What comes in.
enum Thing {
    Prop(Prop, Motion),
    Fixture(Fixture),
}

/// What came in.
enum Handle {
    Prop(PropHandle),
    Fixture(FixtureHandle),
}

/// Puts in props and fixtures, all in one edit.
pub(super) fn put_in(
    mut commands: Commands,
    props: Query<(Entity, &MujocoProp, &Transform), (Without<MujocoPropBody>, Without<Refused>)>,
    fixtures: Query<(Entity, &MujocoFixture), (Without<FixtureInWorld>, Without<Refused>)>,
    places: TransformHelper,
    mut own: ResMut<MujocoWorld>,
    mut refusals: MessageWriter<MujocoRefusal>,
) {
    let Some(world) = own.world.as_mut().filter(|_| !props.is_empty() || !fixtures.is_empty()) else {
        return;
    };
    let mut refuse = |commands: &mut Commands, entity: Entity, why: &str| {
        commands.entity(entity).try_insert(Refused);
        let message = format!("it is not in the MuJoCo world: {why}");
        refusals.write(MujocoRefusal { entity, message });
    };
    let (sound, displaced) = props.iter().partition::<Vec<_>, _>(|(entity, _, transform)| {
        // What the plug-in writes later is its place in the world.
        let place = places.compute_global_transform(*entity).map(|place| place.compute_transform());
        place.is_ok_and(|place| is_at(&place, transform))
    });
    for (entity, ..) in displaced {
        refuse(&mut commands, entity, "expected a prop without a parent, or with one at the origin");
    }
    let new_props = sound.into_iter().map(|(entity, wanted, transform)| {
        (entity, Thing::Prop(wanted.prop.clone(), motion(transform, wanted.velocity)))
    });
    let new_fixtures = fixtures.iter().filter_map(|(entity, fixture)| {
        let place = places.compute_global_transform(entity).ok()?.compute_transform();
        Some((entity, Thing::Fixture(placed(fixture, &place))))
    });
    let things: Vec<_> = new_props.chain(new_fixtures).collect();
    let outcomes = add_all(world, &things);
    for ((entity, _), outcome) in things.into_iter().zip(outcomes) {
        match outcome {
            Ok(Handle::Prop(handle)) => {
                let Ok((.., &transform)) = props.get(entity) else { continue };
                let at = transform.to_isometry();
                let mut pose = BodyPose { written: Some(transform), ..BodyPose::default() };
                pose.jump(at);
                let body = (MujocoPropBody::at(handle, at), pose);
                commands.queue(move |world: &mut bevy::prelude::World| {
                    embody(world, entity, body, Leaving::Prop(handle));
                });
            }
            Ok(Handle::Fixture(handle)) => {
                commands.queue(move |world: &mut bevy::prelude::World| {
                    embody(world, entity, FixtureInWorld(handle), Leaving::Fixture(handle));
                });
            }
            Err(message) => refuse(&mut commands, entity, &message),
        }
    }
}

/// Adds things: in one edit, or in one for each when MuJoCo refuses that.
fn add_all(world: &mut World, things: &[(Entity, Thing)]) -> Vec<Result<Handle, String>> {
    let added = world.edit(|edit| {
        let mut add = |(_, thing): &(Entity, Thing)| match thing {
            Thing::Prop(prop, motion) => edit.add_prop(prop.clone(), *motion).map(Handle::Prop),
            Thing::Fixture(fixture) => edit.add_fixture(fixture.clone()).map(Handle::Fixture),
        };
        Ok(things.iter().map(|thing| add(thing).map_err(|error| error.to_string())).collect())
    });
    match added {
        Ok(outcomes) => outcomes,
        Err(error) if things.len() < 2 => things.iter().map(|_| Err(error.to_string())).collect(),
        Err(_) => things.iter().flat_map(|thing| add_all(world, std::slice::from_ref(thing))).collect(),
    }
}

/// Gives an entity what says that it is in the world, or takes it out again when the game has despawned it by now.
fn embody(world: &mut bevy::prelude::World, entity: Entity, body: impl Bundle, leaving: Leaving) {
    match world.get_entity_mut(entity) {
        Ok(mut entity) => {
            entity.insert(body);
        }
        Err(_) => world.resource_mut::<MujocoWorld>().leaving.push(leaving),
    }
}

/// True when two places are the same but for rounding, or when one is not finite, which is refused later.
fn is_at(a: &Transform, b: &Transform) -> bool {
    let finite = a.translation.is_finite() && a.rotation.is_finite();
    !finite || (a.translation.distance(b.translation) < 1e-3 && a.rotation.dot(b.rotation).abs() > 1.0 - 1e-5)
}

/// Where a prop is, in the policies' world.
pub(super) fn motion(transform: &Transform, velocity: Vec3) -> Motion {
    Motion {
        rotation: axes::rotation_from_bevy(transform.rotation),
        ..Motion::at(axes::from_bevy(transform.translation)).moving(axes::from_bevy(velocity))
    }
}

fn placed(fixture: &MujocoFixture, transform: &Transform) -> Fixture {
    Fixture {
        shape: fixture.shape.clone(),
        position: axes::from_bevy(transform.translation),
        rotation: axes::rotation_from_bevy(transform.rotation),
        friction: fixture.friction,
    }
}
