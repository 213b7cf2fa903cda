//! Props and fixtures of the MuJoCo world as components.

use bevy::prelude::*;
use physics_bridge::{FixtureHandle, FixtureShape, Prop, PropHandle, Solid};

use crate::axes;
use crate::body::{BodyPose, is_moved};

use super::put_things::motion;
use super::step::between;
use super::{Leaving, MujocoWorld};

/// Something that moves in the MuJoCo world: a crate, a ball. Its `Transform` is written by the plug-in; writing another one
/// puts it there, at rest. It comes in with the world, which the first character makes.
///
/// The axes of its shape are physics-bridge's: capsules and cylinders lie along z. Its size is that of the shape, whatever
/// the scale of its `Transform`. It must have no parent. Changing the component of a prop that is in the world has no
/// effect.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque)]
#[reflect(Component)]
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

/// Something that never moves in the MuJoCo world: a ramp, a wall. It is where its `Transform`, with those of its parents,
/// is when it comes in. Its size is that of the shape, whatever the scale.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque)]
#[reflect(Component)]
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
    /// A prop that has just come in.
    pub(super) fn at(handle: PropHandle, at: Isometry3d) -> Self {
        Self { handle, before: at, after: at }
    }

    /// Names the prop in [`MujocoWorld::world`].
    #[must_use]
    pub fn handle(&self) -> PropHandle {
        self.handle
    }
}

/// A fixture that is in the world.
#[derive(Component)]
pub(super) struct FixtureInWorld(pub FixtureHandle);

/// MuJoCo refuses a prop, a fixture or a place for a prop, or a prop was taken out. An entity that is not in the world
/// stays without a body until its component is inserted anew. All are logged.
#[derive(Message, Clone, Debug, thiserror::Error)]
#[error("prop or fixture {entity}: {message}")]
pub struct MujocoRefusal {
    /// The prop or fixture.
    pub entity: Entity,
    /// What became of it, and why.
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
        let Some(written) = pose.written.filter(|written| is_moved(written, &transform)) else { continue };
        if let Err(error) = world.place_prop(body.handle, motion(&transform, Vec3::ZERO)) {
            let message = format!("it stays where it was: {error}");
            refusals.write(MujocoRefusal { entity, message });
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
        commands.entity(entity).try_remove::<Refused>();
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
                    let message = format!("it was taken out of the MuJoCo world: {error}");
                    refusals.write(MujocoRefusal { entity, message });
                    commands.entity(entity).try_remove::<MujocoPropBody>().try_insert(Refused);
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
