//! Blend modes side by side: one view for each mode, the same stick for all, falls counted.

use glam::Vec3;
use policy_core::BlendMode;

use super::App;
use crate::render::{Scene, View};
use crate::scene_setup::{Picture, set_scene};
use crate::sim::{SceneKind, SimConfig};

/// A view follows its character within this time, seconds.
const FOLLOW_SECS: f32 = 0.12;
/// What is farther away than this was put there, metres.
const JUMP_M: f32 = 3.0;

/// What a comparison needs besides the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// What was there before it, to go back to.
    before: Option<(SimConfig, BlendMode)>,
    /// From the player to the character of each view, as the cameras have it, metres.
    offsets: [Vec3; BlendMode::ALL.len()],
}

impl App {
    /// Views beside each other: one, or one for each blend mode.
    #[must_use]
    pub fn views(&self) -> usize {
        if self.sim.config().comparison { BlendMode::ALL.len() } else { 1 }
    }

    /// The part of the window that a view has, points: as wide as the others, between the panels at the sides.
    #[must_use]
    pub fn part(&self, view: usize, screen: egui::Rect) -> egui::Rect {
        let views = self.views();
        if views == 1 {
            return screen;
        }
        let between = if self.free.width() > 0.0 { self.free.x_range() } else { screen.x_range() };
        let width = between.span() / views as f32;
        let left = between.min + width * view as f32;
        egui::Rect::from_x_y_ranges(left..=left + width, screen.y_range())
    }

    /// Starts a comparison, or ends it and goes back to what was before.
    pub(super) fn compare(&mut self, starts: bool) {
        let config = *self.sim.config();
        if starts == config.comparison {
            return;
        }
        let kept = self.comparison.before.take();
        self.comparison = Comparison::default();
        if starts {
            self.comparison.before = Some((config, self.sim.blend_mode()));
            return self.begin_in(config.compared());
        }
        let (before, mode) = kept.unwrap_or((config.alone(), BlendMode::default()));
        self.begin_in(before);
        self.sim.set_blend_mode(mode);
    }

    /// Begins anew in another world, with the camera behind the player.
    fn begin_in(&mut self, config: SimConfig) {
        self.rebuild(config);
        let player = &self.sim.player().state;
        self.camera.settle(player.root().position, player.ground_height);
    }

    /// The views take `dt` seconds to follow their characters, `alpha` of the way into the last tick.
    pub(super) fn follow_compared(&mut self, dt: f32, alpha: f32) {
        if self.views() == 1 {
            return;
        }
        let root = |index| self.sim.poses(index, alpha).positions[0];
        let (player, share) = (root(0), 1.0 - (-dt / FOLLOW_SECS).exp());
        for (index, offset) in self.comparison.offsets.iter_mut().enumerate() {
            let wanted = root(index) - player;
            let far = offset.distance(wanted) > JUMP_M;
            *offset = if far { wanted } else { offset.lerp(wanted, share) };
        }
    }

    /// The eye of a view.
    fn eye_of(&self, view: usize) -> View {
        let by = self.comparison.offsets.get(view).copied().unwrap_or_default();
        let seen = self.camera.view();
        if self.views() == 1 { seen } else { View { eye: seen.eye + by, target: seen.target + by, ..seen } }
    }

    /// Sets the scene for the next picture of a view; a comparison shows one character in each.
    pub fn set_scene(&self, scene: &mut Scene, view: usize) {
        let mut shown = self.layout.shown;
        shown.collision_shapes |= !self.has_mesh;
        let picture = Picture {
            view: self.eye_of(view),
            alone: (self.views() > 1).then_some(view),
            alpha: self.alpha(),
            shown: &shown,
            trail: &self.trail,
        };
        set_scene(scene, &self.sim, &picture);
        if let Some(grab) = &self.grab
            && let Some(from) = self.origin_of(grab.held)
        {
            scene.arrow(from, from + grab.pull, 0.012, [0.95, 0.3, 0.1, 1.0]);
        }
    }
}

impl SimConfig {
    /// A comparison of all blend modes on the empty floor, for the rest as this one.
    #[must_use]
    pub fn compared(self) -> Self {
        Self { scene: SceneKind::Empty, characters: BlendMode::ALL.len(), comparison: true, ..self }
    }

    /// One character that is compared with no other, for the rest as this one.
    #[must_use]
    pub fn alone(self) -> Self {
        Self { characters: 1, comparison: false, ..self }
    }
}
