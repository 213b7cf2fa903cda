//! Cameras: orbit, follow, fixed, first person and free. One rig for the window and for pictures.

mod mode;
mod room;

use glam::{Vec2, Vec3};
use policy_core::Heading;

use crate::render::View;
pub use mode::CameraMode;
use room::Room;

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
    /// Angle about the character from where the stick steers to where the picture is taken, radians. For pictures without a window.
    pub around: f32,
    /// What it looks at, smoothed.
    target: Vec3,
    /// Where it stands, while fixed or free.
    eye: Vec3,
    /// Eyes of the character, smoothed.
    head: Vec3,
    /// Height of the character's root body, against that of a person.
    size: f32,
    /// How far back it may stand.
    room: Room,
    /// How far back it stands beyond its distance, so that two players are seen, metres.
    further: f32,
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
            around: 0.0,
            target: Vec3::new(0.0, 0.0, 0.85),
            eye: Vec3::ZERO,
            head: Vec3::new(0.0, 0.0, 1.5),
            size: 1.0,
            room: Room::default(),
            further: 0.0,
        };
        camera.eye = camera.orbit_eye();
        camera
    }
}

/// Seconds in which the camera makes up for two thirds of its lag.
const LAG_SECS: f32 = 0.18;
/// Seconds in which the first person makes up for two thirds of its lag: steps must not shake the picture.
const HEAD_LAG_SECS: f32 = 0.06;
/// The first person's eye is so far before the middle of the head, metres.
const FACE_M: f32 = 0.17;
/// Radians per second at full stick.
const TURN_RATE: f32 = 2.4;
/// Vertical field of view, radians; the first person sees more.
const FOV: f32 = 0.62;
const FIRST_PERSON_FOV: f32 = 1.1;
/// Lowest eye, metres above the ground at height 0.
const LEAST_HEIGHT_M: f32 = 0.15;
/// Range of the pitch around a character, and of a camera that looks from where it is, radians.
const PITCH_AROUND: [f32; 2] = [-0.15, 1.4];
const PITCH_FROM: [f32; 2] = [-1.4, 1.4];
/// Speed of the free camera, metres per second, and its way for one notch of the wheel that doubles the distance of others.
const FLY_MPS: f32 = 4.0;
const FLY_M: f32 = 2.5;

/// Two players: distance of the camera for each metre between them, what it stands further back in any case, at most, metres, and
/// seconds in which it makes up for two thirds of its lag.
const APART_SHARE: f32 = 1.5;
const PLAYERS_MARGIN_M: f32 = 1.2;
const MOST_FURTHER_M: f32 = 25.0;
const FURTHER_SECS: f32 = 0.6;

impl Camera {
    /// Looks at a character whose root body stands `root_height` metres above the ground.
    pub fn set_size(&mut self, root_height: f32) {
        let size = (root_height / PERSON_ROOT_M).clamp(0.2, 5.0);
        // The last bits of the height are no other size.
        self.size = if (size - 1.0).abs() < 0.02 { 1.0 } else { size };
    }

    /// Moves in another way from now on. A free camera begins where the present one is.
    pub fn set_mode(&mut self, mode: CameraMode) {
        let view = self.view();
        if !self.mode.circles() {
            let along = (view.target - view.eye).normalize_or(Vec3::X);
            (self.yaw, self.pitch) = (along.y.atan2(along.x), -along.z.asin());
        }
        self.eye = view.eye;
        self.mode = mode;
        self.turn(Vec2::ZERO);
    }

    /// Behind a character that looks along `heading`, as at the start. The mode stays, but a camera that stands still
    /// circles again.
    pub fn reset(&mut self, heading: Heading) {
        let start = Self::default();
        if matches!(self.mode, CameraMode::Fixed | CameraMode::Free) {
            self.mode = start.mode;
        }
        (self.yaw, self.pitch, self.distance) = (heading.angle(), start.pitch, start.distance);
        self.eye = self.orbit_eye();
    }

    /// Turns and tilts, radians; for a mouse.
    pub fn turn(&mut self, by: Vec2) {
        let [lowest, highest] = match self.mode {
            CameraMode::FirstPerson | CameraMode::Free => PITCH_FROM,
            _ => PITCH_AROUND,
        };
        self.yaw -= by.x;
        self.pitch = (self.pitch + by.y).clamp(lowest, highest);
    }

