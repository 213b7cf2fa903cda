//! The window of the settings. Every change holds at once and is kept.

use egui::{Slider, Ui};

use crate::app::{App, KeyAction, Preferences, Quality, ViewerCommand};
use crate::camera::CameraMode;
use crate::sound::SpeakerState;

/// What the title and the frame of the window take, points, and the least that is left for the rest.
const MARGIN: f32 = 90.0;
const LEAST_HEIGHT: f32 = 80.0;
/// Width of the window, points.
const WIDTH: f32 = 420.0;

pub(super) fn show(ui: &Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let mut open = true;
    let window = egui::Window::new("Settings").id(egui::Id::unique("settings")).open(&mut open);
    let room = (ui.ctx().content_rect().height() - MARGIN).max(LEAST_HEIGHT);
    let window = window.collapsible(false).resizable(false).default_size([WIDTH, room]);
    window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        egui::ScrollArea::vertical().max_height(room).show(ui, |ui| {
            let mut chosen = app.layout.preferences;
            screen(ui, &mut chosen);
            sound(ui, app, &mut chosen);
            camera(ui, app, &mut chosen, commands);
            start(ui, &mut chosen, commands);
            keys(ui, app, commands);
            ui.add_space(8.0);
            let told = "Sizes, camera, keys and panels as at the first start. Saved blends stay.";
            if ui.button("Reset to defaults").on_hover_text(told).clicked() {
                commands.push(ViewerCommand::ResetPreferences);
            }
            if chosen != app.layout.preferences {
                commands.push(ViewerCommand::Preferences(chosen));
            }
        });
    });
    if !open {
        commands.push(ViewerCommand::ChoosePreferences(false));
    }
}

fn screen(ui: &mut Ui, chosen: &mut Preferences) {
    ui.strong("Screen");
    ui.horizontal_wrapped(|ui| {
        ui.label("Text size");
        for scale in Preferences::UI_SCALES {
            let label = ui.selectable_label(chosen.ui_scale == scale, format!("{:.0} %", 100.0 * scale));
            if label.on_hover_text("Size of all texts and buttons").clicked() {
                chosen.ui_scale = scale;
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Picture");
        for quality in Quality::ALL {
            let label = ui.selectable_label(chosen.quality == quality, quality.name());
            if label.on_hover_text(quality_text(quality)).clicked() {
                chosen.quality = quality;
            }
        }
    });
    ui.checkbox(&mut chosen.advanced, "Advanced panels")
        .on_hover_text("All panels of the method instead of the simple layout");
    ui.add_space(8.0);
}

fn sound(ui: &mut Ui, app: &App, chosen: &mut Preferences) {
    ui.strong("Sound");
    ui.horizontal_wrapped(|ui| {
        let told = "Footsteps, impacts, and bells at the checkpoints";
        ui.checkbox(&mut chosen.plays_sound, "Play sounds").on_hover_text(told);
        let why = match app.speaker {
            SpeakerState::NotBuilt => "this program was built without sound",
            SpeakerState::Looking => "looking for a device",
            SpeakerState::NoDevice => "no device was found",
            SpeakerState::Playing => "",
        };
        ui.weak(why);
    });
    // A drag is kept once, at its end.
    let volume = Slider::new(&mut chosen.volume, 0.0..=1.0).update_while_editing(false);
    let percent = |value: f64, _| format!("{:.0} %", 100.0 * value);
    ui.add_enabled(chosen.plays_sound, volume.custom_formatter(percent).text("volume"))
        .on_hover_text("How loud the sounds are");
    ui.add_space(8.0);
}

const fn quality_text(quality: Quality) -> &'static str {
    match quality {
        Quality::Automatic => "High with a graphics card, medium without one",
        Quality::Low => "Hard shadows and edges, for slow machines",
        Quality::Medium => "Soft edges, smaller shadows",
        Quality::High => "The finest shadows and meshes",
    }
}

fn camera(ui: &mut Ui, app: &App, chosen: &mut Preferences, commands: &mut Vec<ViewerCommand>) {
    ui.strong("Camera");
    camera_modes(ui, app, commands);
    // A drag is kept once, at its end.
    let slider =
        |value| Slider::new(value, Preferences::SENSITIVITY).suffix(" ×").update_while_editing(false);
    ui.add(slider(&mut chosen.mouse_sensitivity).text("mouse"))
        .on_hover_text("How far the camera turns with the mouse");
    ui.add(slider(&mut chosen.stick_sensitivity).text("right stick"))
        .on_hover_text("How fast the camera turns with the right stick and I O U L");
    ui.checkbox(&mut chosen.inverts_y, "Invert up and down")
        .on_hover_text("Pushing the stick or the mouse up looks down");
    ui.add_space(8.0);
}

/// The modes of the camera, and the way back.
pub(super) fn camera_modes(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    ui.horizontal_wrapped(|ui| {
        for mode in CameraMode::ALL {
            let label = ui.selectable_label(app.camera.mode == mode, mode.name());
            if label.on_hover_text(mode.text()).clicked() {
                commands.push(ViewerCommand::Camera(mode));
            }
        }
        let told = "Puts the camera behind the character, as at the start";
        if ui.button("Reset camera (Home)").on_hover_text(told).clicked() {
            commands.push(ViewerCommand::ResetCamera);
        }
    });
}

fn start(ui: &mut Ui, chosen: &mut Preferences, commands: &mut Vec<ViewerCommand>) {
    ui.strong("Start");
    ui.checkbox(&mut chosen.plays_tour, "Play the tour when idle")
        .on_hover_text("After 45 seconds without any input the demo shows what the character can do");
    if ui.button("Show the first steps again").on_hover_text("The list of things to try first").clicked() {
        commands.push(ViewerCommand::RepeatFirstSteps);
    }
    ui.add_space(8.0);
}

fn keys(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    ui.strong("Keys");
    egui::Grid::new("keys").num_columns(4).show(ui, |ui| {
        for (index, (action, _)) in KeyAction::ALL.into_iter().enumerate() {
            ui.label(action.title());
            let waits = app.rebinding == Some(action);
            let key = app.layout.preferences.keys.key(action).name();
            let button = egui::Button::selectable(waits, if waits { "press a key" } else { key });
            let told = format!("Click, then press the key for \"{}\". Esc gives up.", action.title());
            if ui.add(button.min_size(egui::vec2(80.0, 0.0))).on_hover_text(told).clicked() {
                commands.push(ViewerCommand::Rebind(if waits { None } else { Some(action) }));
            }
            if index % 2 == 1 {
                ui.end_row();
            }
        }
    });
}
