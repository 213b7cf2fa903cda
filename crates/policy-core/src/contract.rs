//! What every physics of a character has in common: poses, pushes, settings, uneven ground, props, fixtures and joints,
//! the control rate, and limits of plausible motion. [`PhysicsCharacter`] is one character, whatever the engine.
//!
//! The physics crates of this project export these names. An engine of your own can use them to behave alike.

mod description_error;
mod fixture;
mod height_field;
mod joint;
mod physics_character;
mod pose;
mod prop;
mod push;
mod settings;
mod solid;

pub use description_error::{DescriptionError, within};
pub use fixture::{Fixture, FixtureShape, MAX_HEIGHTS, MAX_TRIANGLES, TRIANGLE_DEPTH_M};
pub use height_field::{HeightField, HeightFieldError};
pub use joint::{DAMPING_RANGE, Joint, ROPE_RANGE_M};
pub use physics_character::PhysicsCharacter;
pub use pose::{Pose, PoseError, ROOT_QPOS, ROOT_QVEL};
pub use prop::{FRICTION_RANGE, MASS_RANGE_KG, Motion, Prop};
pub use push::{
    MAX_FORCE_N, MAX_IMPULSE_NS, MAX_PUSH_SECS, MAX_PUSHED_MPS, PushError, check_impulse, check_push,
};
pub use settings::{SettingError, Settings};
pub use solid::{MAX_HULL_POINTS, SIZE_RANGE_M, Solid};

/// Control ticks per second, unless a pack says otherwise.
pub const CONTROL_HZ: u32 = 30;

/// Speed at which the humanoid's policy that only walks can start, metres per second.
pub const WALKING_START_MPS: f32 = 1.2;

/// Largest plausible speed of a body, metres per second.
pub const MAX_SPEED_MPS: f32 = 50.0;

/// Largest plausible angular speed of a body, radians per second. Motors of normal strength that are driven at
/// random spin a foot at 35 rad/s.
pub const MAX_SPIN_RADPS: f32 = 200.0;

/// How deep the origin of a body may be below the ground, metres. Generous, because an edge of a steep step
/// may be inside a foot.
pub const MAX_DEPTH_M: f32 = 0.5;

/// How far a body may be from the origin of the world, metres. Further away, single precision resolves a
/// position to a millimetre only.
pub const MAX_DISTANCE_M: f32 = 10_000.0;
