//! How blends become actions, and the ghost that walks beside the player under another mode.

use egui::Ui;
use policy_core::BlendMode;
use policy_core::training::Evaluation;

use super::WRONG;
use crate::app::{App, ViewerCommand};
use crate::sim::GhostKind;

const TEXTS: [&str; 3] = [
    "the parameters are interpolated: one network in between",
    "both networks run, their actions are interpolated",
    "the nearer network runs alone",
];

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let present = app.sim.blend_mode();
    for (mode, text) in BlendMode::ALL.into_iter().zip(TEXTS) {
        if ui.radio(mode == present, mode.name()).on_hover_text(text).clicked() {
            commands.push(ViewerCommand::Mode(mode));
        }
    }
    let took = match app.sim.player().report().evaluation {
        Evaluation::Single => "one policy",
        Evaluation::Cached => "a blend that rests: one product",
        Evaluation::Fused => "a blend that moves: one product for each policy",
        Evaluation::Actions => "every policy of the blend",
    };
    ui.weak(format!("the last tick evaluated {took}"));
    let compares = app.views() > 1;
    let label = if compares { "end the split screen" } else { "compare in split screen" };
    let told = "All three under the same stick, side by side on the empty floor, with falls counted";
    if ui.button(label).on_hover_text(told).clicked() {
        commands.push(ViewerCommand::Compare(!compares));
    }
    ui.separator();
    ui.label("A ghost from the same state, under another mode:");
    ui.horizontal_wrapped(|ui| {
        let ghost = app.sim.ghost().map(|g| g.kind());
        let none = ui.selectable_label(ghost.is_none(), "no ghost");
        if none.on_hover_text("One character alone").clicked() {
            commands.push(ViewerCommand::Ghost(None));
        }
        for mode in BlendMode::ALL {
            let label =
                ui.selectable_label(ghost == Some(GhostKind::Mode(mode)), format!("ghost: {}", mode.name()));
            if label.on_hover_text("A second character beside yours, under this mode").clicked() {
                commands.push(ViewerCommand::Ghost(Some(GhostKind::Mode(mode))));
            }
        }
    });
    if let Some(ghost) = app.sim.ghost() {
        ui.label(format!("you {:.2} m/s, ghost {:.2} m/s", app.sim.player().speed(), ghost.speed()));
        if ghost.is_down() {
            ui.colored_label(WRONG, "the ghost has fallen");
        }
    }
}