    /// Moves closer (below 1) or away; a free camera ahead or back.
    pub fn zoom(&mut self, factor: f32) {
        if self.mode == CameraMode::Free {
            let ahead = -factor.max(1e-3).log2() * FLY_M;
            self.eye += self.along() * ahead;
        } else {
            self.distance = (self.distance * factor).clamp(1.0, 60.0);
        }
    }

    /// Flies a free camera for `dt` seconds: ahead, to the right and up, each in [-1, 1].
    pub fn fly(&mut self, dt: f32, [ahead, right, up]: [f32; 3]) {
        if self.mode == CameraMode::Free {
            let (sin, cos) = self.yaw.sin_cos();
            let by = self.along() * ahead + Vec3::new(sin, -cos, 0.0) * right + Vec3::Z * up;
            self.eye += by.clamp_length_max(1.0) * (FLY_MPS * dt);
            self.eye.z = self.eye.z.max(LEAST_HEIGHT_M);
        }
    }

    /// Takes `dt` seconds of the character's head at `head`, for the first person.
    pub fn follow_head(&mut self, dt: f32, head: Vec3) {
        if head.is_finite() {
            self.head += (head - self.head) * (1.0 - (-dt / HEAD_LAG_SECS).exp());
        }
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
        if self.mode.circles() {
            self.eye = self.orbit_eye();
        }
    }

    /// The line on which it looks at the character: from the character, to where it would stand if nothing were in the way,
    /// metres. `None` for a camera that does not circle.
    #[must_use]
    pub fn line(&self) -> Option<(Vec3, Vec3)> {
        let free = Self { room: Room::default(), ..*self };
        self.mode.circles().then(|| (self.target, free.orbit_eye() - self.target))
    }

    /// Takes `dt` seconds in which something hides the character from `hit` metres along [`Camera::line`] on.
    pub fn keep_clear(&mut self, dt: f32, hit: Option<f32>) {
        self.room.advance(dt, hit, self.distance + self.further);
        if self.mode.circles() {
            self.eye = self.orbit_eye();
        }
    }

