//! The demo: draws the humanoid, reads pad, keyboard and mouse, and shows what the policies do.

pub mod mannequin;
