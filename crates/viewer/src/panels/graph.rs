//! The policy graph on a circle: edges with their distance, the blend as a dot, the active skill lit.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, Ui, vec2};
use policy_core::{Goal, NodeId, PolicyId};

use super::{PRESENT, REQUESTED};
use crate::app::{App, ViewerCommand};
use crate::text::spaced;

const HEIGHT: f32 = 190.0;
const NODE: f32 = 9.0;

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let graph = app.sim.pack().graph();
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    // Variants are rings around their gaits.
    let shown: Vec<NodeId> = graph.originals().map(|(id, _)| id).collect();
    let place = |node: NodeId| {
        let at = shown.iter().position(|n| *n == node).unwrap_or(0);
        on_circle(rect, at, shown.len())
    };
    let report = app.sim.player().report();
    let furthest = graph.edges().iter().map(|e| e.distance).fold(f32::MIN_POSITIVE, f32::max);
    let painter = ui.painter();
    let small = FontId::proportional(10.0);
    for edge in graph.edges() {
        let [a, b] = edge.nodes.map(place);
        // The nearer two policies are, the stronger their line.
        let near = 1.0 - 0.75 * edge.distance / furthest;
        painter.line_segment([a, b], Stroke::new(1.0 + 4.0 * near, ui.visuals().weak_text_color()));
        let text = format!("{:.1}", edge.distance);
        painter.text(a.lerp(b, 0.5), Align2::CENTER_CENTER, text, small.clone(), ui.visuals().text_color());
    }
    let running = report.skill.map(|s| app.sim.pack().skills()[s.acts.index()].policy);
    let weight_of = |policy: PolicyId| -> f32 {
        report.blend.terms().iter().filter(|t| t.policy == policy).map(|t| t.weights[0]).sum()
    };
    for &id in &shown {
        let (node, policy) = (graph.node(id), PolicyId::from(id));
        let variants =
            node.variants().into_iter().flatten().map(|id| weight_of(PolicyId::from(id))).sum::<f32>();
        let weight = weight_of(policy) + variants;
        let colour = if running == Some(policy) { REQUESTED } else { lit(weight) };
        let at = place(id);
        painter.circle(at, NODE, colour, Stroke::new(1.5, ui.visuals().text_color()));
        if variants > 0.0 {
            painter.circle_stroke(at, NODE + 4.0, Stroke::new(3.0, lit(variants)));
        }
        let out = (at - rect.center()).normalized() * 18.0;
        let text = ui.visuals().text_color();
        painter.text(at + out, Align2::CENTER_CENTER, spaced(&node.name), FontId::proportional(12.0), text);
    }
    if running.is_none() {
        let position = report.position;
        let at = place(position.from).lerp(place(position.to), position.t);
        painter.circle(at, 5.0, PRESENT, Stroke::new(1.0, Color32::WHITE));
    }
    let response = response.on_hover_text(
        "Click a policy: the character goes there. A ring: a variant of it acts, for rough ground, in turns and starts, or once it goes or stands steadily.",
    );
    if let (true, Some(pointer)) = (response.clicked(), response.interact_pointer_pos()) {
        let near = |n: &NodeId| place(*n).distance(pointer);
        let nearest = shown.iter().copied().min_by(|a, b| near(a).total_cmp(&near(b)));
        if let Some(node) = nearest.filter(|n| near(n) < 2.0 * NODE) {
            commands.push(ViewerCommand::Goal(Some(Goal::Node(node))));
        }
    }
    walk_to(ui, app, commands);
}

/// The same by name, and the way it takes.
fn walk_to(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let graph = app.sim.pack().graph();
    ui.horizontal_wrapped(|ui| {
        ui.label("Go to");
        for (id, node) in graph.originals() {
            let told = format!("Blend over to {}, whatever the triggers say", spaced(&node.name));
            if ui.small_button(spaced(&node.name)).on_hover_text(told).clicked() {
                commands.push(ViewerCommand::Goal(Some(Goal::Node(id))));
            }
        }
    });
    let report = app.sim.player().report();
    let (from, to) = (report.position.nearest_node(), report.goal.nearest_node());
    let route = graph.routes().route(from, to);
    if route.len() > 1 {
        let names: Vec<String> = route.iter().map(|&n| spaced(&graph.node(n).name)).collect();
        ui.weak(format!("{}, distance {:.1}", names.join(" > "), graph.routes().cost(from, to)));
    }
}

fn on_circle(rect: Rect, node: usize, count: usize) -> Pos2 {
    let angle = std::f32::consts::TAU * node as f32 / count as f32 - std::f32::consts::FRAC_PI_2;
    let radius = vec2(0.5 * rect.width() - 44.0, 0.5 * rect.height() - 32.0);
    rect.center() + vec2(angle.cos() * radius.x, angle.sin() * radius.y)
}

fn lit(weight: f32) -> Color32 {
    let dark = Color32::from_rgb(48, 54, 62);
    dark.lerp_to_gamma(PRESENT, weight.clamp(0.0, 1.0))
}