    /// Takes `dt` seconds in which two players are `apart` metres from each other; 0 for one player. It steps back until both are in
    /// the picture, if it circles.
    pub fn make_room_for(&mut self, dt: f32, apart: f32) {
        let wanted = if apart > 0.0 {
            let missing = (apart * APART_SHARE - self.distance).max(0.0);
            (missing + PLAYERS_MARGIN_M).min(MOST_FURTHER_M)
        } else {
            0.0
        };
        self.further += (wanted - self.further) * (1.0 - (-dt.max(0.0) / FURTHER_SECS).exp());
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

    /// Who hears at the eye.
    #[cfg(feature = "native")]
    #[must_use]
    pub fn listener(&self) -> crate::sound::Listener {
        let view = self.view();
        let right = (view.target - view.eye).cross(Vec3::Z).normalize_or(Vec3::NEG_Y);
        crate::sound::Listener { at: view.eye, right }
    }

    /// The picture's view.
    #[must_use]
    pub fn view(&self) -> View {
        match self.mode {
            CameraMode::Fixed => View { eye: self.eye, target: self.target, fov: FOV },
            CameraMode::Free => View { eye: self.eye, target: self.eye + self.along(), fov: FOV },
            CameraMode::FirstPerson => {
                let eye = self.head + self.along() * FACE_M * self.size;
                View { eye, target: eye + self.along(), fov: FIRST_PERSON_FOV }
            }
            _ => View { eye: self.orbit_eye(), target: self.target, fov: FOV },
        }
    }

    /// Direction in which it looks.
    fn along(&self) -> Vec3 {
        let (sin, cos) = self.yaw.sin_cos();
        Vec3::new(cos * self.pitch.cos(), sin * self.pitch.cos(), -self.pitch.sin())
    }

    fn orbit_eye(&self) -> Vec3 {
        let (sin, cos) = (self.yaw + self.around).sin_cos();
        let back = Vec3::new(-cos * self.pitch.cos(), -sin * self.pitch.cos(), self.pitch.sin());
        let mut eye = self.target + back * self.room.limit(self.distance + self.further);
        eye.z = eye.z.max(LEAST_HEIGHT_M);
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
        let view = camera.view();
        assert!((view.target.truncate() - Vec2::new(3.0, 4.0)).length() < 1e-4);
        let along = Heading::from_direction((view.target - view.eye).truncate());
        assert!((along.angle() - 1.0).abs() < 1e-5 && (camera.heading().angle() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_picture_taken_from_the_side_keeps_clear_of_what_stands_there() {
        let mut camera = Camera { around: 1.2, ..Camera::default() };
        camera.settle(Vec3::new(0.0, 0.0, 0.88), 0.0);
        assert!(camera.heading().angle().abs() < 1e-6, "the stick steers along the camera's yaw");
        let (from, line) = camera.line().unwrap();
        assert!(
            (from + line).distance(camera.view().eye) < 1e-5,
            "what is looked for is on the line to the picture's eye"
        );
        camera.keep_clear(10.0, Some(1.5));
        assert!((camera.view().eye.distance(from) - 1.25).abs() < 0.01);
    }

    #[test]
    fn it_steps_back_until_two_players_are_in_the_picture() {
        let mut camera = Camera::default();
        let far = |camera: &Camera| camera.view().eye.distance(camera.view().target);
        let alone = far(&camera);
        camera.make_room_for(100.0, 8.0);
        assert!(far(&camera) > 8.0 && far(&camera) < 16.0, "{}", far(&camera));
        camera.make_room_for(100.0, 1e6);
        assert!(far(&camera) < 40.0, "{}", far(&camera));
        camera.make_room_for(100.0, f32::NAN);
        camera.make_room_for(100.0, 0.0);
        assert!((far(&camera) - alone).abs() < 1e-3, "{}", far(&camera));
    }

    #[test]
    fn chasing_turns_towards_the_heading_of_the_character() {
        let mut camera = Camera { mode: CameraMode::Chase, ..Camera::default() };
        for _ in 0..300 {
            camera.advance(1.0 / 60.0, [0.0; 2], Vec3::Z, Heading::from_angle(-2.0), 0.0);
        }
        assert!((camera.yaw + 2.0).abs() < 0.05, "{}", camera.yaw);
    }

    #[test]
    fn the_first_person_sees_from_the_head_and_turns_on_the_spot() {
        let mut camera = Camera::default();
        camera.set_mode(CameraMode::FirstPerson);
        camera.follow_head(10.0, Vec3::new(2.0, 0.0, 1.5));
        let before = camera.view();
        assert!(before.eye.distance(Vec3::new(2.0, 0.0, 1.5)) < 0.2);
        camera.turn(Vec2::new(-1.0, -1.0));
        let after = camera.view();
        assert!((after.target - after.eye).z > 0.5, "it can look up");
        assert!((camera.heading().angle() - 1.0).abs() < 1e-5);
        camera.set_mode(CameraMode::Follow);
        assert!(camera.pitch >= PITCH_AROUND[0], "an orbit can't look from below the ground");
    }

    #[test]
    fn a_free_camera_begins_where_the_other_was_and_flies() {
        for mode in CameraMode::ALL {
            let mut camera = Camera { yaw: 0.7, ..Camera::default() };
            camera.follow_head(10.0, Vec3::new(0.0, 0.0, 1.5));
            camera.set_mode(mode);
            camera.advance(0.1, [0.0; 2], Vec3::new(0.3, 0.0, 0.88), Heading::from_angle(2.0), 0.0);
            let before = camera.view();
            camera.set_mode(CameraMode::Free);
            let after = camera.view();
            let (a, b) = ((before.target - before.eye).normalize(), (after.target - after.eye).normalize());
            assert!(before.eye.distance(after.eye) < 1e-4 && a.distance(b) < 1e-4, "{mode:?}: {a} {b}");
            // The character leaves, the camera stays; then it flies ahead.
            camera.advance(1.0, [0.0; 2], Vec3::new(50.0, 0.0, 0.88), Heading::FORWARD, 0.0);
            assert_eq!(camera.view().eye, after.eye);
            camera.fly(0.5, [1.0, 0.0, 0.0]);
            let flown = camera.view().eye - after.eye;
            assert!((flown.length() - 2.0).abs() < 0.1, "{mode:?}: {flown}");
        }
    }

    #[test]
    fn a_reset_looks_along_the_heading_of_the_character_again() {
        for mode in CameraMode::ALL {
            let mut camera = Camera { yaw: 1.0, pitch: 1.2, distance: 30.0, ..Camera::default() };
            camera.set_mode(mode);
            camera.reset(Heading::from_angle(-0.5));
            camera.settle(Vec3::new(3.0, 4.0, 0.88), 0.0);
            let view = camera.view();
            let along = Heading::from_direction((view.target - view.eye).truncate());
            assert!((along.angle() + 0.5).abs() < 1e-4, "{mode:?}");
            assert!((camera.distance, camera.pitch) == (3.6, 0.22) && camera.mode != CameraMode::Free);
        }
    }
}
