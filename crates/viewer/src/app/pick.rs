//! The mouse in the picture: turns the camera, pulls bodies.

use egui::{PointerButton, Rect, Ui};
use glam::{Vec2, Vec3};
use policy_core::Body;

use super::{App, ViewerCommand};
use crate::render::View;

/// A body that the mouse pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// The body.
    pub body: Body,
    /// From the body to the mouse, world space, metres.
    pub pull: Vec3,
}

/// Newtons for each metre of pull, and at most.
const STIFFNESS: f32 = 500.0;
const STRONGEST: f32 = 800.0;
/// How near to a body the mouse must be, metres.
const REACH: f32 = 0.16;

impl Grab {
    /// Force on the body, newtons, world space.
    #[must_use]
    pub fn force(&self) -> Vec3 {
        (self.pull * STIFFNESS).clamp_length_max(STRONGEST)
    }
}

/// Takes in the mouse over `free`, the part of the window that no panel covers.
pub(super) fn read(ui: &mut Ui, app: &App, free: Rect, around: f32, commands: &mut Vec<ViewerCommand>) {
    let screen = ui.ctx().content_rect();
    let response = ui.interact(free, ui.scope_id().with("picture"), egui::Sense::click_and_drag());
    let turning = response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle);
    if turning || (response.dragged_by(PointerButton::Primary) && app.grab.is_none()) {
        let by = response.drag_delta();
        commands.push(ViewerCommand::Turn(Vec2::new(by.x, by.y) * 0.006));
    }
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            commands.push(ViewerCommand::Zoom((-scroll * 0.0025).exp()));
        }
    }
    let pointer = ui.input(|input| input.pointer.interact_pos());
    let view = app.camera.view(around);
    match (&app.grab, pointer) {
        (None, Some(at)) if response.drag_started_by(PointerButton::Primary) => {
            let ray = Ray::through(&view, screen, at);
            let grab = nearest_body(app, &ray).map(|body| Grab { body, pull: Vec3::ZERO });
            commands.push(ViewerCommand::Grab(grab));
        }
        (Some(grab), Some(at)) if response.dragged_by(PointerButton::Primary) => {
            let from = app.sim.poses(0, app.alpha()).positions[grab.body.index()];
            let pull = Ray::through(&view, screen, at).at_depth_of(from, &view) - from;
            commands.push(ViewerCommand::Grab(Some(Grab { pull: pull.clamp_length_max(2.0), ..*grab })));
        }
        (Some(_), _) => commands.push(ViewerCommand::Grab(None)),
        _ => {}
    }
}

/// A line from the eye.
struct Ray {
    from: Vec3,
    along: Vec3,
}

impl Ray {
    fn through(view: &View, screen: Rect, at: egui::Pos2) -> Self {
        let aspect = screen.width() / screen.height().max(1.0);
        let clip = Vec2::new(
            (at.x - screen.left()) / screen.width() * 2.0 - 1.0,
            1.0 - (at.y - screen.top()) / screen.height() * 2.0,
        );
        let far = view.clip_from_world(aspect).inverse().project_point3(clip.extend(0.9));
        Self { from: view.eye, along: (far - view.eye).normalize_or(Vec3::X) }
    }

    /// The point of the line as deep in the picture as `point`.
    fn at_depth_of(&self, point: Vec3, view: &View) -> Vec3 {
        let forward = (view.target - view.eye).normalize_or(Vec3::X);
        let depth = (point - self.from).dot(forward);
        self.from + self.along * (depth / self.along.dot(forward).max(0.1))
    }
}

fn nearest_body(app: &App, ray: &Ray) -> Option<Body> {
    // A clip can't be pulled at: the mouse turns the camera.
    if app.sim.playback().is_some() {
        return None;
    }
    let poses = app.sim.poses(0, app.alpha());
    let distance = |body: &Body| {
        let to = poses.positions[body.index()] - ray.from;
        (to - ray.along * to.dot(ray.along)).length()
    };
    let best = Body::ALL.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(&best) < REACH).then_some(best)
}
