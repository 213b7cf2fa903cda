//! Over each view of a comparison: the blend mode, and how often its character has fallen.

use egui::{Align2, Color32, FontId, Rect, Stroke, Ui, vec2};

use super::WRONG;
use crate::app::App;
use crate::text::counted;

/// From the top of the picture, points.
const DOWN: f32 = 14.0;

pub(super) fn show(ui: &Ui, app: &App, free: Rect) {
    if app.views() == 1 {
        return;
    }
    let painter = ui.painter();
    for (view, character) in app.sim.characters().iter().enumerate() {
        let part = app.part(view, free);
        let top = part.center_top() + vec2(0.0, DOWN);
        let says = |at: egui::Pos2, text: &str, size: f32, colour: Color32| {
            let font = FontId::proportional(size);
            painter.text(
                at + vec2(1.0, 1.0),
                Align2::CENTER_TOP,
                text,
                font.clone(),
                Color32::from_black_alpha(160),
            );
            painter.text(at, Align2::CENTER_TOP, text, font, colour).bottom()
        };
        let bottom = says(top, character.blend_mode().name(), 22.0, Color32::WHITE);
        let falls = counted(u64::from(character.falls()), "fall");
        let colour = if character.falls() > 0 { WRONG } else { Color32::WHITE };
        says(egui::pos2(top.x, bottom + 2.0), &falls, 18.0, colour);
        if view > 0 {
            let edge = [part.left_top(), part.left_bottom()];
            painter.line_segment(edge, Stroke::new(2.0, Color32::from_black_alpha(200)));
        }
    }
}
