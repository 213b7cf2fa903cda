//! Screenshot, pictures one after another, film.

use egui::Ui;

use crate::app::{App, Record, ViewerCommand};

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let running = app.recording.is_some();
    ui.horizontal(|ui| {
        if ui.button("Screenshot").on_hover_text("One picture as PNG, with the panels").clicked() {
            commands.push(ViewerCommand::Record(Record::Screenshot));
        }
        ui.add_enabled_ui(!running, |ui| {
            if ui.button("Pictures").on_hover_text("One PNG after another, 30 a second").clicked() {
                commands.push(ViewerCommand::Record(Record::Sequence));
            }
            if ui.button("Film").on_hover_text("MP4 with ffmpeg, else APNG").clicked() {
                commands.push(ViewerCommand::Record(Record::Video));
            }
        });
        let stop = ui.add_enabled(running, egui::Button::new("Stop recording"));
        if stop.on_hover_text("Ends the film or the pictures").clicked() {
            commands.push(ViewerCommand::Record(Record::Stop));
        }
    });
    match &app.recording {
        Some(what) => ui.label(format!("recording {what}")),
        None => ui.weak("into the folder policy-space-recordings"),
    };
}
