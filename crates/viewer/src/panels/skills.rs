//! Episodic skills: start them, see their progress and the discriminator's score.

use egui::{ProgressBar, Ui};
use egui_plot::{HLine, Line, Plot, PlotPoints};
use policy_core::{Skill, SkillId};

use super::{PRESENT, REQUESTED};
use crate::app::{App, ViewerCommand};

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let pack = app.sim.pack();
    let report = app.sim.player().report();
    if pack.skills().is_empty() {
        ui.label("This pack has no episodic skills.");
    }
    ui.horizontal_wrapped(|ui| {
        for (index, skill) in pack.skills().iter().enumerate() {
            let id = SkillId::new(index);
            let running = report.skill.is_some_and(|s| s.skill == id);
            let waiting = report.pending_skill == Some(id);
            let mark = if waiting { " ..." } else { "" };
            let button = ui.add(egui::Button::selectable(running, format!("{}{mark}", skill.name)));
            if button.on_hover_text("Starts as soon as the character can; ends by itself.").clicked() {
                commands.push(ViewerCommand::Skill(id));
            }
        }
    });
    if let Some(progress) = report.skill {
        let skill = &pack.skills()[progress.acts.index()];
        let share = progress.seconds / skill.end.limit_seconds.max(1e-3);
        ui.add(ProgressBar::new(share).text(format!("{} {:.1} s", skill.name, progress.seconds)));
        gauge(ui, skill, progress.score, progress.held_seconds);
    }
    let threshold = report.skill.map(|s| pack.skills()[s.acts.index()].end);
    let plot =
        Plot::new("score").height(70.0).include_y(0.0).include_y(1.0).allow_drag(false).allow_zoom(false);
    plot.allow_scroll(false).show_axes([false, true]).show(ui, |plot| {
        let points: PlotPoints<'_> = app.plots.score.points().collect();
        plot.line(Line::new("discriminator", points).color(PRESENT));
        if let Some(end) = threshold {
            plot.hline(HLine::new("ends above", end.threshold).color(REQUESTED));
            plot.hline(
                HLine::new("counts on above", end.threshold - end.hysteresis).color(REQUESTED).width(0.5),
            );
        }
    });
}

/// The discriminator's score between 0 and 1, with the threshold and the band of its hysteresis.
fn gauge(ui: &mut Ui, skill: &Skill, score: Option<f32>, held: f32) {
    if skill.discriminator.is_none() {
        ui.weak("ends by time");
        return;
    }
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 14.0), egui::Sense::hover());
    let at = |v: f32| rect.left() + rect.width() * v.clamp(0.0, 1.0);
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let band = |low: f32, high: f32| {
        egui::Rect::from_min_max(egui::pos2(at(low), rect.top()), egui::pos2(at(high), rect.bottom()))
    };
    let end = &skill.end;
    painter.rect_filled(
        band(end.threshold - end.hysteresis, end.threshold),
        0.0,
        REQUESTED.gamma_multiply(0.35),
    );
    painter.rect_filled(band(0.0, score.unwrap_or(0.0)), 2.0, PRESENT.gamma_multiply(0.7));
    painter.vline(at(end.threshold), rect.y_range(), egui::Stroke::new(2.0, REQUESTED));
    let text = score.map_or_else(|| "not enough motion seen yet".into(), |s| format!("score {s:.2}"));
    ui.label(format!("{text}, held {held:.2} of {:.2} s", end.hold_seconds));
}
