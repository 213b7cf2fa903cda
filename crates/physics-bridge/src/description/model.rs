//! A character's body and its ground: an MJCF compiled, checked against a skeleton, and shared.

use std::path::Path;
use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::{MjData, MjtState};
use mujoco_rs::wrappers::mj_model::{MjModel, MjtObjBase};
use policy_core::{ActuationContract, CharacterPack, Skeleton};

use super::ground::{Ground, HeightField};
use super::layout::Layout;
use super::model_error::ModelError;
use super::pose::Pose;
use super::settings::Settings;
use super::shape::{Shape, shapes};
use super::terrain::Terrain;
use super::{mjcf, skeleton};

/// Control ticks per second, unless a pack says otherwise.
pub const CONTROL_HZ: u32 = 30;

/// Which numbers make up the whole state of a simulation.
pub(crate) const STATE: u32 = MjtState::mjSTATE_INTEGRATION as u32;

/// Working memory of a character: enough for the contacts of a small one, and a bound on what a model may ask for.
const MEMORY_BYTES: std::ops::RangeInclusive<i64> = (1 << 20)..=(256 << 20);

/// `mjINT_RK4`.
const RUNGE_KUTTA: i32 = 1;

/// Name of the keyframe in which a character stands.
const STAND: &str = "stand";

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
    substeps: u32,
    stand: Pose,
}

impl Model {
    /// Compiles the text of an MJCF, such as `include_str!("../assets/humanoid.xml")`, on flat ground, for
    /// [`CONTROL_HZ`] control ticks per second.
    ///
    /// The skeleton follows from the text alone. Bodies come in the order of the MJCF, the one with the free joint
    /// first. Hinges come in the order of their motors. The first body with `head` in its name is the head, those
    /// with `hand` are hands, those with `foot` or `feet` are feet.
    ///
    /// Characters stand in the keyframe `stand`, or else in the pose of the MJCF itself.
    ///
    /// # Errors
    /// When the text is no valid MJCF, asks for files, exhausts memory or time, or is no character: one body that
    /// floats, every other joint a limited hinge with a position servo that has a symmetric `forcerange` and no
    /// `kv`, a `timestep` that divides the control period, a level plane named `floor`.
    pub fn from_mjcf(mjcf: &str) -> Result<Self, ModelError> {
        Self::compile(Source {
            mjcf: mjcf.into(),
            skeleton: None,
            control_hz: CONTROL_HZ as f32,
            terrain: Terrain::Flat,
        })
    }

    /// As [`Model::from_mjcf`], with the order and the roles of `skeleton`, such as that of a pack of version 1.
    ///
    /// # Errors
    /// As [`Model::from_mjcf`], and when a body or hinge of the skeleton is missing in the MJCF, or has another
    /// parent, body, axis or range there, or the MJCF has more of them.
    pub fn from_mjcf_with_skeleton(
        mjcf: &str,
        skeleton: impl Into<Arc<Skeleton>>,
    ) -> Result<Self, ModelError> {
        Self::compile(Source {
            mjcf: mjcf.into(),
            skeleton: Some(skeleton.into()),
            control_hz: CONTROL_HZ as f32,
            terrain: Terrain::Flat,
        })
    }

    /// Compiles the bytes of an MJCF, such as `include_bytes!("../assets/humanoid.xml")`.
    ///
    /// # Errors
    /// When the bytes are not UTF-8, and as [`Model::from_mjcf`].
    pub fn from_mjcf_bytes(mjcf: &[u8]) -> Result<Self, ModelError> {
        let text =
            std::str::from_utf8(mjcf).map_err(|error| ModelError::Utf8 { offset: error.valid_up_to() })?;
        Self::from_mjcf(text)
    }

