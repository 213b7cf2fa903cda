//! The bodies of a character as entities: where they are, and between the fixed steps too.

use bevy::prelude::*;

use crate::axes;
use crate::character::PolicyController;
use policy_core::Heading;

/// An entity for each body of a character. It has the body's name, its `Transform` in world space, and the collider in
/// the events and queries of the physics.
///
/// The plug-in writes its `Transform`. Forces are given as components of the physics, such as `ExternalForce`.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component)]
#[relationship(relationship_target = PolicyBodies)]
#[require(Transform, BodyPose)]
#[cfg_attr(feature = "render", require(Visibility))]
pub struct PolicyBody {
    /// The character.
    #[relationship]
    pub character: Entity,
    /// Index of the body in the skeleton.
    pub index: usize,
}

/// The bodies of a character, in the order of the skeleton. They are despawned with it.
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default)]
#[relationship_target(relationship = PolicyBody, linked_spawn)]
pub struct PolicyBodies(Vec<Entity>);

impl PolicyBodies {
    /// The entities.
    #[must_use]
    pub fn entities(&self) -> &[Entity] {
        &self.0
    }
}

/// An entity for a body.
pub(crate) fn spawn_body(commands: &mut Commands, character: Entity, index: usize, name: &str) -> Entity {
    commands.spawn((PolicyBody { character, index }, Name::new(name.to_owned()))).id()
}

/// Brings the bodies of a character into the order of the skeleton, after one was spawned late.
pub(crate) fn sort_bodies(commands: &mut Commands, character: Entity) {
    commands.queue(move |world: &mut World| {
        let Some(mut bodies) = world.get_mut::<PolicyBodies>(character) else { return };
        let mut sorted = std::mem::take(&mut bodies.0);
        sorted.sort_by_key(|&entity| world.get::<PolicyBody>(entity).map(|body| body.index));
        if let Some(mut bodies) = world.get_mut::<PolicyBodies>(character) {
            bodies.0 = sorted;
        }
    });
}

/// Where a body, or the character itself, was at the last two fixed steps. Bevy's world.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default)]
pub struct BodyPose {
    /// At the step before the last one.
    pub previous: Isometry3d,
    /// At the last one.
    pub current: Isometry3d,
    /// False before the first step.
    pub is_set: bool,
    /// What was written to the `Transform`.
    pub(crate) written: Option<Transform>,
}

impl BodyPose {
    /// Takes the pose of a fixed step.
    pub(crate) fn advance(&mut self, pose: Isometry3d) {
        self.previous = if self.is_set { self.current } else { pose };
        (self.current, self.is_set) = (pose, true);
    }

    /// Takes a pose that has nothing to do with the one before.
    pub(crate) fn jump(&mut self, pose: Isometry3d) {
        (self.previous, self.current, self.is_set) = (pose, pose, true);
    }

    fn at(&self, fraction: f32) -> Isometry3d {
        let (a, b) = (self.previous, self.current);
        Isometry3d {
            translation: a.translation.lerp(b.translation, fraction),
            rotation: a.rotation.slerp(b.rotation, fraction),
        }
    }
}

/// True when the game has put something elsewhere. Another scale alone does not count.
pub(crate) fn is_moved(written: &Transform, now: &Transform) -> bool {
    written.translation != now.translation || written.rotation != now.rotation
}

/// Writes the `Transform` of characters and bodies, between the last two fixed steps.
pub(crate) fn interpolate(
    time: Res<Time<Fixed>>,
    mut bodies: Query<(&mut Transform, &mut BodyPose, Has<PolicyBody>)>,
) {
    let fraction = time.overstep_fraction().clamp(0.0, 1.0);
    for (mut transform, mut pose, is_body) in &mut bodies {
        // A character that the game has just put elsewhere is left alone until the next fixed step takes note.
        let moved_by_game = !is_body && pose.written.is_some_and(|written| is_moved(&written, &transform));
        if !pose.is_set || moved_by_game {
            continue;
        }
        let at = pose.at(fraction);
        let written =
            Transform { translation: at.translation.into(), rotation: at.rotation, scale: transform.scale };
        if *transform != written {
            *transform = written;
        }
        pose.written = Some(written);
    }
}

/// Pose of each body, Bevy's world.
pub(crate) fn poses(controller: &PolicyController) -> impl Iterator<Item = Isometry3d> + '_ {
    controller.sensed.bodies.iter().map(|body| {
        Isometry3d::new(axes::to_bevy(body.position), axes::rotation_to_bevy(body.rotation).normalize())
    })
}

/// The point on the ground below a character, and where it faces.
pub(crate) fn ground_pose(controller: &PolicyController) -> Isometry3d {
    let root = controller.sensed.root();
    let point = root.position.truncate().extend(controller.sensed.ground_height);
    let heading = Heading::from_rotation(root.rotation);
    Isometry3d::new(axes::to_bevy(point), axes::heading_to_bevy(heading))
}
