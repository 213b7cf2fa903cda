//! The physics diverged: what is known, and two ways to continue.

use egui::Ui;

use super::WRONG;
use crate::app::{Failure, ViewerCommand};

pub(super) fn show(ui: &mut Ui, failure: &Failure, commands: &mut Vec<ViewerCommand>) {
    let window = egui::Window::new("The physics became unstable").collapsible(false).resizable(false);
    window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        ui.colored_label(WRONG, &failure.what);
        if let Some(replay) = &failure.replay {
            ui.label(format!("The state before it was saved to {replay}."));
        }
        ui.horizontal(|ui| {
            if ui
                .button("Rewind and continue")
                .on_hover_text(
                    "Goes back by two seconds where the engine keeps them; other characters stand up again",
                )
                .clicked()
            {
                commands.push(ViewerCommand::RewindAfterFailure);
            }
            if ui.button("Start again").on_hover_text("All characters back to the start").clicked() {
                commands.push(ViewerCommand::ResetAfterFailure);
            }
        });
    });
}
