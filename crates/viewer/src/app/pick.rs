//! The mouse in the picture: turns the camera, pulls bodies and props, throws balls.

use super::keys::goes_down;
use super::{App, ViewerCommand};
use crate::render::View;
use crate::sim::{Held, SharedWorld};
use egui::{PointerButton, Rect, Ui};
use glam::{Affine3A, Vec2, Vec3};
use physics_bridge::{ShapeKind, Solid};

/// A body or prop that the mouse pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// What is pulled.
    pub held: Held,
    /// From its origin to the mouse, world space, metres.
    pub pull: Vec3,
}

/// Newtons for each metre of pull, and at most.
const STIFFNESS: f32 = 500.0;
const STRONGEST: f32 = 800.0;
/// How near to a shape of a body the mouse must be, metres.
const REACH: f32 = 0.015;

impl Grab {
    /// Force on a body of a character that lives alone, newtons, world space.
    #[must_use]
    pub fn force(&self) -> Vec3 {
        (self.pull * STIFFNESS).clamp_length_max(STRONGEST)
    }
}

/// Reads the mouse over `free`, the part of the window that no panel covers.
pub(super) fn read(ui: &mut Ui, app: &App, free: Rect, commands: &mut Vec<ViewerCommand>) {
    let screen = ui.ctx().content_rect();
    let response = ui.interact(free, ui.scope_id().with("picture"), egui::Sense::click_and_drag());
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            commands.push(ViewerCommand::Zoom((-scroll * 0.0025).exp()));
        }
    }
    let (pointer, pressed) = ui.input(|input| (input.pointer.interact_pos(), input.pointer.press_origin()));
    let view = app.camera.view();
    let mut held = app.grab.is_some();
    match (&app.grab, pointer) {
        (None, Some(_)) if response.drag_started_by(PointerButton::Primary) => {
            // Where the button went down counts, not where the mouse is by the time that it is a drag.
            let ray = pressed.map(|at| Ray::through(&view, screen, at));
            let found = ray.and_then(|ray| nearest(app, &ray));
            held = found.is_some();
            commands.push(ViewerCommand::Grab(found.map(|held| Grab { held, pull: Vec3::ZERO })));
        }
        (Some(grab), Some(at)) if response.dragged_by(PointerButton::Primary) => {
            // What is gone can't be held.
            let pulled = app.origin_of(grab.held).map(|from| {
                let pull = Ray::through(&view, screen, at).at_depth_of(from, &view) - from;
                Grab { pull: pull.clamp_length_max(2.0), ..*grab }
            });
            commands.push(ViewerCommand::Grab(pulled));
        }
        (Some(_), _) => commands.push(ViewerCommand::Grab(None)),
        _ => {}
    }
    throw(ui, app, free, &view, commands);
    let turning = response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle);
    if turning || (response.dragged_by(PointerButton::Primary) && !held) {
        let by = response.drag_delta();
        commands.push(ViewerCommand::Turn(Vec2::new(by.x, by.y) * 0.006));
    }
}

/// Keys that throw a ball at the mouse and put a prop there.
const THROW_KEY: egui::Key = egui::Key::T;
const SPAWN_KEY: egui::Key = egui::Key::Y;

fn throw(ui: &Ui, app: &App, free: Rect, view: &View, commands: &mut Vec<ViewerCommand>) {
    if ui.ctx().text_edit_focused() || app.rebinding.is_some() || app.sim.playback().is_some() {
        return;
    }
    let (throws, spawns, mouse) = ui.input(|input| {
        let down = |key| goes_down(input, key, false);
        (down(THROW_KEY), down(SPAWN_KEY), input.pointer.latest_pos())
    });
    // Without a mouse in the picture they go to its middle.
    let at = mouse.filter(|at| free.contains(*at)).unwrap_or(free.center());
    let Ray { from, along } = Ray::through(view, ui.ctx().content_rect(), at);
    if throws {
        commands.push(ViewerCommand::Throw { from, along });
    }
    if spawns {
        commands.push(ViewerCommand::Spawn { from, along });
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

/// The prop or the body of a character whose shape the ray meets first, or passes within [`REACH`] of. On the empty floor
/// the player's alone.
fn nearest(app: &App, ray: &Ray) -> Option<Held> {
    // A clip can't be pulled at, and views beside each other have rays of their own: the mouse turns the camera.
    if app.sim.playback().is_some() || app.views() > 1 {
        return None;
    }
    let mut nearest: Option<(f32, Held)> = None;
    let mut meet = |world_from_shape: Affine3A, kind: &ShapeKind, held: Held| {
        let shape_from_world = world_from_shape.inverse();
        let local = Ray {
            from: shape_from_world.transform_point3(ray.from),
            along: shape_from_world.transform_vector3(ray.along),
        };
        if let Some(depth) = local.meets(kind)
            && nearest.is_none_or(|(best, _)| depth < best)
        {
            nearest = Some((depth, held));
        }
    };
    let shared = app.sim.shared();
    let characters = if shared.is_some() { app.sim.characters().len() } else { 1 };
    for index in 0..characters {
        let poses = app.sim.poses(index, app.alpha());
        for shape in app.sim.model().shapes() {
            let i = shape.body.index();
            let world_from_body = Affine3A::from_rotation_translation(poses.rotations[i], poses.positions[i]);
            let body_from_shape = Affine3A::from_rotation_translation(shape.rotation, shape.position);
            meet(world_from_body * body_from_shape, &shape.kind, Held::Body(index, shape.body));
        }
    }
    for piece in shared.into_iter().flat_map(SharedWorld::pieces) {
        let (position, rotation) = piece.pose(app.alpha());
        let world_from_piece = Affine3A::from_rotation_translation(rotation, position);
        if let Some(kind) = hull(&piece.solid) {
            meet(world_from_piece, &kind, Held::Prop(piece.handle));
        }
    }
    nearest.map(|(_, held)| held)
}

/// The shape that the mouse meets: a cylinder counts as the cuboid around it.
fn hull(solid: &Solid) -> Option<ShapeKind> {
    match *solid {
        Solid::Sphere { radius } => Some(ShapeKind::Sphere { radius }),
        Solid::Capsule { radius, half_length } => Some(ShapeKind::Capsule { radius, half_length }),
        Solid::Cylinder { radius, half_length } => {
            Some(ShapeKind::Cuboid { half_extents: Vec3::new(radius, radius, half_length) })
        }
        Solid::Cuboid { half_extents } => Some(ShapeKind::Cuboid { half_extents }),
        _ => None,
    }
}
