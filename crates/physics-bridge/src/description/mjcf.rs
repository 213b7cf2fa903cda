//! Compiles MJCF text, with a height field put in where the terrain asks for one, and says in full what is
//! wrong with it.

pub(super) mod limits;
mod xml;

use std::ffi::{CStr, c_char};

use mujoco_rs::mujoco_c::{mj_deleteModel, mj_loadXML};
use mujoco_rs::wrappers::mj_auxiliary::MjVfs;
use mujoco_rs::wrappers::mj_editing::{MjSpec, SpecItem};
use mujoco_rs::wrappers::mj_model::{MjModel, MjtGeomBase};

use super::file::quoted;
use super::logging;
use super::model_error::ModelError;
use super::terrain::{Grid, HALF_EXTENT, PLANE_DROP, Terrain};

/// Name of the plane that every MJCF must have.
pub(crate) const FLOOR: &str = "floor";

/// Name of the height field and of its geom.
pub(crate) const HEIGHT_FIELD: &str = "terrain";

/// Room for MuJoCo's message; mujoco-rs keeps 99 characters of it, which cuts off the line number.
const MESSAGE_BYTES: usize = 1024;

const FILE_NAME: &CStr = c"model.xml";

/// Compiles `mjcf` on `terrain`. Text that asks for files or for too much never reaches MuJoCo.
pub(crate) fn compile(mjcf: &str, terrain: &Terrain) -> Result<MjModel, ModelError> {
    limits::check(mjcf)?;
    logging::install();
    terrain.check()?;
    let Some(grid) = terrain.grid() else {
        return MjModel::from_xml_string(mjcf).map_err(|error| refusal(mjcf, &error));
    };
    let mut spec = MjSpec::from_xml_string(mjcf).map_err(|error| refusal(mjcf, &error))?;
    add_height_field(&mut spec, &grid)?;
    spec.compile().map_err(|error| refusal(mjcf, &error))
}

/// Puts a height field with the floor's contact properties into the world, and the floor below it.
pub(crate) fn add_height_field(spec: &mut MjSpec, grid: &Grid) -> Result<(), ModelError> {
    if spec.hfield(HEIGHT_FIELD).is_some() || spec.geom(HEIGHT_FIELD).is_some() {
        return Err(ModelError::Kind {
            kind: "geom",
            name: HEIGHT_FIELD.into(),
            expected: "a name that is free",
        });
    }
    let side = i32::try_from(grid.side).expect("a grid of a few hundred points");
    let highest = f64::from(grid.highest).max(1e-3);
    let field = spec.add_hfield().with_name(HEIGHT_FIELD).with_size([HALF_EXTENT, HALF_EXTENT, highest, 1.0]);
    field.set_nrow(side);
    field.set_ncol(side);
    field.set_userdata(&grid.heights);

    let floor =
        spec.geom_mut(FLOOR).ok_or_else(|| ModelError::Missing { kind: "geom", name: FLOOR.into() })?;
    let mut pos = *floor.pos();
    let top = pos[2];
    pos[2] -= PLANE_DROP;
    *floor.pos_mut() = pos;
    let (friction, solref, solimp) = (*floor.friction(), *floor.solref(), *floor.solimp());
    let (contype, conaffinity, condim) = (floor.contype(), floor.conaffinity(), floor.condim());
    let (priority, margin, gap, solmix) = (floor.priority(), floor.margin(), floor.gap(), floor.solmix());

    let geom = spec.world_body_mut().add_geom().with_name(HEIGHT_FIELD);
    geom.set_type(MjtGeomBase::mjGEOM_HFIELD);
    geom.set_hfieldname(HEIGHT_FIELD);
    *geom.pos_mut() = [0.0, 0.0, top];
    (*geom.friction_mut(), *geom.solref_mut(), *geom.solimp_mut()) = (friction, solref, solimp);
    geom.set_contype(contype);
    geom.set_conaffinity(conaffinity);
    geom.set_condim(condim);
    geom.set_priority(priority);
    geom.set_margin(margin);
    geom.set_gap(gap);
    geom.set_solmix(solmix);
    Ok(())
}

/// The error for text that MuJoCo refused with `error`.
fn refusal(mjcf: &str, error: &dyn std::error::Error) -> ModelError {
    let message = full_message(mjcf).unwrap_or_else(|| error.to_string());
    ModelError::Mjcf { message: quoted(&message) }
}

/// Loads the text again with a larger buffer for the message. `None` when it can't be told.
fn full_message(mjcf: &str) -> Option<String> {
    let mut vfs = MjVfs::new();
    vfs.add_from_buffer(FILE_NAME.to_str().ok()?, mjcf.as_bytes()).ok()?;
    let mut message: [c_char; MESSAGE_BYTES] = [0; MESSAGE_BYTES];
    // SAFETY: the name is NUL-terminated, the file system outlives the call, and MuJoCo writes at most
    // `MESSAGE_BYTES` characters, the last of them NUL. A model is returned only if the text is valid after
    // all; nothing else points to it, so it is freed here.
    let text = unsafe {
        let model = mj_loadXML(FILE_NAME.as_ptr(), vfs.ffi(), message.as_mut_ptr(), MESSAGE_BYTES as i32);
        if !model.is_null() {
            mj_deleteModel(model);
            return None;
        }
        CStr::from_ptr(message.as_ptr())
    };
    let text = text.to_string_lossy().into_owned();
    (!text.is_empty()).then_some(text)
}
