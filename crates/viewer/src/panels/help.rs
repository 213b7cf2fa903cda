//! The overlay that says what each control does.

use egui::Ui;

use crate::app::{App, PAD, ViewerCommand, key_help};

/// What the title and the frame of the window take, points, and the least that is left for the tables.
const MARGIN: f32 = 90.0;
const LEAST_HEIGHT: f32 = 80.0;
/// Width of the tables, points.
const WIDTH: f32 = 560.0;

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let mut open = true;
    let window = egui::Window::new("Controls").id(egui::Id::unique("help")).open(&mut open);
    let room = (ui.ctx().content_rect().height() - MARGIN).max(LEAST_HEIGHT);
    let window = window.collapsible(false).resizable(false).default_size([WIDTH, room]);
    window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        egui::ScrollArea::vertical().max_height(room).show(ui, |ui| tables(ui, app));
    });
    if !open {
        commands.push(ViewerCommand::Help(false));
    }
}

fn tables(ui: &mut Ui, app: &App) {
    table(ui, "Keyboard and mouse", &key_help(&app.layout.preferences.keys));
    ui.add_space(8.0);
    table(ui, app.pad.name.as_deref().unwrap_or("Pad (none connected)"), &PAD);
    ui.add_space(8.0);
    ui.label(format!("Camera: {}. Blends: {}.", app.camera.mode.name(), app.sim.blend_mode().name()));
    let skills: Vec<&str> = app.sim.pack().skills().iter().map(|s| s.name.as_str()).collect();
    if skills.is_empty() {
        ui.label("This pack has no episodic skills: their buttons do nothing.");
    } else {
        ui.label(format!("Skills of this pack: {}.", skills.join(", ")));
    }
}

fn table<T: AsRef<str>>(ui: &mut Ui, title: &str, rows: &[(T, &str)]) {
    ui.strong(title);
    egui::Grid::new(title).num_columns(2).striped(true).show(ui, |ui| {
        for (control, action) in rows {
            ui.monospace(control.as_ref());
            ui.label(*action);
            ui.end_row();
        }
    });
}
