//! Gizmos: skeleton, target, blend and contacts of each character.

use bevy::prelude::*;
use bevy_rapier3d::plugin::context::systemparams::ReadRapierContext;

use crate::body::PolicyBodies;
use crate::character::{CharacterCommand, PolicyController};

/// What is drawn. A game switches it at any time.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default)]
pub struct PolicyGizmos {
    /// Lines from body to body.
    pub skeleton: bool,
    /// Where it goes, and its velocity.
    pub target: bool,
    /// A bar above it for each policy of the blend, as high as its weight.
    pub blend: bool,
    /// Points where it touches something.
    pub contacts: bool,
}

impl PolicyGizmos {
    /// All or nothing.
    #[must_use]
    pub fn all(shown: bool) -> Self {
        Self { skeleton: shown, target: shown, blend: shown, contacts: shown }
    }
}

/// Draws characters' gizmos. Nothing is drawn until the game sets a part of [`PolicyGizmos`].
#[derive(Clone, Copy, Debug, Default)]
pub struct PolicyDebugPlugin;

impl Plugin for PolicyDebugPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PolicyGizmos>().init_resource::<PolicyGizmos>().add_systems(
            Update,
            (
                skeletons.run_if(|shown: Res<PolicyGizmos>| shown.skeleton),
                targets.run_if(|shown: Res<PolicyGizmos>| shown.target),
                blends.run_if(|shown: Res<PolicyGizmos>| shown.blend),
                contacts.run_if(|shown: Res<PolicyGizmos>| shown.contacts),
            ),
        );
        #[cfg(feature = "mujoco")]
        app.add_systems(Update, contacts_in_mujoco.run_if(|shown: Res<PolicyGizmos>| shown.contacts));
    }
}

const BONE: Color = Color::srgb(0.2, 0.9, 1.0);
const GOAL: Color = Color::srgb(1.0, 0.6, 0.1);
const TOUCH: Color = Color::srgb(1.0, 0.1, 0.3);

/// Height of the blend's bars above the ground, and of a whole one, metres.
const BARS_HEIGHT: f32 = 1.9;
const BAR_HEIGHT: f32 = 0.4;

fn skeletons(
    mut gizmos: Gizmos,
    characters: Query<(&PolicyController, &PolicyBodies)>,
    places: Query<&Transform>,
) {
    for (controller, bodies) in &characters {
        let place = |index: usize| Some(places.get(*bodies.entities().get(index)?).ok()?.translation);
        for (index, body) in controller.controller.pack().skeleton().bodies().iter().enumerate() {
            let parent = body.parent.and_then(|parent| place(parent.index()));
            if let (Some(from), Some(to)) = (parent, place(index)) {
                gizmos.line(from, to, BONE);
                gizmos.sphere(to, 0.02, BONE);
            }
        }
    }
}

fn targets(
    mut gizmos: Gizmos,
    characters: Query<(&Transform, &CharacterCommand, &crate::CharacterReport), With<PolicyController>>,
) {
    for (place, command, report) in &characters {
        if let Some(target) = command.target.filter(|target| target.is_finite()) {
            let target = target.with_y(place.translation.y + 0.02);
            gizmos.line(place.translation.with_y(target.y), target, GOAL);
            gizmos.sphere(target, 0.1, GOAL);
        }
        let velocity = report.velocity.with_y(0.0);
        if velocity.length() > 0.1 {
            let from = place.translation + Vec3::Y * 0.05;
            gizmos.arrow(from, from + velocity, Color::WHITE);
        }
    }
}

fn blends(mut gizmos: Gizmos, characters: Query<(&Transform, &PolicyController)>) {
    for (place, controller) in &characters {
        for (slot, term) in controller.controller.report().blend.terms().iter().enumerate() {
            let count = term.weights.len() as f32;
            let weight = term.weights.iter().sum::<f32>() / count;
            let hue = 47.0 * term.policy.index() as f32 % 360.0;
            let from = place.translation + place.right() * (0.1 * slot as f32) + Vec3::Y * BARS_HEIGHT;
            gizmos.line(from, from + Vec3::Y * (BAR_HEIGHT * weight), Color::hsl(hue, 0.9, 0.6));
        }
    }
}

fn contacts(mut gizmos: Gizmos, characters: Query<&PolicyBodies>, context: ReadRapierContext) {
    let Ok(context) = context.single() else { return };
    for &body in characters.iter().flat_map(PolicyBodies::entities) {
        for pair in context.contact_pairs_with(body) {
            for manifold in pair.manifolds() {
                for contact in manifold.solver_contacts() {
                    gizmos.sphere(contact.point(), 0.03, TOUCH);
                }
            }
        }
    }
}

#[cfg(feature = "mujoco")]
fn contacts_in_mujoco(mut gizmos: Gizmos, world: Option<Res<crate::MujocoWorld>>) {
    let Some(world) = world.as_ref().and_then(|own| own.world()) else { return };
    for contact in world.contacts() {
        gizmos.sphere(crate::axes::to_bevy(contact.position), 0.03, TOUCH);
    }
}
