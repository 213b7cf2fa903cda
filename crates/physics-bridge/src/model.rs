//! The immutable half: an MJCF compiled, checked against policy-core's humanoid, and shared.

use std::path::Path;
use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::{MjData, MjtState};
use mujoco_rs::wrappers::mj_model::{MjModel, MjtObjBase};
use policy_core::DOF_COUNT;

use crate::ground::{Ground, HeightField};
use crate::layout::Layout;
use crate::mjcf;
use crate::model_error::ModelError;
use crate::pose::Pose;
use crate::settings::Settings;
use crate::shape::{Shape, shapes};
use crate::terrain::Terrain;
use crate::{CONTROL_HZ, QPOS_LEN, QVEL_LEN};

/// Which numbers make up the whole state of a simulation.
pub(crate) const STATE: u32 = MjtState::mjSTATE_INTEGRATION as u32;

/// Working memory of a character: enough for every contact that the humanoid can make, and a bound on what
/// a model may ask for.
const MEMORY_BYTES: std::ops::RangeInclusive<i64> = (1 << 20)..=(256 << 20);

/// `mjINT_RK4`.
const RUNGE_KUTTA: i32 = 1;

/// Name of the keyframe in which a character stands.
const STAND: &str = "stand";

/// A humanoid and its ground, shared by many characters. Cloning copies two pointers.
///
/// ```
/// # fn main() -> Result<(), physics_bridge::ModelError> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_bridge::{Model, Settings, Terrain};
///
/// let model = Model::from_mjcf(HUMANOID)?;
/// assert_eq!(model.substeps(), 4);
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

/// What stays the same whatever the settings.
struct Shared {
    mjcf: Box<str>,
    terrain: Terrain,
    base: Arc<MjModel>,
    layout: Layout,
    ground: Ground,
    shapes: Box<[Shape]>,
    shape_geoms: Box<[usize]>,
    substeps: u32,
    stand: [f64; QPOS_LEN],
}

impl Model {
    /// Compiles the text of an MJCF, such as `include_str!("../assets/humanoid.xml")`, on flat ground.
    ///
    /// The keyframe `stand`, if there is one, is the pose in which characters stand; otherwise it is the
    /// pose of the MJCF itself.
    ///
    /// # Errors
    /// When the text is no valid MJCF, or not of policy-core's humanoid: 15 bodies, 28 limited hinges and
    /// position servos of the same names, a floating pelvis, a `timestep` that divides 1/30 s, a level plane
    /// named `floor`.
    pub fn from_mjcf(mjcf: &str) -> Result<Self, ModelError> {
        Self::compile(mjcf, Terrain::Flat)
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

    /// Reads an MJCF file. It must stand alone: files that it includes are not looked for beside it.
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

    /// The same humanoid, with the same settings, on other ground. Compiles anew, some milliseconds.
    ///
    /// # Errors
    /// When a number of the terrain is out of its range.
    pub fn with_terrain(&self, terrain: Terrain) -> Result<Self, ModelError> {
        Self::compile(&self.shared.mjcf, terrain)?.with_settings(self.settings)
    }

    /// The same humanoid on the same ground, with these settings in place of the present ones. Characters
    /// take it up by [`Character::set_model`](crate::Character::set_model). Copies the compiled model.
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

    /// Compiles the text on any ground.
    pub(crate) fn compile(mjcf: &str, terrain: Terrain) -> Result<Self, ModelError> {
        let base = Arc::new(mjcf::compile(mjcf, &terrain)?);
        let layout = Layout::of(&base)?;
        let substeps = check_options(&base)?;
        let ground = Ground::of(&base)?;
        let (shapes, shape_geoms) = shapes(&base, &layout);
        let stand = match base.name_to_id(MjtObjBase::mjOBJ_KEY, STAND) {
            Some(key) => layout.our_qpos(&base.key_qpos()[key * QPOS_LEN..]),
            None => layout.our_qpos(base.qpos0()),
        };
        Pose::check(&stand, &[0.0; QVEL_LEN]).map_err(|source| ModelError::Stand { source })?;
        let physics = Arc::clone(&base);
        let mjcf = mjcf.into();
        let shared = Shared { mjcf, terrain, base, layout, ground, shapes, shape_geoms, substeps, stand };
        Ok(Self { shared: Arc::new(shared), physics, settings: Settings::default() })
    }

    /// Text of the MJCF.
    #[must_use]
    pub fn mjcf(&self) -> &str {
        &self.shared.mjcf
    }

    /// The ground.
    #[must_use]
    pub fn terrain(&self) -> Terrain {
        self.shared.terrain
    }

    /// Gravity, friction and strength.
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

    /// Lower and upper limit of every hinge, radians, in the order of [`policy_core::JOINT_NAMES`].
    #[must_use]
    pub fn joint_limits(&self) -> ([f32; DOF_COUNT], [f32; DOF_COUNT]) {
        let limits = &self.shared.layout.limits;
        (limits.map(|[low, _]| low as f32), limits.map(|[_, high]| high as f32))
    }

    /// The spheres, capsules and boxes that the bodies are made of.
    #[must_use]
    pub fn shapes(&self) -> &[Shape] {
        &self.shared.shapes
    }

    /// Height of the ground at a point, metres, world space. Sees the plane `floor` and the terrain, and
    /// nothing else that an MJCF may have put on them.
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

    /// `qpos` of a standing character, in our order; its place means nothing.
    pub(crate) fn stand(&self) -> &[f64; QPOS_LEN] {
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
            .field("terrain", &self.shared.terrain)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

/// Checks what stepping relies on; answers the substeps in a control tick.
fn check_options(physics: &MjModel) -> Result<u32, ModelError> {
    if physics.opt().integrator == RUNGE_KUTTA {
        return Err(ModelError::Integrator);
    }
    let found = physics.narena();
    if !MEMORY_BYTES.contains(&found) {
        return Err(ModelError::Memory { least: *MEMORY_BYTES.start(), most: *MEMORY_BYTES.end(), found });
    }
    let timestep_secs = physics.opt().timestep;
    let substeps = 1.0 / (f64::from(CONTROL_HZ) * timestep_secs);
    let whole = substeps.round();
    if !(1.0..=1000.0).contains(&whole) || (substeps - whole).abs() > 1e-3 {
        return Err(ModelError::Timestep { timestep_secs });
    }
    Ok(whole as u32)
}
