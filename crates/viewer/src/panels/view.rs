//! Camera and what is shown besides the characters.

use egui::Ui;

use super::preferences;
use crate::app::{App, ViewerCommand};

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    preferences::camera_modes(ui, app, commands);
    let mut shown = app.layout.shown;
    ui.checkbox(&mut shown.collision_shapes, "Collision shapes")
        .on_hover_text("The solids that the physics sees, instead of the mesh");
    ui.checkbox(&mut shown.target, "Target").on_hover_text("The point that the stick asks for");
    ui.checkbox(&mut shown.trail, "Trail").on_hover_text("The path behind the character");
    let engine = app.sim.engine();
    let forces = egui::Checkbox::new(&mut shown.contact_forces, "Contact forces");
    ui.add_enabled(engine.tells_contacts(), forces)
        .on_hover_text("How hard feet and hands touch the ground")
        .on_disabled_hover_text(format!("{} doesn't report contact forces here.", engine.title()));
    ui.checkbox(&mut shown.centre_of_mass, "Centre of mass")
        .on_hover_text("The centre of mass, and the point below it");
    if shown != app.layout.shown {
        commands.push(ViewerCommand::Shown(shown));
    }
}
