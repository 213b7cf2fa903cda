//! The immutable half: an MJCF compiled, checked against policy-core's humanoid, and shared.

use std::path::Path;
use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::{MjData, MjtState};
use mujoco_rs::wrappers::mj_model::{MjModel, MjtObjBase};
use policy_core::DOF_COUNT;

use crate::CONTROL_HZ;
use crate::layout::Layout;
use crate::mjcf;
use crate::model_error::ModelError;

/// Which numbers make up the whole state of a simulation.
pub(crate) const STATE: u32 = MjtState::mjSTATE_INTEGRATION as u32;

/// Working memory of a character: enough for every contact that the humanoid can make, and a bound on what
/// a model may ask for.
const MEMORY_BYTES: std::ops::RangeInclusive<i64> = (1 << 20)..=(256 << 20);

/// `mjINT_RK4`.
const RUNGE_KUTTA: i32 = 1;

/// A humanoid that many characters share. Cloning copies a pointer.
///
/// ```
/// # fn main() -> Result<(), physics_bridge::ModelError> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// let model = physics_bridge::Model::from_mjcf(HUMANOID)?;
/// assert_eq!(model.substeps(), 4);
/// assert!(physics_bridge::Model::from_mjcf("<mujoco/>").is_err());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    shared: Arc<Shared>,
    physics: Arc<MjModel>,
}

/// What stays the same whatever the settings.
#[derive(Debug)]
struct Shared {
    layout: Layout,
    substeps: u32,
}

impl Model {
    /// Compiles the text of an MJCF, such as `include_str!("../assets/humanoid.xml")`, on flat ground.
    ///
    /// # Errors
    /// When the text is no valid MJCF, or not of policy-core's humanoid: 15 bodies, 28 limited hinges and
    /// position servos of the same names, a floating pelvis, a `timestep` that divides 1/30 s, a plane
    /// named `floor`.
    pub fn from_mjcf(mjcf: &str) -> Result<Self, ModelError> {
        let physics = mjcf::compile(mjcf)?;
        let layout = Layout::of(&physics)?;
        let substeps = check_options(&physics)?;
        Ok(Self { shared: Arc::new(Shared { layout, substeps }), physics: Arc::new(physics) })
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
        self.physics.totalmass()
    }

    /// Lower and upper limit of every hinge, radians, in the order of [`policy_core::JOINT_NAMES`].
    #[must_use]
    pub fn joint_limits(&self) -> ([f32; DOF_COUNT], [f32; DOF_COUNT]) {
        let limits = &self.shared.layout.limits;
        (limits.map(|[low, _]| low as f32), limits.map(|[_, high]| high as f32))
    }

    /// Height of the ground at a point, metres.
    #[must_use]
    pub fn height_at(&self, _x: f32, _y: f32) -> f32 {
        0.0
    }

    pub(crate) fn layout(&self) -> &Layout {
        &self.shared.layout
    }

    pub(crate) fn new_data(&self) -> MjData<Arc<MjModel>> {
        MjData::new(Arc::clone(&self.physics))
    }

    pub(crate) fn state_len(&self) -> usize {
        self.physics.state_size(STATE)
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
    if physics.name_to_id(MjtObjBase::mjOBJ_GEOM, "floor").is_none() {
        return Err(ModelError::Missing { kind: "geom", name: "floor" });
    }
    let timestep_secs = physics.opt().timestep;
    let substeps = 1.0 / (f64::from(CONTROL_HZ) * timestep_secs);
    let whole = substeps.round();
    if !(1.0..=1000.0).contains(&whole) || (substeps - whole).abs() > 1e-3 {
        return Err(ModelError::Timestep { timestep_secs });
    }
    Ok(whole as u32)
}
