//! The demo: draws the humanoid, reads pad, keyboard and mouse, and shows what the policies do.

pub mod assets;
pub mod camera;
pub mod gpu;
pub mod mannequin;
pub mod mesh;
pub mod render;
pub mod sim;
pub mod cli;
pub mod stage;
