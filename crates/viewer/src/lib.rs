//! The demo: draws characters, reads pad, keyboard and mouse, and shows what the policies do.

pub mod analysis;
pub mod app;
pub mod appearance;
pub mod assets;
pub mod camera;
pub mod cli;
pub mod dropped;
pub mod files;
pub mod frame_composer;
pub mod gpu;
pub mod mannequin;
pub mod mesh;
pub mod overlay;
pub mod pads;
mod panels;
pub mod playground;
pub mod pose_clip;
pub mod recorder;
pub mod render;
pub mod replays;
pub mod scene_setup;
pub mod signals;
pub mod sim;
pub mod text;
pub mod window;
