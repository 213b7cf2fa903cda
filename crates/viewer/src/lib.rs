//! The demo: draws characters, reads pad, keyboard and mouse, and shows what the policies do.
//!
//! Without the feature `native` there is what draws: [`render`], [`mesh`], [`camera`], [`things`] and [`gpu`]. The page in `web/` is made
//! of these.

#[cfg(feature = "native")]
pub mod analysis;
#[cfg(feature = "native")]
pub mod app;
#[cfg(feature = "native")]
pub mod appearance;
#[cfg(feature = "native")]
pub mod assets;
#[cfg(feature = "native")]
pub mod best_time;
#[cfg(feature = "native")]
mod breath;
pub mod camera;
#[cfg(feature = "native")]
pub mod cli;
#[cfg(feature = "native")]
pub mod dropped;
pub mod files;
#[cfg(feature = "native")]
pub mod frame_composer;
pub mod gpu;
pub mod landmarks;
#[cfg(feature = "native")]
pub mod mannequin;
pub mod mesh;
#[cfg(feature = "native")]
pub mod overlay;
#[cfg(feature = "native")]
pub mod pads;
#[cfg(feature = "native")]
mod panels;
#[cfg(feature = "native")]
pub mod pose_clip;
#[cfg(feature = "native")]
pub mod recorder;
pub mod render;
#[cfg(feature = "native")]
pub mod replays;
#[cfg(feature = "native")]
pub mod scene_setup;
#[cfg(feature = "native")]
pub mod signals;
#[cfg(feature = "native")]
pub mod sim;
#[cfg(feature = "native")]
pub mod sound;
#[cfg(feature = "native")]
pub mod text;
pub mod things;
#[cfg(feature = "native")]
pub mod window;
