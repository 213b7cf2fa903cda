//! Things that move in a world. Every number has a range.

use glam::{Quat, Vec3};

use super::description_error::{DescriptionError, within};
use super::solid::{Solid, check_place};
use super::{MAX_SPEED_MPS, MAX_SPIN_RADPS};

/// Range of the mass of a prop, kilograms.
pub const MASS_RANGE_KG: [f32; 2] = [0.01, 10_000.0];

/// Range of a friction coefficient.
pub const FRICTION_RANGE: [f32; 2] = [0.0, 5.0];

/// Something that moves: a crate, a ball, a door.
#[derive(Clone, Debug, PartialEq)]
pub struct Prop {
    /// Its shape. The origin of its frame is that of the shape.
    pub solid: Solid,
    /// Kilograms, in [`MASS_RANGE_KG`].
    pub mass_kg: f32,
    /// Sliding friction, in [`FRICTION_RANGE`]. The greater of two that touch counts.
    pub friction: f32,
    /// Share of the speed that is left after a fall on hard ground, in [0, 0.95]. A prop that bounces sets friction
    /// alone where it touches.
    pub bounce: f32,
}

/// Where something is, how it is turned, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Metres, world space, at most [`MAX_DISTANCE_M`](super::MAX_DISTANCE_M) from the origin.
    pub position: Vec3,
    /// `world_from_prop`, a unit quaternion.
    pub rotation: Quat,
    /// Metres per second, world space, of the origin of its frame; at most [`MAX_SPEED_MPS`].
    pub velocity: Vec3,
    /// Radians per second, world space; at most [`MAX_SPIN_RADPS`].
    pub spin: Vec3,
}

impl Prop {
    /// A prop of a shape and mass, with friction 0.8, that does not bounce.
    #[must_use]
    pub fn new(solid: Solid, mass_kg: f32) -> Self {
        Self { solid, mass_kg, friction: 0.8, bounce: 0.0 }
    }

    /// A crate of so many metres a side.
    #[must_use]
    pub fn cube(side: f32, mass_kg: f32) -> Self {
        Self::new(Solid::Cuboid { half_extents: Vec3::splat(0.5 * side) }, mass_kg)
    }

    /// A ball that bounces half as fast as it falls.
    #[must_use]
    pub fn ball(radius: f32, mass_kg: f32) -> Self {
        Self { bounce: 0.5, ..Self::new(Solid::Sphere { radius }, mass_kg) }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// When one is out of its range; the first one is named.
    pub fn check(&self) -> Result<(), DescriptionError> {
        const WHAT: &str = "a prop";
        self.solid.check(WHAT)?;
        within(WHAT, "mass_kg", self.mass_kg, MASS_RANGE_KG)?;
        within(WHAT, "friction", self.friction, FRICTION_RANGE)?;
        within(WHAT, "bounce", self.bounce, [0.0, 0.95])
    }
}

impl Motion {
    /// At rest at a point, not turned.
    #[must_use]
    pub fn at(position: Vec3) -> Self {
        Self { position, rotation: Quat::IDENTITY, velocity: Vec3::ZERO, spin: Vec3::ZERO }
    }

    /// The same, moving.
    #[must_use]
    pub fn moving(self, velocity: Vec3) -> Self {
        Self { velocity, ..self }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// When one is out of its range; the first one is named.
    pub fn check(&self) -> Result<(), DescriptionError> {
        const WHAT: &str = "a prop";
        check_place(WHAT, self.position, self.rotation)?;
        within(WHAT, "velocity", self.velocity.length(), [0.0, MAX_SPEED_MPS])?;
        within(WHAT, "spin", self.spin.length(), [0.0, MAX_SPIN_RADPS])
    }
}
