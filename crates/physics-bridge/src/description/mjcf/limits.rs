//! Bounds on MJCF from strangers, checked before MuJoCo sees the text: what would read files, exhaust memory or
//! run for minutes while it is compiled. Refuses with the line. Whether the text is valid MJCF is MuJoCo's to say.

use super::super::file::quoted;
use super::super::model_error::ModelError;
use super::xml::{Attributes, Tag, Tags};

/// Longest text, bytes.
pub(in crate::description) const MOST_BYTES: usize = 4 << 20;

/// Most elements, copies by `replicate` included.
const MOST_ELEMENTS: f64 = 4096.0;

/// Deepest nesting of elements.
const DEEPEST: usize = 100;

/// Memory for pixels and heights, bytes.
const MOST_MEMORY: f64 = (128 << 20) as f64;

/// Bytes for each pixel or height of an element. A texture may have six sides.
const PIXEL_BYTES: &[(&str, f64)] = &[("texture", 24.0), ("hfield", 8.0), ("camera", 64.0)];

/// What a character has no use for: it reads files, loads plug-ins, makes many bodies, or runs a simulation while it is
/// compiled.
const FORBIDDEN: &[&str] =
    &["include", "plugin", "extension", "muscle", "lengthrange", "composite", "flexcomp", "flex"];

/// Most elements of a name, copies included. MuJoCo's working memory grows with the square of the bodies, and it ends
/// the process when that memory is full.
const MOST_OF: [(&str, f64); 3] = [("body", 512.0), ("joint", 1024.0), ("geom", 1024.0)];

/// Largest number in an attribute that sets a size or a number of rounds. An element `*` is any. An attribute
/// `*` is any, and then every number in its value is a size.
const LARGEST: &[(&str, &str, f64)] = &[
    ("*", "count", 4096.0),
    ("*", "cellcount", 4096.0),
    ("*", "nsample", 0.0),
    ("*", "resolution", 4096.0),
    ("hfield", "nrow", 2048.0),
    ("hfield", "ncol", 2048.0),
    ("texture", "width", 4096.0),
    ("texture", "height", 24576.0),
    ("mesh", "params", 64.0),
    ("numeric", "size", 4096.0),
    ("user", "dim", 4096.0),
    ("contact", "num", 4096.0),
    ("option", "iterations", 1000.0),
    ("option", "ls_iterations", 1000.0),
    ("option", "noslip_iterations", 1000.0),
    ("option", "ccd_iterations", 1000.0),
    ("option", "sdf_iterations", 1000.0),
    ("option", "sdf_initpoints", 1000.0),
    ("size", "memory", (256 << 20) as f64),
    ("size", "nstack", (16 << 20) as f64),
    ("size", "njmax", 65536.0),
    ("size", "nconmax", 16384.0),
    ("size", "*", 4096.0),
];

/// Refuses text that MuJoCo must not see.
pub(super) fn check(mjcf: &str) -> Result<(), ModelError> {
    if mjcf.len() > MOST_BYTES {
        return Err(ModelError::Length { most: MOST_BYTES, found: mjcf.len() });
    }
    let mut tags = Tags::of(mjcf);
    let mut totals = Totals::default();
    // Copies that `replicate` makes of what is in each open element.
    let mut open: Vec<f64> = Vec::new();
    while let Some(tag) = tags.next()? {
        let line = tags.line();
        match tag {
            Tag::Close => drop(open.pop()),
            Tag::Open { name, attributes, empty } => {
                if open.is_empty() && name != "mujoco" {
                    return Err(ModelError::Xml { line, expected: "the element mujoco around everything" });
                }
                let copies = open.last().copied().unwrap_or(1.0);
                let counts = totals.element(line, name, attributes, copies)?;
                if !empty {
                    open.push(copies * if name == "replicate" { counts } else { 1.0 });
                    at_most(line, name, "nesting", DEEPEST as f64, open.len() as f64)?;
                }
            }
        }
    }
    Ok(())
}

/// What all elements need together.
#[derive(Default)]
struct Totals {
    elements: f64,
    of: [f64; MOST_OF.len()],
    bytes: f64,
}

impl Totals {
    /// Checks and adds up an element of which there are so many `copies`. Returns its `count`, or 1.
    fn element(
        &mut self,
        line: usize,
        name: &str,
        attributes: Attributes<'_>,
        copies: f64,
    ) -> Result<f64, ModelError> {
        let forbidden = |what: &str| Err(ModelError::Forbidden { line, what: quoted(what) });
        if FORBIDDEN.contains(&name) {
            return forbidden(name);
        }
        let (mut counts, mut pixels) = (1.0, 1.0);
        for (attribute, value) in attributes {
            if attribute.starts_with("file") {
                return forbidden(attribute);
            }
            if value == "muscle" {
                return forbidden(value);
            }
            if value.contains("&#") {
                return Err(ModelError::Xml { line, expected: "attributes without character references" });
            }
            let Some(limit) = largest(name, attribute) else { continue };
            let product = checked_product(line, name, attribute, value, limit)?;
            match attribute {
                "count" | "cellcount" => counts *= product,
                "nrow" | "ncol" | "width" | "height" | "resolution" => pixels *= product,
                _ => {}
            }
        }
        self.elements += copies * counts;
        at_most(line, name, "elements, copies included,", MOST_ELEMENTS, self.elements)?;
        for ((of, most), total) in MOST_OF.into_iter().zip(&mut self.of) {
            *total += if name == of { copies } else { 0.0 };
            at_most(line, name, "number, copies included,", most, *total)?;
        }
        let bytes = PIXEL_BYTES.iter().find(|(element, _)| *element == name).map_or(0.0, |(_, bytes)| *bytes);
        self.bytes += copies * bytes * pixels;
        at_most(line, name, "bytes of pixels and heights", MOST_MEMORY, self.bytes)?;
        Ok(counts)
    }
}

/// The limit on the numbers in an attribute, where it has one.
fn largest(element: &str, attribute: &str) -> Option<f64> {
    let fits = |pattern: &str, name: &str| pattern == "*" || pattern == name;
    LARGEST.iter().find(|(e, a, _)| fits(e, element) && fits(a, attribute)).map(|&(_, _, most)| most)
}

/// Product of the numbers in `value`, each checked.
fn checked_product(
    line: usize,
    element: &str,
    attribute: &str,
    value: &str,
    most: f64,
) -> Result<f64, ModelError> {
    let mut product = 1.0;
    for word in value.split_ascii_whitespace() {
        let (digits, unit) = match word.as_bytes().last() {
            // The last byte is one of ASCII, so the word can be cut before it.
            Some(b'K') => (&word[..word.len() - 1], f64::from(1 << 10)),
            Some(b'M') => (&word[..word.len() - 1], f64::from(1 << 20)),
            Some(b'G') => (&word[..word.len() - 1], f64::from(1 << 30)),
            Some(b'T' | b'P' | b'E') => (word, f64::NAN),
            _ => (word, 1.0),
        };
        let found = unit * digits.parse::<f64>().unwrap_or(f64::NAN);
        at_most(line, element, attribute, most, found)?;
        product *= found.max(1.0);
    }
    Ok(product)
}

fn at_most(line: usize, element: &str, what: &str, most: f64, found: f64) -> Result<(), ModelError> {
    // Not-a-number is too much.
    if found <= most {
        return Ok(());
    }
    Err(ModelError::Limit { line, element: quoted(element), what: quoted(what), most, found })
}
