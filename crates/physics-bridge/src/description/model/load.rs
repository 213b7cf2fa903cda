//! Ways to a [`Model`]: from text, a file or a pack, and from another model.

use std::path::Path;
use std::sync::Arc;

use glam::{DMat3, DVec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::{MjModel, MjtObjBase};
use policy_core::contract::{CONTROL_HZ, Pose, Settings};
use policy_core::{CharacterPack, Skeleton};

use super::{Model, Shared, Source};
use crate::description::ground::Ground;
use crate::description::layout::Layout;
use crate::description::model_error::ModelError;
use crate::description::settings;
use crate::description::shape::{Bounds, Shape, bounds, shapes};
use crate::description::terrain::Terrain;
use crate::description::{file, mjcf, skeleton};

/// Working memory of a character, bytes: the least, and a bound on what a model may ask for.
const MEMORY_BYTES: std::ops::RangeInclusive<i64> = (1 << 20)..=(256 << 20);

/// `mjINT_RK4`.
const RUNGE_KUTTA: i32 = 1;

/// Name of the keyframe in which a character stands.
const STAND: &str = "stand";

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
    /// floats, at least one geom, every other joint a limited hinge with a position servo that has a symmetric `forcerange` and no
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
        let bytes = file::read(path, mjcf::limits::MOST_BYTES)
            .map_err(|source| ModelError::Read { path: path.to_owned(), source })?;
        Self::from_mjcf_bytes(&bytes)
            .map_err(|source| ModelError::File { path: path.to_owned(), error: Box::new(source) })
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
            Arc::new(settings::apply(&settings, &shared.base, &shared.layout)?)
        };
        Ok(Self { shared: Arc::clone(shared), physics, settings })
    }

    /// The same character, ground and settings with physics steps that are longer by a factor. Compiles again.
    ///
    /// # Errors
    /// When a control tick is no whole number of such steps, or the MJCF does not say `timestep="..."` with double
    /// quotation marks after a space, so that the steps can't be found in the text.
    pub fn with_time_step(&self, factor: f64) -> Result<Self, ModelError> {
        let expected = self.timestep_secs() * factor;
        let mjcf = scaled(self.mjcf(), "timestep", factor).into();
        let model = Self::compile(Source { mjcf, ..self.shared.source.clone() })?;
        let found = model.timestep_secs();
        if (found - expected).abs() > 1e-9 * expected.abs() {
            return Err(ModelError::TimestepText { expected, found });
        }
        model.with_settings(self.settings)
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
        let bounds = bounds(&base, &layout, &shapes);
        if shapes.is_empty() && bounds.is_empty() {
            return Err(ModelError::NoGeoms);
        }
        let mut stand = Pose::new(&skeleton);
        let qpos = match base.name_to_id(MjtObjBase::mjOBJ_KEY, STAND) {
            // The layout fits, so a keyframe has as many numbers as our pose.
            Some(key) => &base.key_qpos()[key * stand.qpos.len()..],
            None => base.qpos0(),
        };
        layout.our_qpos(qpos, &mut stand.qpos);
        Pose::check(&stand.qpos, &stand.qvel, skeleton.joint_count())
            .map_err(|error| ModelError::Stand { error })?;
        let physics = Arc::clone(&base);
        let stand_lift = stand_lift(&base, &layout, &stand, (&shapes, &shape_geoms), &bounds);
        let shared = Shared {
            source,
            skeleton,
            base,
            layout,
            ground,
            shapes,
            shape_geoms,
            bounds,
            substeps,
            stand,
            stand_lift,
        };
        Ok(Self { shared: Arc::new(shared), physics, settings: Settings::default() })
    }
}

/// Height of the root above the lowest point of a standing character, metres.
fn stand_lift(
    physics: &Arc<MjModel>,
    layout: &Layout,
    stand: &Pose,
    (shapes, geoms): (&[Shape], &[usize]),
    bounds: &[Bounds],
) -> f64 {
    let mut data = MjData::new(Arc::clone(physics));
    layout.write_qpos(&stand.qpos, data.qpos_mut());
    data.kinematics();
    let root = data.xpos()[layout.body_ids[0]][2];
    let mut lowest = f64::INFINITY;
    // MuJoCo's matrices are row by row, glam's column by column.
    let place = |geom: usize| {
        (DVec3::from(data.geom_xpos()[geom]), DMat3::from_cols_array(&data.geom_xmat()[geom]).transpose())
    };
    for bounds in bounds {
        let (centre, world_from_geom) = place(bounds.geom);
        bounds.low_points(centre, world_from_geom, |point, _| lowest = lowest.min(point.z));
    }
    for (shape, &geom) in shapes.iter().zip(geoms) {
        let (centre, world_from_shape) = place(geom);
        shape.kind.low_points(centre, world_from_shape, |point, below| lowest = lowest.min(point.z - below));
    }
    root - lowest
}

/// Checks what stepping relies on. Returns the substeps in a control tick.
fn check_options(physics: &MjModel, control_hz: f32) -> Result<u32, ModelError> {
    if physics.opt().integrator == RUNGE_KUTTA {
        return Err(ModelError::Integrator);
    }
    let found = physics.narena();
    let (least, most) = (needed_memory(physics).max(*MEMORY_BYTES.start()), *MEMORY_BYTES.end());
    if !(least..=most).contains(&found) {
        return Err(ModelError::Memory { least, most, found });
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

/// Bytes of working memory that a model needs when all geoms that can touch do, at two points each. MuJoCo ends the
/// process when it has less than it needs for pairs of bodies or for the solver.
fn needed_memory(physics: &MjModel) -> i64 {
    let square = |count: i64| count * count;
    let (bodies, types, affinities) =
        (physics.geom_bodyid(), physics.geom_contype(), physics.geom_conaffinity());
    let touch = |a: usize, b: usize| {
        bodies[a] != bodies[b] && (types[a] & affinities[b] != 0 || types[b] & affinities[a] != 0)
    };
    let geoms = bodies.len();
    let pairs: usize = (0..geoms).map(|a| (a + 1..geoms).filter(|&b| touch(a, b)).count()).sum();
    (1 << 18) + 64 * (square(physics.nbody()) + square(physics.nv())) + (12 << 10) * pairs as i64
}

/// The text with every number of an attribute multiplied by a factor.
fn scaled(mjcf: &str, attribute: &str, factor: f64) -> String {
    let opening = format!(" {attribute}=\"");
    let mut parts = mjcf.split(opening.as_str());
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (value, rest) = part.split_once('"').unwrap_or((part, ""));
        let value = value.trim().parse::<f64>().map_or(value.to_owned(), |v| (v * factor).to_string());
        text.extend([opening.as_str(), value.as_str(), "\"", rest]);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_scaled_and_the_rest_of_the_text_stays() {
        let text = "<a density=\"2\"/><b name=\"density\" density=\"0.5\" size=\"3\"/>";
        assert_eq!(
            scaled(text, "density", 3.0),
            "<a density=\"6\"/><b name=\"density\" density=\"1.5\" size=\"3\"/>"
        );
        assert_eq!(scaled(text, "mass", 3.0), text);
    }
}
