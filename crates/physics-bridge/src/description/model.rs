//! A character's body and its ground: an MJCF compiled, checked against a skeleton, and shared.

mod load;

use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::{MjData, MjtState};
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::contract::{HeightField, Pose, Settings};
use policy_core::{ActuationContract, Skeleton};

use super::ground::Ground;
use super::layout::Layout;
use super::shape::{Bounds, Shape};
use super::terrain::Terrain;

/// Which numbers make up the whole state of a simulation.
pub(crate) const STATE: u32 = MjtState::mjSTATE_INTEGRATION as u32;

/// A character's body and its ground, shared by many characters. Cloning copies two pointers.
///
/// ```
/// # fn main() -> Result<(), physics_bridge::ModelError> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_bridge::{Model, Settings, Terrain};
///
/// let model = Model::from_mjcf(HUMANOID)?;
/// assert_eq!((model.substeps(), model.skeleton().body_count()), (4, 15));
///
/// let hills = model.with_terrain(Terrain::Wavy { height_m: 0.2, wavelength_m: 4.0, seed: 1 })?;
/// assert!(hills.height_at(3.0, 1.0) >= 0.0);
///
/// let moon = model.with_settings(Settings { gravity: 0.165, ..Settings::default() })?;
/// assert_eq!(moon.mass_kg(), model.mass_kg());
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Model {
    shared: Arc<Shared>,
    physics: Arc<MjModel>,
    settings: Settings,
}

/// What a model is compiled from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Source {
    pub mjcf: Arc<str>,
    /// `None` to derive it from the MJCF.
    pub skeleton: Option<Arc<Skeleton>>,
    pub control_hz: f32,
    pub terrain: Terrain,
}

/// What stays the same whatever the settings.
struct Shared {
    source: Source,
    skeleton: Arc<Skeleton>,
    base: Arc<MjModel>,
    layout: Layout,
    ground: Ground,
    shapes: Box<[Shape]>,
    shape_geoms: Box<[usize]>,
    bounds: Box<[Bounds]>,
    substeps: u32,
    stand: Pose,
    /// Height of the root above flat ground when a standing character touches it, metres.
    stand_lift: f64,
}

impl Model {
    /// Bodies, hinges and roles.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.shared.skeleton
    }

    /// How the motors are driven, as compiled and with the present settings: gains, damping, force limits,
    /// armatures, physics rate, mass. Allocates.
    #[must_use]
    pub fn actuation(&self) -> ActuationContract {
        self.shared.layout.actuation(&self.physics)
    }

    /// Control ticks per second.
    #[must_use]
    pub fn control_hz(&self) -> f32 {
        self.shared.source.control_hz
    }

    /// Text of the MJCF.
    #[must_use]
    pub fn mjcf(&self) -> &str {
        &self.shared.source.mjcf
    }

    /// The ground.
    #[must_use]
    pub fn terrain(&self) -> Terrain {
        self.shared.source.terrain
    }

    /// Gravity, friction, strength and mass.
    #[must_use]
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Physics steps in a control tick.
    #[must_use]
    pub fn substeps(&self) -> u32 {
        self.shared.substeps
    }

    /// Length of a physics step, seconds.
    #[must_use]
    pub fn timestep_secs(&self) -> f64 {
        self.physics.opt().timestep
    }

    /// Mass of the whole character, kilograms.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.physics.body_subtreemass()[self.shared.layout.body_ids[0]]
    }

    /// The spheres, capsules and boxes that the bodies are made of.
    #[must_use]
    pub fn shapes(&self) -> &[Shape] {
        &self.shared.shapes
    }

    /// Height of the ground at a point, metres, world space: of the plane `floor` and the terrain. Other geoms of
    /// an MJCF are not seen.
    #[must_use]
    pub fn height_at(&self, x: f32, y: f32) -> f32 {
        self.shared.ground.height_at(x, y)
    }

    /// The terrain as a grid, to draw it; `None` on flat ground.
    #[must_use]
    pub fn height_field(&self) -> Option<&HeightField> {
        self.shared.ground.field.as_ref()
    }

    /// True when the two differ in their settings at most.
    pub(crate) fn shares_ground_with(&self, other: &Model) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    pub(crate) fn layout(&self) -> &Layout {
        &self.shared.layout
    }

    /// MuJoCo's geom of each shape.
    pub(crate) fn shape_geoms(&self) -> &[usize] {
        &self.shared.shape_geoms
    }

    /// Corners around the geoms that are no shapes.
    pub(crate) fn bounds(&self) -> &[Bounds] {
        &self.shared.bounds
    }

    /// What it was compiled from.
    pub(crate) fn source(&self) -> &Source {
        &self.shared.source
    }

    /// A standing character at rest, in our order; its place means nothing.
    pub(crate) fn stand(&self) -> &Pose {
        &self.shared.stand
    }

    /// Height of the root above flat ground when a standing character touches it, metres.
    pub(crate) fn stand_lift(&self) -> f64 {
        self.shared.stand_lift
    }

    pub(crate) fn physics(&self) -> &Arc<MjModel> {
        &self.physics
    }

    pub(crate) fn new_data(&self) -> MjData<Arc<MjModel>> {
        MjData::new(Arc::clone(&self.physics))
    }
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Model")
            .field("terrain", &self.terrain())
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}
