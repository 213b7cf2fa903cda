//! What other libraries would cost in the places where this project has code of its own: evaluating a policy
//! (`inference`) and taking a gradient step (`training`). Each half is a feature of its name, so that neither waits
//! for the other's libraries to compile.

#![warn(missing_docs)]

#[cfg(feature = "inference")]
pub mod inference;
#[cfg(feature = "training")]
pub mod training;
