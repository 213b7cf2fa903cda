//! The demo: draws the humanoid, reads pad, keyboard and mouse, and shows what the policies do.

pub mod analysis;
pub mod app;
pub mod assets;
pub mod camera;
pub mod cli;
pub mod desk;
pub mod dropped;
pub mod files;
pub mod gpu;
pub mod mannequin;
pub mod mesh;
pub mod overlay;
pub mod pads;
mod panels;
pub mod poses;
pub mod recorder;
pub mod render;
pub mod signals;
pub mod sim;
pub mod stage;
pub mod text;
pub mod window;
