//! Messages at the top right of the picture. They fade by themselves.

use egui::{Align2, Color32, Rect, Ui, vec2};

use super::{WRONG, frame};
use crate::app::{App, ToastKind, ViewerCommand};
use crate::text;

/// Longest message, characters, and its widest line, points.
const LONGEST: usize = 500;
const WIDTH: f32 = 360.0;

pub(super) fn show(ui: &Ui, app: &App, free: Rect, commands: &mut Vec<ViewerCommand>) {
    if app.toasts.is_empty() {
        return;
    }
    let area = egui::Area::new(egui::Id::unique("toasts")).pivot(Align2::RIGHT_TOP);
    area.fixed_pos(free.right_top() + vec2(-12.0, 12.0)).show(ui.ctx(), |ui| {
        for (index, toast) in app.toasts.iter().enumerate() {
            ui.set_opacity(toast.opacity());
            frame().show(ui, |ui| {
                ui.set_max_width(WIDTH.min(0.6 * free.width()));
                ui.horizontal_top(|ui| {
                    if ui.small_button("x").on_hover_text("Close this message").clicked() {
                        commands.push(ViewerCommand::DismissToast(index));
                    }
                    let colour = match toast.kind {
                        ToastKind::Note => Color32::WHITE,
                        ToastKind::Error => WRONG,
                    };
                    let label = egui::RichText::new(text::printable(&toast.text, LONGEST)).color(colour);
                    ui.add(egui::Label::new(label).wrap());
                });
            });
        }
    });
}
