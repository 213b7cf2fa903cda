//! The playground: what stands in it, the course through it, and where its other characters wander. Plain data and
//! pure functions of it; knows no physics engine, no drawing and no devices.
//!
//! A physics engine builds [`Playground::fixtures`] and [`Playground::props`]; a [`Race`] and one [`Wanderer`] for each
//! further character go along with its ticks; a [`Follower`] steers over the course by itself. Equal inputs give the same bits on every machine.
//!
//! ```
//! # fn main() -> Result<(), playground::SceneFileError> {
//! use glam::Vec2;
//! use playground::{Playground, Race, RaceEvent};
//!
//! let scene = Playground::shipped()?;
//! let mut race = Race::default();
//! let start = scene.checkpoints[0].at;
//! assert_eq!(race.tick(&scene.checkpoints, start, false), Some(RaceEvent::Started));
//! assert_eq!(scene.height_at(Vec2::ZERO, 1.0), 0.0);
//! # Ok(())
//! # }
//! ```

mod file;
mod follow;
mod layout;
mod loose;
mod race;
mod swing;
mod wander;

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use policy_core::contract::{Fixture, Joint, Motion, Prop};

pub use file::SceneFileError;
pub use follow::{Follower, Pace, Swinging, Waypoint};
pub use loose::{LooseKind, put_down, thrown};
pub use race::{Race, RaceEvent, RaceState};
pub use wander::{WanderPath, Wanderer, Wish};

/// The text of the scene that ships.
pub const SHIPPED: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scenes/playground.ron"));

/// Colours of what stands in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Paint {
    Concrete,
    Wood,
    Steel,
    Red,
    Orange,
    Yellow,
    Green,
    Blue,
    Violet,
}

/// Something that never moves, and its colour. Its shape is a convex solid.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedFixture {
    /// What it is to the physics.
    pub fixture: Fixture,
    /// Its colour.
    pub paint: Paint,
}

/// Something that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedProp {
    /// Its name, unique in the scene.
    pub name: String,
    /// What it is to the physics.
    pub prop: Prop,
    /// Where its origin is at the start, metres, world space.
    pub position: Vec3,
    /// `world_from_prop` at the start.
    pub rotation: Quat,
    /// Its colour.
    pub paint: Paint,
    /// What holds it to the world.
    pub joint: Option<Joint>,
    /// It is driven to this height above its lowest point, metres: a pendulum that does not come to rest.
    pub swing_m: Option<f32>,
}

impl PlacedProp {
    /// How it begins: at rest.
    #[must_use]
    pub fn start(&self) -> Motion {
        Motion { rotation: self.rotation, ..Motion::at(self.position) }
    }
}

/// Where a character starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Metres, world space.
    pub at: Vec2,
    /// Where it looks, radians from world x.
    pub heading: f32,
    /// The rectangle that it wanders in: least and greatest x and y, metres.
    pub zone: [Vec2; 2],
}

/// A place that the course leads through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkpoint {
    /// Its middle on the ground, metres.
    pub at: Vec2,
    /// Metres.
    pub radius: f32,
}

/// Everything that a scene begins with. Immutable.
#[derive(Clone, Debug, PartialEq)]
pub struct Playground {
    /// Name, for files and people.
    pub name: String,
    /// Least and greatest x and y of the whole, metres.
    pub area: [Vec2; 2],
    /// Where the characters start, the player first.
    pub starts: Vec<Start>,
    /// What never moves.
    pub fixtures: Vec<PaintedFixture>,
    /// What moves.
    pub props: Vec<PlacedProp>,
    /// The course: the first starts the clock, the last stops it.
    pub checkpoints: Vec<Checkpoint>,
    /// A way past all checkpoints, for a [`Follower`]; empty when the scene has none.
    pub way: Vec<Waypoint>,
}

impl Playground {
    /// The one inside the demo.
    ///
    /// # Errors
    /// When its text is no scene.
    pub fn shipped() -> Result<Arc<Self>, SceneFileError> {
        Self::from_ron(SHIPPED).map(Arc::new)
    }
}
