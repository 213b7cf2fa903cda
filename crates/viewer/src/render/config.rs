//! Choices made when a renderer is made.

use glam::Vec3;

/// Sun, sky and film. Linear colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Direction to the sun, any length.
    pub to_sun: Vec3,
    /// Radiance of the sun.
    pub sun: Vec3,
    /// Sky overhead.
    pub zenith: Vec3,
    /// Sky at the horizon, and the haze.
    pub horizon: Vec3,
    /// Light that comes back from the ground.
    pub bounce: Vec3,
    /// Multiplies everything before the film curve.
    pub exposure: f32,
    /// Radius of the soft edge of a shadow, metres.
    pub penumbra_m: f32,
}

/// Quality of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderConfig {
    /// Samples per pixel, 1 or 4.
    pub samples: u32,
    /// Side of the shadow map, texels.
    pub shadow_size: u32,
    /// Taps of the soft shadow.
    pub shadow_taps: u32,
    /// Furthest that shadows reach from the focus, metres.
    pub shadow_reach_m: f32,
    /// Size on the screen, pixels, below which a figure is drawn with the next coarser mesh, from the finest on.
    pub level_pixels: [f32; 3],
    /// Sun and sky.
    pub light: Light,
}

impl RenderConfig {
    /// Settings for a graphics card, or for a processor that draws.
    #[must_use]
    pub fn for_adapter(is_software: bool) -> Self {
        if is_software {
            let level_pixels = [f32::INFINITY, f32::INFINITY, 240.0];
            Self { shadow_size: 1024, shadow_taps: 8, level_pixels, ..Self::default() }
        } else {
            Self::default()
        }
    }
}

impl Default for RenderConfig {
    fn default() -> Self {
        Self {
            samples: 4,
            shadow_size: 2048,
            shadow_taps: 24,
            shadow_reach_m: 30.0,
            level_pixels: [400.0, 200.0, 100.0],
            light: Light::default(),
        }
    }
}

impl Default for Light {
    fn default() -> Self {
        Self {
            to_sun: Vec3::new(0.35, -0.75, 0.95),
            sun: Vec3::new(4.3, 3.9, 3.3),
            zenith: Vec3::new(0.16, 0.30, 0.58),
            horizon: Vec3::new(0.60, 0.69, 0.78),
            bounce: Vec3::new(0.13, 0.125, 0.12),
            exposure: 1.12,
            penumbra_m: 0.022,
        }
    }
}
