//! Camera and what is shown besides the characters.

use egui::Ui;

use crate::app::{App, ViewerCommand};
use crate::camera::CameraMode;

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    ui.horizontal(|ui| {
        ui.label("Camera");
        for mode in CameraMode::ALL {
            if ui.selectable_label(app.camera.mode == mode, mode.name()).clicked() {
                commands.push(ViewerCommand::Camera(mode));
            }
        }
    });
    let mut shown = app.layout.shown;
    ui.checkbox(&mut shown.collision_shapes, "Collision shapes");
    ui.checkbox(&mut shown.target, "Target");
    ui.checkbox(&mut shown.trail, "Trail");
    let engine = app.sim.engine();
    let forces = egui::Checkbox::new(&mut shown.contact_forces, "Contact forces");
    ui.add_enabled(engine.tells_contacts(), forces)
        .on_disabled_hover_text(format!("Not read from {}.", engine.title()));
    ui.checkbox(&mut shown.centre_of_mass, "Centre of mass");
    if shown != app.layout.shown {
        commands.push(ViewerCommand::Shown(shown));
    }
}
