//! The mouse in the picture: turns the camera, pulls bodies.

use egui::{PointerButton, Rect, Ui};
use glam::{Affine3A, Vec2, Vec3};
use physics_bridge::ShapeKind;
use policy_core::BodyId;

use super::{App, ViewerCommand};
use crate::render::View;

/// A body that the mouse pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// The body.
    pub body: BodyId,
    /// From the body to the mouse, world space, metres.
    pub pull: Vec3,
}

/// Newtons for each metre of pull, and at most.
const STIFFNESS: f32 = 500.0;
const STRONGEST: f32 = 800.0;
/// How near to a shape of a body the mouse must be, metres.
const REACH: f32 = 0.015;

impl Grab {
    /// Force on the body, newtons, world space.
    #[must_use]
    pub fn force(&self) -> Vec3 {
        (self.pull * STIFFNESS).clamp_length_max(STRONGEST)
    }
}

/// Reads the mouse over `free`, the part of the window that no panel covers.
pub(super) fn read(ui: &mut Ui, app: &App, free: Rect, around: f32, commands: &mut Vec<ViewerCommand>) {
    let screen = ui.ctx().content_rect();
    let response = ui.interact(free, ui.scope_id().with("picture"), egui::Sense::click_and_drag());
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            commands.push(ViewerCommand::Zoom((-scroll * 0.0025).exp()));
        }
    }
    let (pointer, pressed) = ui.input(|input| (input.pointer.interact_pos(), input.pointer.press_origin()));
    let view = app.camera.view(around);
    let mut held = app.grab.is_some();
    match (&app.grab, pointer) {
        (None, Some(_)) if response.drag_started_by(PointerButton::Primary) => {
            // Where the button went down counts, not where the mouse is by the time that it is a drag.
            let ray = pressed.map(|at| Ray::through(&view, screen, at));
            let body = ray.and_then(|ray| nearest_body(app, &ray));
            held = body.is_some();
            commands.push(ViewerCommand::Grab(body.map(|body| Grab { body, pull: Vec3::ZERO })));
        }
        (Some(grab), Some(at)) if response.dragged_by(PointerButton::Primary) => {
            let from = app.sim.poses(0, app.alpha()).positions[grab.body.index()];
            let pull = Ray::through(&view, screen, at).at_depth_of(from, &view) - from;
            commands.push(ViewerCommand::Grab(Some(Grab { pull: pull.clamp_length_max(2.0), ..*grab })));
        }
        (Some(_), _) => commands.push(ViewerCommand::Grab(None)),
        _ => {}
    }
    let turning = response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle);
    if turning || (response.dragged_by(PointerButton::Primary) && !held) {
        let by = response.drag_delta();
        commands.push(ViewerCommand::Turn(Vec2::new(by.x, by.y) * 0.006));
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

    /// How far along the line it passes a shape, in the frame of that shape; `None` when it misses it by more than
    /// [`REACH`].
    fn meets(&self, kind: &ShapeKind) -> Option<f32> {
        match *kind {
            ShapeKind::Sphere { radius } => self.passes(Vec3::ZERO, Vec3::ZERO, radius),
            ShapeKind::Capsule { radius, half_length } => {
                let end = Vec3::Z * half_length;
                self.passes(-end, end, radius)
            }
            ShapeKind::Cuboid { half_extents } => self.enters(half_extents + Vec3::splat(REACH)),
            _ => None,
        }
    }

    /// The nearest points of the line and of the segment from `a` to `b` are within `radius` and the reach.
    fn passes(&self, a: Vec3, b: Vec3, radius: f32) -> Option<f32> {
        let (segment, to) = (b - a, a - self.from);
        let (d, e) = (self.along.dot(segment), self.along.dot(to));
        let steepness = segment.length_squared() - d * d;
        let share =
            if steepness > 1e-9 { ((d * e - segment.dot(to)) / steepness).clamp(0.0, 1.0) } else { 0.0 };
        let point = a + segment * share;
        let depth = (point - self.from).dot(self.along);
        let apart = (self.from + self.along * depth).distance(point);
        (depth > 0.0 && apart < radius + REACH).then_some(depth)
    }

    /// The line enters the box about the origin.
    fn enters(&self, half_extents: Vec3) -> Option<f32> {
        let per_axis = self.along.recip();
        let (one, other) = ((-half_extents - self.from) * per_axis, (half_extents - self.from) * per_axis);
        let (near, far) = (one.min(other).max_element(), one.max(other).min_element());
        (near <= far && near > 0.0).then_some(near)
    }

    /// The point of the line as deep in the picture as `point`.
    fn at_depth_of(&self, point: Vec3, view: &View) -> Vec3 {
        let forward = (view.target - view.eye).normalize_or(Vec3::X);
        let depth = (point - self.from).dot(forward);
        self.from + self.along * (depth / self.along.dot(forward).max(0.1))
    }
}

/// The body of the player whose shape the ray meets first, or passes within [`REACH`] of.
fn nearest_body(app: &App, ray: &Ray) -> Option<BodyId> {
    // A clip can't be pulled at: the mouse turns the camera.
    if app.sim.playback().is_some() {
        return None;
    }
    let poses = app.sim.poses(0, app.alpha());
    let mut nearest: Option<(f32, BodyId)> = None;
    for shape in app.sim.model().shapes() {
        let i = shape.body.index();
        let world_from_body = Affine3A::from_rotation_translation(poses.rotations[i], poses.positions[i]);
        let world_from_shape =
            world_from_body * Affine3A::from_rotation_translation(shape.rotation, shape.position);
        let shape_from_world = world_from_shape.inverse();
        let local = Ray {
            from: shape_from_world.transform_point3(ray.from),
            along: shape_from_world.transform_vector3(ray.along),
        };
        if let Some(depth) = local.meets(&shape.kind)
            && nearest.is_none_or(|(best, _)| depth < best)
        {
            nearest = Some((depth, shape.body));
        }
    }
    nearest.map(|(_, body)| body)
}
