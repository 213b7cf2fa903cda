//! Props and fixtures of the MuJoCo world as components.

use bevy::prelude::*;
use physics_bridge::{Fixture, FixtureHandle, FixtureShape, Motion, Prop, PropHandle, Solid};

use crate::axes;
use crate::body::BodyPose;

use super::step::between;
use super::{Leaving, MujocoWorld};

/// Something that moves in the MuJoCo world: a crate, a ball. Its `Transform` is written by the plug-in; writing another one
/// puts it there, at rest. It comes in with the world, which the first character makes.
///
/// The axes of its shape are physics-bridge's: capsules and cylinders lie along z. Changing the component of a prop that is
/// in the world has no effect.
#[derive(Component, Clone, Debug)]
#[require(Transform, BodyPose)]
pub struct MujocoProp {
    /// Shape, mass, friction.
    pub prop: Prop,
    /// Metres per second at first, Bevy's world.
    pub velocity: Vec3,
}

impl MujocoProp {
    /// At rest at first.
    #[must_use]
    pub fn new(prop: Prop) -> Self {
        Self { prop, velocity: Vec3::ZERO }
    }

    /// Thrown, metres per second, Bevy's world.
    #[must_use]
    pub fn thrown(prop: Prop, velocity: Vec3) -> Self {
        Self { prop, velocity }
    }
}

/// Something that never moves in the MuJoCo world: a ramp, a wall. It is where its `Transform` is when it comes in.
#[derive(Component, Clone, Debug)]
#[require(Transform)]
pub struct MujocoFixture {
    /// Its shape, in physics-bridge's axes.
    pub shape: FixtureShape,
    /// Sliding friction.
    pub friction: f32,
}

impl MujocoFixture {
    /// A convex fixture with friction 1.
    #[must_use]
    pub fn new(solid: Solid) -> Self {
        Self { shape: FixtureShape::Solid(solid), friction: 1.0 }
    }
}

/// A prop that is in the world. The plug-in adds it.
#[derive(Component, Clone, Copy, Debug)]
pub struct MujocoPropBody {
    handle: PropHandle,
    /// Where it was at the last two control ticks, Bevy's world.
    before: Isometry3d,
    after: Isometry3d,
}

impl MujocoPropBody {
    /// Names the prop in [`MujocoWorld::world`].
    #[must_use]
    pub fn handle(&self) -> PropHandle {
        self.handle
    }
}

/// A fixture that is in the world.
#[derive(Component)]
pub(super) struct FixtureInWorld(FixtureHandle);

/// MuJoCo refuses a prop or a fixture, or has taken a prop out. The entity stays, without a body, until its component is
/// inserted anew. All are logged.
#[derive(Message, Clone, Debug, thiserror::Error)]
#[error("{entity} is not in the MuJoCo world: {message}")]
pub struct MujocoRefusal {
    /// The prop or fixture.
    pub entity: Entity,
    /// Why.
    pub message: String,
}

/// On things that are not tried again.
#[derive(Component)]
pub(super) struct Refused;

/// Puts props where the game has set their `Transform`, at rest.
pub(super) fn teleport(
    mut props: Query<(Entity, &mut MujocoPropBody, &mut BodyPose, &mut Transform), With<MujocoProp>>,
    mut own: ResMut<MujocoWorld>,
    mut refusals: MessageWriter<MujocoRefusal>,
) {
    let Some(world) = &mut own.world else { return };
    for (entity, mut body, mut pose, mut transform) in &mut props {
        let Some(written) = pose.written.filter(|written| *written != *transform) else { continue };
        if let Err(error) = world.place_prop(body.handle, motion(&transform, Vec3::ZERO)) {
            refusals.write(MujocoRefusal { entity, message: error.to_string() });
            *transform = written;
            continue;
        }
        pose.written = Some(*transform);
        let at = transform.to_isometry();
        (body.before, body.after) = (at, at);
        pose.jump(at);
    }
}

/// Tries things again whose component the game has inserted anew.
pub(super) fn try_again(
    mut commands: Commands,
    changed: Query<Entity, (With<Refused>, Or<(Changed<MujocoProp>, Changed<MujocoFixture>)>)>,
) {
    for entity in &changed {
        commands.entity(entity).remove::<Refused>();
    }
}

