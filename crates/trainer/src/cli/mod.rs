//! The verbs of the program.

pub(crate) mod normaliser;
pub(crate) mod train;
