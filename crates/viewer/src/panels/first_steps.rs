//! The list of first steps, ticked off as they are done, and the line that says that the tour plays.

use egui::{Align2, Color32, Rect, RichText, Sense, Stroke, Ui, vec2};

use super::{PRESENT, frame};
use crate::app::{App, FirstStep, ViewerCommand};
use crate::replays::Replaying;

/// Side of a tick, points.
const TICK: f32 = 14.0;

pub(super) fn show(ui: &Ui, app: &App, free: Rect, commands: &mut Vec<ViewerCommand>) {
    if app.tour.is_playing() {
        return;
    }
    let is_replay = matches!(app.replaying, Replaying::Playing(_));
    if !app.layout.preferences.shows_first_steps || app.sim.playback().is_some() || is_replay {
        return;
    }
    // In the playground the line of its course is above.
    let down = if app.sim.shared().is_some() { 52.0 } else { 12.0 };
    let area = egui::Area::new(egui::Id::unique("first steps")).fixed_pos(free.left_top() + vec2(12.0, down));
    area.show(ui.ctx(), |ui| {
        frame().show(ui, |ui| {
            ui.horizontal(|ui| {
                let done = app.first_steps.are_done(app.sim.pack());
                ui.strong(if done { "That is all you need. Have fun!" } else { "Try this first" });
                let close = ui.small_button("x").on_hover_text("Close this list (Settings shows it again)");
                if close.clicked() {
                    let mut preferences = app.layout.preferences;
                    preferences.shows_first_steps = false;
                    commands.push(ViewerCommand::Preferences(preferences));
                }
            });
            for step in FirstStep::ALL.into_iter().filter(|step| step.is_offered(app.sim.pack())) {
                ui.horizontal(|ui| row(ui, app, step));
            }
        });
    });
}

fn row(ui: &mut Ui, app: &App, step: FirstStep) {
    let done = app.first_steps.is_done(step);
    tick(ui, done);
    let title = RichText::new(step.title());
    ui.label(if done { title.strikethrough().weak() } else { title.strong() });
    if !done {
        ui.label(step.how(app.uses_pad(), &app.layout.preferences.keys));
    }
}

fn tick(ui: &mut Ui, done: bool) {
    let (rect, _) = ui.allocate_exact_size(vec2(TICK, TICK), Sense::hover());
    let at = |x: f32, y: f32| rect.min + vec2(x, y) * TICK;
    if done {
        ui.painter().circle_filled(rect.center(), 0.5 * TICK, PRESENT);
        let mark = vec![at(0.25, 0.52), at(0.43, 0.7), at(0.75, 0.32)];
        ui.painter().line(mark, Stroke::new(2.0, Color32::BLACK));
    } else {
        ui.painter().circle_stroke(rect.center(), 0.5 * TICK - 1.0, Stroke::new(1.5, Color32::GRAY));
    }
}

/// Says in every layout that the tour plays, or that it is about to begin.
pub(super) fn tour(ui: &Ui, app: &App, free: Rect) {
    let text = match app.tour.begins_in() {
        _ if app.tour.is_playing() => "Tour: press any key or button to take over".to_owned(),
        Some(secs) => format!("The tour starts in {:.0} s", secs.ceil()),
        None => return,
    };
    let area = egui::Area::new(egui::Id::unique("tour")).pivot(Align2::CENTER_TOP);
    area.fixed_pos(free.center_top() + vec2(0.0, 56.0)).show(ui.ctx(), |ui| {
        frame().show(ui, |ui| ui.strong(text));
    });
}
