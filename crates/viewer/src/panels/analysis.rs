//! Principal components in 3D: states that policies go through, and policies themselves. Drag to turn.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, vec2};
use glam::{Quat, Vec3};
use policy_core::NodeId;

use super::{PRESENT, REQUESTED, policy_colour};
use crate::analysis::Analysis;
use crate::app::App;
use crate::text::spaced;

const HEIGHT: f32 = 210.0;

/// A turned view of points within [-1, 1].
struct Orbit {
    rect: Rect,
    turn: Quat,
}

impl Orbit {
    fn at(&self, p: Vec3) -> Pos2 {
        let p = self.turn * p;
        let near = 1.0 / (3.2 - p.y) * 2.9;
        let scale = 0.42 * self.rect.width().min(self.rect.height()) * near;
        self.rect.center() + vec2(p.x, -p.z) * scale
    }
}

pub(super) fn show(ui: &mut Ui, app: &App) {
    let Some(analysis) = &app.analysis else {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label("Computing the principal components");
        });
        return;
    };
    ui.label("States: every policy's, and your trail");
    let orbit = canvas(ui, "states");
    states(ui.painter(), &orbit, analysis);
    ui.label("Parameters: policies, edges, your blend");
    let orbit = canvas(ui, "parameters");
    parameters(ui, &orbit, app, analysis);
}

/// A canvas that can be turned; the angles live with the widget.
fn canvas(ui: &mut Ui, name: &str) -> Orbit {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::drag());
    let response = response.on_hover_text("Drag to turn it.");
    let id = ui.scope_id().with(name);
    let angles = ui.data_mut(|data| {
        let angles = data.get_temp_mut_or(id, vec2(0.6, 0.35));
        *angles += response.drag_delta() * 0.01;
        angles.y = angles.y.clamp(-1.5, 1.5);
        *angles
    });
    let turn = Quat::from_rotation_x(angles.y) * Quat::from_rotation_z(angles.x);
    let orbit = Orbit { rect, turn };
    ui.painter().rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    for axis in Vec3::AXES {
        ui.painter()
            .line_segment([orbit.at(-axis), orbit.at(axis)], Stroke::new(0.5, Color32::from_gray(90)));
    }
    orbit
}

fn states(painter: &Painter, orbit: &Orbit, analysis: &Analysis) {
    let painter = painter.with_clip_rect(orbit.rect);
    for point in &analysis.cloud {
        painter.circle_filled(
            orbit.at(point.at),
            1.3,
            policy_colour(point.node.index()).gamma_multiply(0.55),
        );
    }
    let trail: Vec<Pos2> = analysis.trail.iter().map(|p| orbit.at(*p)).collect();
    if let Some(last) = trail.last() {
        painter.circle_filled(*last, 4.0, Color32::WHITE);
    }
    painter.line(trail, Stroke::new(1.5, Color32::WHITE));
}

fn parameters(ui: &Ui, orbit: &Orbit, app: &App, analysis: &Analysis) {
    let painter = ui.painter().with_clip_rect(orbit.rect);
    let graph = app.sim.pack().graph();
    let map = &analysis.parameters;
    for edge in graph.edges() {
        let [a, b] = edge.nodes.map(|n| orbit.at(map.nodes[n.index()]));
        painter.line_segment([a, b], Stroke::new(1.5, ui.visuals().weak_text_color()));
    }
    for (index, node) in graph.nodes().iter().enumerate() {
        let at = orbit.at(map.nodes[index]);
        if graph.is_variant(NodeId::new(index)) {
            painter.circle_filled(at, 2.5, policy_colour(index));
            continue;
        }
        painter.circle_filled(at, 5.0, policy_colour(index));
        let text = ui.visuals().text_color();
        painter.text(
            at + vec2(0.0, -8.0),
            Align2::CENTER_BOTTOM,
            spaced(&node.name),
            FontId::proportional(11.0),
            text,
        );
    }
    let blend = orbit.at(map.blend(&app.sim.player().report().blend));
    painter.circle(blend, 5.0, PRESENT, Stroke::new(1.5, REQUESTED));
}
