//! Asks before the demo ends.

use egui::Ui;

use crate::app::{App, ViewerCommand};

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let window = egui::Window::new("Leave Policy Space?").collapsible(false).resizable(false);
    window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        if app.recording.is_some() {
            ui.label("The recording is finished first.");
        }
        ui.horizontal(|ui| {
            if ui.button("Leave (Enter)").on_hover_text("Ends the demo").clicked() {
                commands.push(ViewerCommand::Quit);
            }
            if ui.button("Stay (Esc)").on_hover_text("Back to the demo").clicked() {
                commands.push(ViewerCommand::AskToQuit(false));
            }
        });
    });
}
