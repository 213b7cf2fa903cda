//! What a user may change while characters move: gravity, friction, strength, mass.

use serde::{Deserialize, Serialize};

/// Factors on what the MJCF says; all 1 by default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Of gravity, in [0, 5]: 0 is free fall, 0.165 the moon.
    pub gravity: f32,
    /// Of the sliding friction between everything, in [0, 5]: about 0.1 is ice.
    pub friction: f32,
    /// Of the stiffness and the greatest torque of every motor, in [0, 5]: 0 is a rag doll.
    pub strength: f32,
    /// Of the mass and inertia of every body, in [0.2, 5].
    #[serde(default = "unchanged")]
    pub mass: f32,
}

/// Replay files of earlier versions have no mass.
fn unchanged() -> f32 {
    1.0
}

impl Default for Settings {
    fn default() -> Self {
        Self { gravity: 1.0, friction: 1.0, strength: 1.0, mass: 1.0 }
    }
}

/// A setting is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("expected the setting {field} between {least} and {most}, found {found}")]
#[non_exhaustive]
pub struct SettingError {
    /// Name of the setting.
    pub field: &'static str,
    /// Least value.
    pub least: f32,
    /// Greatest value.
    pub most: f32,
    /// The value.
    pub found: f32,
}

impl Settings {
    /// Checks every factor against its range.
    ///
    /// # Errors
    /// When one is outside, or no number.
    pub fn check(&self) -> Result<(), SettingError> {
        for (field, found, least) in [
            ("gravity", self.gravity, 0.0),
            ("friction", self.friction, 0.0),
            ("strength", self.strength, 0.0),
            ("mass", self.mass, 0.2),
        ] {
            if !(least..=5.0).contains(&found) {
                return Err(SettingError { field, least, most: 5.0, found });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_out_of_its_range_is_named() {
        assert_eq!(Settings::default().check(), Ok(()));
        for (settings, field) in [
            (Settings { gravity: f32::NAN, ..Settings::default() }, "gravity"),
            (Settings { friction: -0.1, ..Settings::default() }, "friction"),
            (Settings { strength: 5.1, ..Settings::default() }, "strength"),
            (Settings { mass: 0.1, ..Settings::default() }, "mass"),
        ] {
            assert_eq!(settings.check().map_err(|error| error.field), Err(field));
        }
    }
}
