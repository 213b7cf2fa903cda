//! Why a model can't be made.

use policy_core::contract::PoseError;
use policy_core::training::SkeletonError;

/// Why a [`Model`](crate::Model) can't be made of an MJCF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The text is too long to be a character.
    #[error("expected an MJCF of at most {most} bytes, found {found}")]
    Length {
        /// Most bytes.
        most: usize,
        /// Bytes found.
        found: usize,
    },
    /// The text is no XML, or no MJCF that the loader can read.
    #[error("expected a valid MJCF, found: {message}")]
    Mjcf {
        /// The parser's words.
        message: String,
    },
    /// The text names another file.
    #[error("line {line}: expected an MJCF that stands alone, found {what}")]
    Forbidden {
        /// Line in the text, from 1.
        line: u32,
        /// The element or attribute.
        what: String,
    },
    /// The pack holds no MJCF.
    #[error(
        "expected a pack with the MJCF of its body, found a pack without one, as those of version 1: pass the MJCF"
    )]
    NoMjcf,
    /// A named part does not exist.
    #[error("expected a {kind} named \"{name}\", found none")]
    Missing {
        /// `body`, `hinge` or `motor of hinge`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// The MJCF has a part that the skeleton lacks.
    #[error("expected only bodies and hinges of the skeleton, found the {kind} \"{name}\"")]
    Unexpected {
        /// `body` or `joint`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A part has no name.
    #[error("expected a name for {kind} number {index}, found none")]
    Unnamed {
        /// `body` or `joint`.
        kind: &'static str,
        /// Its index in the loader's order.
        index: usize,
    },
    /// A named part is something else.
    #[error("expected {expected} for {kind} \"{name}\", found {found}")]
    Kind {
        /// `body`, `hinge`, `joint` or `motor of hinge`.
        kind: &'static str,
        /// Its name.
        name: String,
        /// What it should be.
        expected: String,
        /// What it is.
        found: String,
    },
    /// No body floats, or several.
    #[error("expected one body with a free joint, found {found}")]
    Root {
        /// Bodies with a free joint.
        found: usize,
    },
    /// The bodies and hinges make no skeleton.
    #[error("in the skeleton of the MJCF: {source}")]
    Skeleton {
        /// What is wrong with it.
        source: SkeletonError,
    },
    /// No body has a geom, so nothing could stand on the ground.
    #[error("expected a geom on at least one body of the character, found none")]
    NoGeoms,
    /// The time step does not divide a control tick.
    #[error("expected a timestep that divides 1/{control_hz} s, found {timestep_secs} s")]
    Timestep {
        /// Control ticks per second.
        control_hz: f32,
        /// The option in the MJCF, seconds.
        timestep_secs: f64,
    },
    /// The keyframe `stand` is no pose.
    #[error("in the keyframe stand: {source}")]
    Stand {
        /// What is wrong with it.
        source: PoseError,
    },
}