/// Puts in props and fixtures, all in one edit.
pub(super) fn put_in(
    mut commands: Commands,
    props: Query<(Entity, &MujocoProp, &Transform), (Without<MujocoPropBody>, Without<Refused>)>,
    fixtures: Query<(Entity, &MujocoFixture, &Transform), (Without<FixtureInWorld>, Without<Refused>)>,
    mut own: ResMut<MujocoWorld>,
    mut refusals: MessageWriter<MujocoRefusal>,
) {
    let Some(world) = own.world.as_mut().filter(|_| !props.is_empty() || !fixtures.is_empty()) else {
        return;
    };
    let mut refuse = |commands: &mut Commands, entity: Entity, message: String| {
        commands.entity(entity).insert(Refused);
        refusals.write(MujocoRefusal { entity, message });
    };
    let added = world.edit(|edit| {
        let mut add_prop = |(entity, wanted, transform): (Entity, &MujocoProp, &Transform)| {
            (entity, *transform, edit.add_prop(wanted.prop.clone(), motion(transform, wanted.velocity)))
        };
        let props: Vec<_> = props.iter().map(&mut add_prop).collect();
        let mut add_fixture = |(entity, fixture, transform): (Entity, &MujocoFixture, &Transform)| {
            (entity, edit.add_fixture(placed(fixture, transform)))
        };
        Ok((props, fixtures.iter().map(&mut add_fixture).collect::<Vec<_>>()))
    });
    let (new_props, new_fixtures) = match added {
        Ok(added) => added,
        Err(error) => {
            let things = props.iter().map(|new| new.0).chain(fixtures.iter().map(|new| new.0));
            things.for_each(|entity| refuse(&mut commands, entity, error.to_string()));
            return;
        }
    };
    for (entity, transform, handle) in new_props {
        match handle {
            Ok(handle) => {
                let at = transform.to_isometry();
                let mut pose = BodyPose { written: Some(transform), ..BodyPose::default() };
                pose.jump(at);
                commands.entity(entity).insert((MujocoPropBody { handle, before: at, after: at }, pose));
            }
            Err(error) => refuse(&mut commands, entity, error.to_string()),
        }
    }
    for (entity, handle) in new_fixtures {
        match handle {
            Ok(handle) => {
                commands.entity(entity).insert(FixtureInWorld(handle));
            }
            Err(error) => refuse(&mut commands, entity, error.to_string()),
        }
    }
}

/// Where a prop is, in the policies' world.
fn motion(transform: &Transform, velocity: Vec3) -> Motion {
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

/// Hands the poses of props to their entities. A prop that MuJoCo has taken out is reported.
pub(super) fn mirror(
    mut commands: Commands,
    mut props: Query<(Entity, &mut MujocoPropBody, &mut BodyPose)>,
    own: Res<MujocoWorld>,
    mut refusals: MessageWriter<MujocoRefusal>,
) {
    let Some(world) = &own.world else { return };
    for (entity, mut body, mut pose) in &mut props {
        if own.due > 0 {
            let motion = match world.motion(body.handle) {
                Ok(motion) => motion,
                Err(error) => {
                    refusals.write(MujocoRefusal { entity, message: error.to_string() });
                    commands.entity(entity).remove::<MujocoPropBody>().insert(Refused);
                    continue;
                }
            };
            body.before = body.after;
            body.after = Isometry3d::new(
                axes::to_bevy(motion.position),
                axes::rotation_to_bevy(motion.rotation).normalize(),
            );
        }
        pose.advance(between(body.before, body.after, own.rate.fraction()));
    }
}

pub(super) fn take_out_prop(
    removed: On<Remove<MujocoPropBody>>,
    bodies: Query<&MujocoPropBody>,
    mut own: ResMut<MujocoWorld>,
) {
    if let Ok(body) = bodies.get(removed.entity) {
        own.leaving.push(Leaving::Prop(body.handle));
    }
}

pub(super) fn take_out_fixture(
    removed: On<Remove<FixtureInWorld>>,
    bodies: Query<&FixtureInWorld>,
    mut own: ResMut<MujocoWorld>,
) {
    if let Ok(body) = bodies.get(removed.entity) {
        own.leaving.push(Leaving::Fixture(body.0));
    }
}

/// A prop leaves when the game removes its component alone.
pub(super) fn forget_prop(removed: On<Remove<MujocoProp>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<(MujocoPropBody, Refused)>();
}

pub(super) fn forget_fixture(removed: On<Remove<MujocoFixture>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<(FixtureInWorld, Refused)>();
}

pub(super) fn log_refusals(mut refusals: MessageReader<MujocoRefusal>) {
    for refusal in refusals.read() {
        log::warn!("{refusal}");
    }
}
