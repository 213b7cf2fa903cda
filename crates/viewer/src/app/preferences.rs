//! What the player has chosen once and for all: the layout's size, senses, quality. Kept with the layout.

use serde::{Deserialize, Serialize};

use super::KeyMap;
use crate::render::RenderConfig;

/// How finely pictures are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Quality {
    /// What the adapter can draw in time.
    #[default]
    Automatic,
    /// For slow machines: coarse shadows and edges.
    Low,
    /// What a processor draws in time.
    Medium,
    /// What a graphics card draws in time.
    High,
}

impl Quality {
    /// All of them.
    pub const ALL: [Quality; 4] = [Quality::Automatic, Quality::Low, Quality::Medium, Quality::High];

    /// Name for panels.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Quality::Automatic => "automatic",
            Quality::Low => "low",
            Quality::Medium => "medium",
            Quality::High => "high",
        }
    }

    /// What the renderer is to do.
    #[must_use]
    pub fn render_config(self, is_software: bool) -> RenderConfig {
        match self {
            Quality::Automatic => RenderConfig::for_adapter(is_software),
            Quality::Low => RenderConfig {
                samples: 1,
                shadow_size: 512,
                shadow_taps: 4,
                ..RenderConfig::for_adapter(true)
            },
            Quality::Medium => RenderConfig::for_adapter(true),
            Quality::High => RenderConfig::default(),
        }
    }
}

/// What the player has chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Preferences {
    /// All panels instead of the simple layout.
    pub advanced: bool,
    /// The first steps are shown until they are done or dismissed.
    pub shows_first_steps: bool,
    /// The tour plays when there was no input for a while.
    pub plays_tour: bool,
    /// Size of texts and buttons; 1 is that of the system. See [`Preferences::UI_SCALES`].
    pub ui_scale: f32,
    /// Of the mouse on the camera; 1 is 0.006 radians a point. In [`Preferences::SENSITIVITY`].
    pub mouse_sensitivity: f32,
    /// Of the right stick and its keys on the camera; 1 is 2.4 radians a second. In [`Preferences::SENSITIVITY`].
    pub stick_sensitivity: f32,
    /// Up looks down, for mouse and stick.
    pub inverts_y: bool,
    /// How finely pictures are drawn.
    pub quality: Quality,
    /// Footsteps, impacts and bells are played where there is a device.
    pub plays_sound: bool,
    /// Of the sounds, from 0 to 1.
    pub volume: f32,
    /// Which key does what.
    pub keys: KeyMap,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            advanced: false,
            shows_first_steps: true,
            plays_tour: true,
            ui_scale: 1.0,
            mouse_sensitivity: 1.0,
            stick_sensitivity: 1.0,
            inverts_y: false,
            quality: Quality::default(),
            plays_sound: true,
            volume: Self::USUAL_VOLUME,
            keys: KeyMap::default(),
        }
    }
}

impl Preferences {
    /// Volume at the first start.
    pub const USUAL_VOLUME: f32 = 0.6;
    /// Range of the sensitivities.
    pub const SENSITIVITY: std::ops::RangeInclusive<f32> = 0.2..=3.0;
    /// Sizes that are offered; the first is the least and the last the largest that a file may say.
    pub const UI_SCALES: [f32; 6] = [0.75, 1.0, 1.25, 1.5, 1.75, 2.0];

    /// The same with every number in its range. One that is not finite becomes the default.
    #[must_use]
    pub fn clamped(self) -> Self {
        let within = |value: f32, low: f32, high: f32| {
            if value.is_finite() { value.clamp(low, high) } else { 1.0 }
        };
        let volume = if self.volume.is_finite() { self.volume.clamp(0.0, 1.0) } else { Self::USUAL_VOLUME };
        let (least, most) = (*Self::SENSITIVITY.start(), *Self::SENSITIVITY.end());
        Self {
            ui_scale: within(self.ui_scale, Self::UI_SCALES[0], Self::UI_SCALES[Self::UI_SCALES.len() - 1]),
            mouse_sensitivity: within(self.mouse_sensitivity, least, most),
            stick_sensitivity: within(self.stick_sensitivity, least, most),
            volume,
            ..self
        }
    }

    /// A turn of the camera by the mouse, as the player wants it.
    #[must_use]
    pub fn mouse(&self, by: glam::Vec2) -> glam::Vec2 {
        self.signed(by * self.mouse_sensitivity)
    }

    /// A turn of the camera by the stick, as the player wants it.
    #[must_use]
    pub fn stick(&self, by: [f32; 2]) -> [f32; 2] {
        self.signed(glam::Vec2::from_array(by) * self.stick_sensitivity).to_array()
    }

    /// The volume of the sounds as they are to be played: 0 while they are off.
    #[must_use]
    pub fn loudness(&self) -> f32 {
        if self.plays_sound { self.volume } else { 0.0 }
    }

    fn signed(&self, by: glam::Vec2) -> glam::Vec2 {
        if self.inverts_y { glam::Vec2::new(by.x, -by.y) } else { by }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_are_clamped_and_a_field_that_lacks_is_the_default() {
        let read: Preferences = ron::from_str("(ui_scale: 99.0, mouse_sensitivity: -1.0)").unwrap();
        let expected = Preferences { ui_scale: 2.0, mouse_sensitivity: 0.2, ..Preferences::default() };
        assert_eq!(read.clamped(), expected);
        let broken = Preferences { stick_sensitivity: f32::NAN, volume: f32::NAN, ..Preferences::default() };
        assert_eq!(broken.clamped(), Preferences::default());
        assert_eq!(ron::from_str::<Preferences>("(volume: 11)").unwrap().clamped().volume, 1.0);
        assert!(ron::from_str::<Preferences>("(bass: 11)").is_err());
    }

    #[test]
    fn sounds_that_are_off_have_no_loudness() {
        let chosen = Preferences { volume: 0.4, ..Preferences::default() };
        assert_eq!(chosen.loudness(), 0.4);
        assert_eq!(Preferences { plays_sound: false, ..chosen }.loudness(), 0.0);
    }

    #[test]
    fn mouse_and_stick_are_scaled_and_turned_over() {
        let chosen = Preferences {
            mouse_sensitivity: 2.0,
            stick_sensitivity: 0.5,
            inverts_y: true,
            ..Preferences::default()
        };
        assert_eq!(chosen.mouse(glam::Vec2::new(1.0, 2.0)), glam::Vec2::new(2.0, -4.0));
        assert_eq!(chosen.stick([1.0, 1.0]), [0.5, -0.5]);
    }

    #[test]
    fn lower_quality_is_less_to_draw() {
        let cost = |quality: Quality| {
            let config = quality.render_config(false);
            config.samples * config.shadow_size * config.shadow_size * config.shadow_taps
        };
        assert!(cost(Quality::Low) < cost(Quality::Medium) && cost(Quality::Medium) < cost(Quality::High));
        assert_eq!(Quality::Automatic.render_config(true), RenderConfig::for_adapter(true));
    }
}
