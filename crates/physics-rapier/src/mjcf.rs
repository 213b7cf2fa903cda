//! The text of an MJCF, checked before and after Rapier's loader reads it.
//!
//! The loader follows `include` and file names. A pack comes from anywhere, so text that names a file is refused.

use rapier3d_mjcf::mjcf_rs::Model as Description;
use rapier3d_mjcf::{MjcfLoaderOptions, MjcfRobot};
use roxmltree::{Document, Node};

use crate::model_error::ModelError;

/// Most bytes of an MJCF.
const MOST_BYTES: usize = 1 << 20;

/// Deepest nesting of elements. Parsers call themselves for each level.
const MOST_LEVELS: usize = 100;

/// Attributes that name files or folders.
const FILES: [&str; 4] = ["file", "meshdir", "texturedir", "assetdir"];

/// What the loader makes of an MJCF, planes included: it skips them by default.
pub(crate) fn parse(text: &str) -> Result<(MjcfRobot, Description), ModelError> {
    if text.len() > MOST_BYTES {
        return Err(ModelError::Length { most: MOST_BYTES, found: text.len() });
    }
    check_levels(text)?;
    let document = Document::parse(text).map_err(|error| ModelError::Mjcf { message: error.to_string() })?;
    check(document.root_element(), &document)?;
    let options = MjcfLoaderOptions { skip_plane_geoms: false, ..MjcfLoaderOptions::default() };
    MjcfRobot::from_str(text, options, "").map_err(|error| ModelError::Mjcf { message: format!("{error:#}") })
}

/// Refuses nesting that would exhaust the stack, before any parser sees it.
fn check_levels(text: &str) -> Result<(), ModelError> {
    let (mut rest, mut level) = (text, 0_usize);
    while let Some(start) = rest.find('<') {
        rest = &rest[start..];
        let passed = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">")];
        let length = match passed.iter().find(|(from, _)| rest.starts_with(from)) {
            Some((from, to)) => rest[from.len()..].find(to).map(|at| from.len() + at + to.len()),
            None => tag_length(rest),
        };
        // What does not end is the parser's to report, without another level.
        let Some(length) = length else { break };
        let (tag, after) = rest.split_at(length);
        if tag.starts_with("</") {
            level = level.saturating_sub(1);
        } else if !tag.starts_with("<!") && !tag.starts_with("<?") && !tag.ends_with("/>") {
            level += 1;
        }
        if level > MOST_LEVELS {
            let line = text[..text.len() - after.len()].lines().count() as u32;
            return Err(ModelError::Forbidden {
                line,
                what: format!("more than {MOST_LEVELS} levels of elements"),
            });
        }
        rest = after;
    }
    Ok(())
}

/// Bytes of the tag that `text` begins with. A `>` in quotes does not end it.
fn tag_length(text: &str) -> Option<usize> {
    let mut quote = None;
    let end = text.bytes().position(|byte| {
        match quote {
            Some(open) if byte == open => quote = None,
            None if byte == b'"' || byte == b'\'' => quote = Some(byte),
            None => return byte == b'>',
            Some(_) => {}
        }
        false
    });
    end.map(|end| end + 1)
}

/// Refuses what reads files.
fn check(node: Node<'_, '_>, document: &Document<'_>) -> Result<(), ModelError> {
    let forbid = |what: String| {
        let line = document.text_pos_at(node.range().start).row;
        Err(ModelError::Forbidden { line, what })
    };
    let name = node.tag_name().name();
    if ["include", "plugin", "extension"].contains(&name) {
        return forbid(format!("the element {name}"));
    }
    if let Some(file) = node.attributes().find(|a| FILES.contains(&a.name())) {
        return forbid(format!("the attribute {} of {name}", file.name()));
    }
    node.children().filter(Node::is_element).try_for_each(|child| check(child, document))
}
