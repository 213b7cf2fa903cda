//! Compiles MJCF text and says in full what is wrong with it.

use std::ffi::{CStr, c_char};

use mujoco_rs::error::MjModelError;
use mujoco_rs::mujoco_c::{mj_deleteModel, mj_loadXML};
use mujoco_rs::wrappers::mj_auxiliary::MjVfs;
use mujoco_rs::wrappers::mj_model::MjModel;

use crate::logging;
use crate::model_error::ModelError;

/// Room for MuJoCo's message; mujoco-rs keeps 99 characters of it, which cuts off the line number.
const MESSAGE_BYTES: usize = 1024;

const FILE_NAME: &CStr = c"model.xml";

/// Compiles `mjcf`.
pub(crate) fn compile(mjcf: &str) -> Result<MjModel, ModelError> {
    logging::install();
    MjModel::from_xml_string(mjcf).map_err(|error| mjcf_error(mjcf, &error))
}

/// The error for text that MuJoCo refused with `error`.
pub(crate) fn mjcf_error(mjcf: &str, error: &MjModelError) -> ModelError {
    let message = full_message(mjcf).unwrap_or_else(|| error.to_string());
    let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
    ModelError::Mjcf { message }
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
