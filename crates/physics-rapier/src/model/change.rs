//! Models that differ in their ground or their settings.

use std::sync::Arc;

use policy_core::contract::{HeightField, SettingError, Settings};
use rapier3d::dynamics::MassProperties;
use rapier3d::geometry::{Collider, ColliderSet};
use rapier3d::math::Vector;
use rapier3d_mjcf::MjcfRobot;

use super::{Model, Variant};
use crate::world::of_heights;

/// How far planes lie below a height field, metres, as in physics-bridge: far enough that nothing touches both.
const PLANE_DROP_M: f32 = 0.1;

impl Model {
    /// The same character on uneven ground, with its present settings; on the ground of the MJCF for `None`. The planes of the
    /// MJCF lie 0.1 m below a height field. The ground is that of a [`Character`](crate::Character); a game brings its own. Allocates.
    #[must_use]
    pub fn with_ground(&self, field: Option<&HeightField>) -> Self {
        let mut ground = self.shared.ground.clone();
        if let Some(field) = field {
            for plane in &mut ground {
                let below = plane.translation() - Vector::new(0.0, 0.0, PLANE_DROP_M);
                plane.set_translation(below);
            }
            let friction = ground.first().map_or(1.0, Collider::friction);
            let shape = of_heights([field.rows(), field.columns()], field.half_extent(), field.heights());
            ground.push(shape.friction(friction).build());
        }
        let variant = Variant { ground, field: field.cloned(), ..Variant::clone(&self.variant) };
        Self { shared: Arc::clone(&self.shared), variant: Arc::new(variant) }
    }

    /// The same character on the same ground, with these settings in place of the present ones. Gravity and the friction
    /// of the ground are those of a [`Character`](crate::Character)'s own world; a game has its own. Allocates.
    ///
    /// # Errors
    /// When a setting is out of its range.
    pub fn with_settings(&self, settings: Settings) -> Result<Self, SettingError> {
        settings.check()?;
        let mut robot = self.shared.robot.clone();
        scale_mass(&mut robot, settings.mass);
        let colliders = robot.bodies.iter_mut().flat_map(|body| &mut body.colliders);
        colliders.for_each(|collider| scale_friction(collider, settings.friction));
        let mut motors = self.shared.motors.clone();
        for motor in &mut motors {
            motor.gain *= settings.strength;
            motor.force_limit *= settings.strength;
        }
        let variant = Variant { settings, robot, motors, ..Variant::clone(&self.variant) };
        Ok(Self { shared: Arc::clone(&self.shared), variant: Arc::new(variant) })
    }

    /// The ground of a character alone in its world, with the friction of the settings.
    pub(crate) fn ground(&self) -> impl Iterator<Item = Collider> + '_ {
        self.variant.ground.iter().cloned().map(|mut collider| {
            scale_friction(&mut collider, self.variant.settings.friction);
            collider
        })
    }
}

fn scale_friction(collider: &mut Collider, factor: f32) {
    collider.set_friction(factor * collider.friction());
}

/// Multiplies masses and inertias. The loader puts them beside the colliders, which have none.
fn scale_mass(robot: &mut MjcfRobot, factor: f32) {
    for entry in &mut robot.bodies {
        let mut body = entry.body.clone();
        body.recompute_mass_properties_from_colliders(&ColliderSet::new());
        let mass = body.mass_properties().local_mprops;
        if factor == 1.0 || mass.mass() == 0.0 {
            continue;
        }
        let scaled = MassProperties::with_principal_inertia_frame(
            mass.local_com,
            factor * mass.mass(),
            factor * mass.principal_inertia(),
            mass.principal_inertia_local_frame,
        );
        entry.body.set_additional_mass_properties(scaled, false);
        entry.mass *= factor;
    }
}
