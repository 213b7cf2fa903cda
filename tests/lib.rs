//! Shared helpers of the workspace's integration tests.

pub mod golden;

/// The character of this project.
pub const HUMANOID_MJCF: &str = include_str!("../assets/humanoid.xml");
