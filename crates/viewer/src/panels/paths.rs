//! Every path as a ruler with two cursors, the requested and the present coordinate. Drag to override the trigger,
//! click a node to go there.

use egui::{FontId, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};
use policy_core::training::Path;
use policy_core::{Goal, PathId};

use super::{PRESENT, REQUESTED};
use crate::app::{App, ViewerCommand};
use crate::text::spaced;

const HEIGHT: f32 = 46.0;
const MARGIN: f32 = 22.0;
/// How near to a node a click counts as on it, points.
const NODE_REACH: f32 = 9.0;

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let graph = app.sim.pack().graph();
    if graph.paths().is_empty() {
        ui.label("This pack has no paths.");
    }
    for (index, path) in graph.paths().iter().enumerate() {
        ruler(ui, app, (PathId::new(index), path), commands);
    }
    let overridden = app.sim.overrides.goal.is_some();
    ui.horizontal(|ui| {
        ui.colored_label(REQUESTED, "asked for");
        ui.colored_label(PRESENT, "now");
        let back = ui.add_enabled(overridden, egui::Button::new("Back to the triggers"));
        let told = "Lets the triggers decide again. Pulling one does the same.";
        if back.on_hover_text(told).on_disabled_hover_text(told).clicked() {
            commands.push(ViewerCommand::Goal(None));
        }
    });
}

fn ruler(ui: &mut Ui, app: &App, (id, path): (PathId, &Path), commands: &mut Vec<ViewerCommand>) {
    let player = app.sim.player();
    let (now, goal) = (player.report().position, player.report().goal);
    ui.horizontal(|ui| {
        ui.strong(path.name());
        // The slider says the same in numbers, and can be typed into.
        let shown = path.coordinate(goal).unwrap_or(0.0);
        let mut coordinate = shown;
        let slider =
            egui::DragValue::new(&mut coordinate).speed(0.01).range(0.0..=path.end()).fixed_decimals(2);
        let response = ui.add(slider).on_hover_text(format!("coordinate on the path {}", path.name()));
        if response.changed() {
            commands.push(ViewerCommand::Goal(Some(Goal::Path { path: id, coordinate })));
        }
        let travelling =
            path.coordinate(now).map_or_else(|| "off this path".into(), |c| format!("now {c:.2}"));
        ui.weak(travelling);
    });
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click_and_drag());
    let line = Rect::from_min_max(
        pos2(rect.left() + MARGIN, rect.top() + 14.0),
        pos2(rect.right() - MARGIN, rect.top() + 14.0),
    );
    let place = |coordinate: f32| pos2(line.left() + line.width() * coordinate / path.end(), line.top());
    draw(ui, app, path, &place);
    if let Some(c) = path.coordinate(now) {
        ui.painter().circle_filled(place(c), 6.0, PRESENT);
    }
    if let Some(c) = path.coordinate(goal) {
        cursor(ui, place(c));
    }
    let response = response.on_hover_text("Drag along it, or click a name.");
    let Some(pointer) = response.interact_pointer_pos() else { return };
    let coordinate = ((pointer.x - line.left()) / line.width()).clamp(0.0, 1.0) * path.end();
    let node = coordinate.round();
    if response.clicked() && (place(node).x - pointer.x).abs() < NODE_REACH {
        commands.push(ViewerCommand::Goal(Some(Goal::Node(path.nodes()[node as usize]))));
    } else if response.dragged() || response.clicked() {
        commands.push(ViewerCommand::Goal(Some(Goal::Path { path: id, coordinate })));
    }
}

fn draw(ui: &Ui, app: &App, path: &Path, place: &impl Fn(f32) -> Pos2) {
    let painter = ui.painter();
    let weak = ui.visuals().weak_text_color();
    painter.line_segment([place(0.0), place(path.end())], Stroke::new(3.0, weak));
    for (i, &node) in path.nodes().iter().enumerate() {
        let at = place(i as f32);
        painter.circle(at, 5.0, ui.visuals().extreme_bg_color, Stroke::new(1.5, ui.visuals().text_color()));
        let name = spaced(&app.sim.pack().graph().node(node).name);
        let label = painter.layout_no_wrap(name, FontId::proportional(12.0), ui.visuals().text_color());
        // Centred, but a long name at an end stays inside the panel.
        let inside = ui.max_rect();
        let most = (inside.right() - label.size().x).max(inside.left());
        let left = (at.x - 0.5 * label.size().x).clamp(inside.left(), most);
        painter.galley(pos2(left, at.y + 12.0), label, ui.visuals().text_color());
    }
}

/// A mark above the ruler that points down at what is asked for.
fn cursor(ui: &Ui, at: Pos2) {
    let points = vec![at + vec2(0.0, -5.0), at + vec2(-5.0, -13.0), at + vec2(5.0, -13.0)];
    ui.painter().add(egui::Shape::convex_polygon(points, REQUESTED, Stroke::NONE));
}
