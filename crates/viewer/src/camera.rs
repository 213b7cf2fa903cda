//! Cameras: follow, orbit and fixed. One rig for the window and for pictures.

use glam::{Vec2, Vec3};
use policy_core::Heading;

use crate::render::View;

/// How the camera moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum CameraMode {
    /// Keeps its direction and follows the character.
    #[default]
    Follow,
    /// Swings round behind the character.
    Chase,
    /// Stays where it is and looks at the character.
    Fixed,
}

impl CameraMode {
    /// All modes.
    pub const ALL: [CameraMode; 3] = [CameraMode::Follow, CameraMode::Chase, CameraMode::Fixed];

    /// Name for panels.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            CameraMode::Follow => "orbit",
            CameraMode::Chase => "follow",
            CameraMode::Fixed => "fixed",
        }
    }
}

/// A camera that looks at a character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// How it moves.
    pub mode: CameraMode,
    /// Direction it looks in, seen from above, radians from world x.
    pub yaw: f32,
    /// How far it looks down, radians.
    pub pitch: f32,
    /// From the character, metres.
    pub distance: f32,
    /// What it looks at, smoothed.
    target: Vec3,
    /// Where it stands, while fixed.
    eye: Vec3,
    /// Height of the character's root body, against that of a person.
    size: f32,
}

/// Height of the root body of a standing person, metres.
const PERSON_ROOT_M: f32 = 0.881;

impl Default for Camera {
    fn default() -> Self {
        let mut camera = Self {
            mode: CameraMode::Follow,
            yaw: 0.0,
            pitch: 0.22,
            distance: 3.6,
            target: Vec3::new(0.0, 0.0, 0.85),
            eye: Vec3::ZERO,
            size: 1.0,
        };
        camera.eye = camera.orbit_eye(0.0);
        camera
    }
}

/// Seconds in which the camera makes up for two thirds of its lag.
const LAG_SECS: f32 = 0.18;
/// Radians per second at full stick.
const TURN_RATE: f32 = 2.4;

impl Camera {
    /// Looks at a character whose root body stands `root_height` metres above the ground.
    pub fn set_size(&mut self, root_height: f32) {
        let size = (root_height / PERSON_ROOT_M).clamp(0.2, 5.0);
        // The last bits of the height are no other size.
        self.size = if (size - 1.0).abs() < 0.02 { 1.0 } else { size };
    }

    /// Turns and tilts, radians; for a mouse.
    pub fn turn(&mut self, by: Vec2) {
        self.yaw -= by.x;
        self.pitch = (self.pitch + by.y).clamp(-0.15, 1.4);
    }

    /// Moves closer (below 1) or away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(1.0, 60.0);
    }

    /// Takes `dt` seconds of the right stick and of a root body at `root` that looks along `heading`, above ground of
    /// height `ground`.
    pub fn advance(&mut self, dt: f32, stick: [f32; 2], root: Vec3, heading: Heading, ground: f32) {
        self.turn(Vec2::new(stick[0], stick[1]) * (TURN_RATE * dt));
        let ease = 1.0 - (-dt / LAG_SECS).exp();
        // The height of the root counts half, so that steps do not shake the picture.
        let aim = Vec3::new(root.x, root.y, ground + 0.42 * self.size + 0.48 * (root.z - ground));
        if aim.is_finite() {
            self.target += (aim - self.target) * ease;
        }
        if self.mode == CameraMode::Chase {
            let off = Heading::from_angle(heading.angle() - self.yaw).angle();
            self.yaw += off * (1.0 - (-dt / 0.9).exp());
        }
        if self.mode != CameraMode::Fixed {
            self.eye = self.orbit_eye(0.0);
        }
    }

    /// Goes at once to where it would come to rest.
    pub fn settle(&mut self, root: Vec3, ground: f32) {
        self.advance(100.0, [0.0; 2], root, Heading::from_angle(self.yaw), ground);
    }

    /// Where stick up leads to.
    #[must_use]
    pub fn heading(&self) -> Heading {
        match self.mode {
            CameraMode::Fixed => Heading::from_direction((self.target - self.eye).truncate()),
            _ => Heading::from_angle(self.yaw),
        }
    }

    /// The picture's view, turned by `around` radians about the character.
    #[must_use]
    pub fn view(&self, around: f32) -> View {
        let eye = if self.mode == CameraMode::Fixed { self.eye } else { self.orbit_eye(around) };
        View { eye, target: self.target, fov: 0.62 }
    }

    fn orbit_eye(&self, around: f32) -> Vec3 {
        let (sin, cos) = (self.yaw + around).sin_cos();
        let back = Vec3::new(-cos * self.pitch.cos(), -sin * self.pitch.cos(), self.pitch.sin());
        let mut eye = self.target + back * self.distance;
        eye.z = eye.z.max(0.15);
        eye
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_settles_behind_its_character_and_looks_along_its_heading() {
        let mut camera = Camera { yaw: 1.0, ..Camera::default() };
        camera.settle(Vec3::new(3.0, 4.0, 0.88), 0.0);
        let view = camera.view(0.0);
        assert!((view.target.truncate() - Vec2::new(3.0, 4.0)).length() < 1e-4);
        let along = Heading::from_direction((view.target - view.eye).truncate());
        assert!((along.angle() - 1.0).abs() < 1e-5 && (camera.heading().angle() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn chasing_turns_towards_the_heading_of_the_character() {
        let mut camera = Camera { mode: CameraMode::Chase, ..Camera::default() };
        for _ in 0..300 {
            camera.advance(1.0 / 60.0, [0.0; 2], Vec3::Z, Heading::from_angle(-2.0), 0.0);
        }
        assert!((camera.yaw + 2.0).abs() < 0.05, "{}", camera.yaw);
    }
}
