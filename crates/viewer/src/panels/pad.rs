//! What the pad says, raw and after dead zones, through which back end, and what was not understood.

use egui::{Color32, Sense, Stroke, Ui, vec2};
use policy_core::{Button, GamepadState};

use super::{PRESENT, REQUESTED};
use crate::app::App;

pub(super) fn show(ui: &mut Ui, app: &App) {
    match &app.pad.name {
        Some(name) => ui.label(name),
        None => ui.label("No pad; the keyboard steers."),
    };
    let input = app.input();
    let raw = if app.pad.name.is_some() { app.pad.raw } else { input };
    ui.horizontal(|ui| {
        stick(ui, raw.left_stick, input.left_stick);
        stick(ui, raw.right_stick, input.right_stick);
        ui.vertical(|ui| {
            trigger(ui, "left trigger", raw.left_trigger, input.left_trigger);
            trigger(ui, "right trigger", raw.right_trigger, input.right_trigger);
        });
    });
    ui.horizontal(|ui| {
        ui.colored_label(REQUESTED, "raw");
        ui.colored_label(PRESENT, "after dead zones");
    });
    ui.label(format!("buttons: {}", names(&input)));
    for problem in &app.pad.problems {
        ui.colored_label(REQUESTED, problem);
    }
}

fn stick(ui: &mut Ui, raw: [f32; 2], after: [f32; 2]) {
    let (rect, _) = ui.allocate_exact_size(vec2(64.0, 64.0), Sense::hover());
    let painter = ui.painter();
    let at = |v: [f32; 2]| rect.center() + vec2(v[0], -v[1]) * 28.0;
    painter.circle(rect.center(), 30.0, ui.visuals().extreme_bg_color, Stroke::new(1.0, Color32::GRAY));
    painter.circle_stroke(at(raw), 5.0, Stroke::new(1.5, REQUESTED));
    painter.circle_filled(at(after), 4.0, PRESENT);
}

fn trigger(ui: &mut Ui, name: &str, raw: f32, after: f32) {
    ui.label(format!("{name} {after:.2}"));
    let (rect, _) = ui.allocate_exact_size(vec2(100.0, 8.0), Sense::hover());
    let part = |v: f32| rect.with_max_x(rect.left() + rect.width() * v.clamp(0.0, 1.0));
    ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    ui.painter().rect_filled(part(after), 2.0, PRESENT);
    ui.painter().vline(part(raw).right(), rect.y_range(), Stroke::new(2.0, REQUESTED));
}

fn names(input: &GamepadState) -> String {
    let held: Vec<String> =
        Button::ALL.into_iter().filter(|&b| input.buttons.contains(b)).map(|b| format!("{b:?}")).collect();
    if held.is_empty() { "none".into() } else { held.join(", ") }
}