    /// Reads an MJCF file. It must stand alone: files that it includes are not read.
    ///
    /// # Errors
    /// When the file can't be read, and as [`Model::from_mjcf`]; both name the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        let path = path.as_ref();
        let bytes =
            std::fs::read(path).map_err(|source| ModelError::Read { path: path.to_owned(), source })?;
        Self::from_mjcf_bytes(&bytes)
            .map_err(|source| ModelError::File { path: path.to_owned(), source: Box::new(source) })
    }

    /// The body of a pack, with the pack's skeleton and control rate, on flat ground.
    ///
    /// # Errors
    /// When the pack has no MJCF, as those of version 1, and as [`Model::from_mjcf_with_skeleton`].
    pub fn for_pack(pack: &CharacterPack) -> Result<Self, ModelError> {
        Self::compile(Source {
            mjcf: pack.mjcf().ok_or(ModelError::NoMjcf)?.into(),
            skeleton: Some(Arc::clone(pack.skeleton())),
            control_hz: pack.control_hz(),
            terrain: Terrain::Flat,
        })
    }

    /// The same character, with the same settings, on other ground. Compiles again, some milliseconds.
    ///
    /// # Errors
    /// When a number of the terrain is out of its range.
    pub fn with_terrain(&self, terrain: Terrain) -> Result<Self, ModelError> {
        let source = Source { terrain, ..self.shared.source.clone() };
        Self::compile(source)?.with_settings(self.settings)
    }

    /// The same character on the same ground, with these settings in place of the present ones.
    /// [`Character::set_model`](crate::Character::set_model) applies it. Copies the compiled model.
    ///
    /// # Errors
    /// When a setting is out of its range.
    pub fn with_settings(&self, settings: Settings) -> Result<Self, ModelError> {
        let shared = &self.shared;
        let physics = if settings == Settings::default() {
            Arc::clone(&shared.base)
        } else {
            Arc::new(settings.apply_to(&shared.base, &shared.layout)?)
        };
        Ok(Self { shared: Arc::clone(shared), physics, settings })
    }

    /// Compiles and checks.
    pub(crate) fn compile(source: Source) -> Result<Self, ModelError> {
        let base = Arc::new(mjcf::compile(&source.mjcf, &source.terrain)?);
        let skeleton = match &source.skeleton {
            Some(given) => skeleton::check(given, &base).map(|()| Arc::clone(given))?,
            None => Arc::new(skeleton::derive(&base)?),
        };
        let layout = Layout::of(&base, &skeleton)?;
        let substeps = check_options(&base, source.control_hz)?;
        let ground = Ground::of(&base)?;
        let (shapes, shape_geoms) = shapes(&base, &layout);
        let mut stand = Pose::new(&skeleton);
        let qpos = match base.name_to_id(MjtObjBase::mjOBJ_KEY, STAND) {
            Some(key) => &base.key_qpos()[key * stand.qpos.len()..],
            None => base.qpos0(),
        };
        layout.our_qpos(qpos, &mut stand.qpos);
        Pose::check(&stand.qpos, &stand.qvel, skeleton.joint_count())
            .map_err(|source| ModelError::Stand { source })?;
        let physics = Arc::clone(&base);
        let shared = Shared { source, skeleton, base, layout, ground, shapes, shape_geoms, substeps, stand };
        Ok(Self { shared: Arc::new(shared), physics, settings: Settings::default() })
    }

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

    /// What it was compiled from.
    pub(crate) fn source(&self) -> &Source {
        &self.shared.source
    }

    /// A standing character at rest, in our order; its place means nothing.
    pub(crate) fn stand(&self) -> &Pose {
        &self.shared.stand
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

/// Checks what stepping relies on. Returns the substeps in a control tick.
fn check_options(physics: &MjModel, control_hz: f32) -> Result<u32, ModelError> {
    if physics.opt().integrator == RUNGE_KUTTA {
        return Err(ModelError::Integrator);
    }
    let found = physics.narena();
    if !MEMORY_BYTES.contains(&found) {
        return Err(ModelError::Memory { least: *MEMORY_BYTES.start(), most: *MEMORY_BYTES.end(), found });
    }
    let timestep_secs = physics.opt().timestep;
    let substeps = 1.0 / (f64::from(control_hz) * timestep_secs);
    let whole = substeps.round();
    if !(1.0..=1000.0).contains(&whole) || (substeps - whole).abs() > 1e-3 {
        return Err(ModelError::Timestep { control_hz, timestep_secs });
    }
    if physics.nhistory() > 0 {
        return Err(ModelError::Delays);
    }
    Ok(whole as u32)
}
