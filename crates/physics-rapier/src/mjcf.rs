//! The text of an MJCF, checked before and after Rapier's loader reads it.
//!
//! The loader follows `include` and file names. A pack comes from anywhere, so text that names a file is refused.

use rapier3d_mjcf::mjcf_rs::Model as Description;
use rapier3d_mjcf::{MjcfLoaderOptions, MjcfRobot};
use roxmltree::{Document, Node};

use crate::model_error::ModelError;

/// Most bytes of an MJCF.
const MOST_BYTES: usize = 1 << 20;

/// Deepest nesting of elements: the loader calls itself for each level.
const MOST_LEVELS: usize = 200;

/// Attributes that name files or folders.
const FILES: [&str; 4] = ["file", "meshdir", "texturedir", "assetdir"];

/// What the loader makes of an MJCF, planes included: it skips them by default.
pub(crate) fn parse(text: &str) -> Result<(MjcfRobot, Description), ModelError> {
    if text.len() > MOST_BYTES {
        return Err(ModelError::Length { most: MOST_BYTES, found: text.len() });
    }
    let document = Document::parse(text).map_err(|error| ModelError::Mjcf { message: error.to_string() })?;
    check(document.root_element(), 1, &document)?;
    let options = MjcfLoaderOptions { skip_plane_geoms: false, ..MjcfLoaderOptions::default() };
    MjcfRobot::from_str(text, options, "").map_err(|error| ModelError::Mjcf { message: format!("{error:#}") })
}

/// Refuses what reads files, and nesting that exhausts the stack.
fn check(node: Node<'_, '_>, level: usize, document: &Document<'_>) -> Result<(), ModelError> {
    let forbid = |what: String| {
        let line = document.text_pos_at(node.range().start).row;
        Err(ModelError::Forbidden { line, what })
    };
    let name = node.tag_name().name();
    if level > MOST_LEVELS {
        return forbid(format!("more than {MOST_LEVELS} levels of elements"));
    }
    if ["include", "plugin", "extension"].contains(&name) {
        return forbid(format!("the element {name}"));
    }
    if let Some(file) = node.attributes().find(|a| FILES.contains(&a.name())) {
        return forbid(format!("the attribute {} of {name}", file.name()));
    }
    node.children().filter(Node::is_element).try_for_each(|child| check(child, level + 1, document))
}
