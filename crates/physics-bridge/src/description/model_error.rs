//! Why a model can't be loaded.

use std::path::PathBuf;

use policy_core::contract::{PoseError, SettingError};
use policy_core::training::SkeletonError;

use super::file::quoted;

/// Why a [`Model`](crate::Model) can't be made of an MJCF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file can't be read.
    #[error("cannot read the MJCF file {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file was read and refused.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        error: Box<ModelError>,
    },
    /// The bytes are not text.
    #[error("expected MJCF as UTF-8 text, found an invalid byte at offset {offset}")]
    Utf8 {
        /// Bytes before it that are valid.
        offset: usize,
    },
    /// The XML is malformed, or no valid MJCF.
    #[error("expected a valid MJCF, found: {message}")]
    Mjcf {
        /// MuJoCo's words, on one line, with the element and the line in the XML.
        message: String,
    },
    /// The text is too long to be a character.
    #[error("expected an MJCF of at most {most} bytes, found {found}")]
    Length {
        /// Most bytes.
        most: usize,
        /// Bytes found.
        found: usize,
    },
    /// The text is malformed.
    #[error("line {line}: expected {expected}, found something else")]
    Xml {
        /// Line in the text, from 1.
        line: usize,
        /// What should be there.
        expected: &'static str,
    },
    /// The text holds what a character has no use for: something that reads files, loads plug-ins or runs a
    /// simulation while it is compiled.
    #[error("line {line}: expected an MJCF that stands alone, found {what}")]
    Forbidden {
        /// Line in the text, from 1.
        line: usize,
        /// Name of the element or attribute.
        what: String,
    },
    /// A size, count or number of rounds is too large.
    #[error("line {line}: expected {what} of element {element} to be at most {most}, found {found}")]
    Limit {
        /// Line in the text, from 1.
        line: usize,
        /// Name of the element.
        element: String,
        /// Name of the attribute, or what is counted.
        what: String,
        /// Most.
        most: f64,
        /// Found; not a number where the text has none.
        found: f64,
    },
    /// The pack holds no MJCF.
    #[error(
        "expected a pack with the MJCF of its body, found a pack without one, as those of version 1: pass the MJCF"
    )]
    NoMjcf,
    /// A named part does not exist.
    #[error("expected a {kind} named {name}, found none")]
    Missing {
        /// `body`, `joint`, `motor of the joint` or `geom`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A named part exists and is something else.
    #[error("expected {expected} for {kind} {name}, found something else")]
    Kind {
        /// `body`, `joint`, `actuator`, `motor of joint` or `geom`.
        kind: &'static str,
        /// Its name.
        name: String,
        /// What it should be.
        expected: &'static str,
    },
    /// A part of the character has no name.
    #[error("expected a name for {kind} number {index}, found none")]
    Unnamed {
        /// `body` or `joint`.
        kind: &'static str,
        /// MuJoCo's index of it.
        index: usize,
    },
    /// More or fewer parts than the skeleton has.
    #[error("expected {expected} {what}, found {found}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// The skeleton's number.
        expected: usize,
        /// The model's number.
        found: usize,
    },
    /// No body floats, or several.
    #[error("expected one body with a free joint, found {found}")]
    Root {
        /// Bodies with a free joint.
        found: usize,
    },
    /// The bodies and hinges make no skeleton.
    #[error("in the skeleton of the MJCF: {}", quoted(&error.to_string()))]
    Skeleton {
        /// What is wrong with it.
        error: SkeletonError,
    },
    /// The time step does not divide a control tick.
    #[error("expected a timestep that divides 1/{control_hz} s, found {timestep_secs} s")]
    Timestep {
        /// Control ticks per second.
        control_hz: f32,
        /// The option in the MJCF, seconds.
        timestep_secs: f64,
    },
    /// The time step could not be changed in the text.
    #[error(
        "expected an option timestep=\"...\" in the MJCF that can be set to {expected} s, found steps of {found} s"
    )]
    TimestepText {
        /// What it should be, seconds.
        expected: f64,
        /// What it is all the same, seconds.
        found: f64,
    },
    /// No body has a geom, so nothing could stand on the ground.
    #[error("expected a geom on at least one body of the character, found none")]
    NoGeoms,
    /// A motor or sensor reads or acts with a delay.
    #[error("expected motors and sensors without delay, found some with")]
    Delays,
    /// An integrator that can't be stepped in two halves.
    #[error("expected the integrator Euler, implicit or implicitfast, found RK4")]
    Integrator,
    /// Too little or too much working memory for each character.
    #[error("expected a size memory between {least} and {most} bytes, found {found}")]
    Memory {
        /// Least, bytes.
        least: i64,
        /// Most, bytes.
        most: i64,
        /// In the MJCF, bytes.
        found: i64,
    },
    /// The keyframe `stand` is no pose.
    #[error("in the keyframe stand: {error}")]
    Stand {
        /// What is wrong with it.
        error: PoseError,
    },
    /// A number of a [`Terrain`](crate::Terrain) is out of its range.
    #[error("expected {field} of the terrain between {least} and {most}, found {found}")]
    Terrain {
        /// Field of the terrain.
        field: &'static str,
        /// Least.
        least: f32,
        /// Most.
        most: f32,
        /// Given.
        found: f32,
    },
    /// A number of [`Settings`](crate::Settings) is out of its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
}
