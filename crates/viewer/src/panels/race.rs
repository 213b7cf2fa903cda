//! The course of a shared world: where the player is on it, the clock, falls and the best time.

use egui::{Align2, Area, RichText, Ui};

use super::{PRESENT, REQUESTED, frame};
use crate::app::App;
use crate::text::counted;
use playground::RaceState;

/// The overlay at the top of the picture; nothing on the empty floor.
pub(super) fn show(ui: &Ui, app: &App, free: egui::Rect) {
    let Some(shared) = app.sim.shared() else { return };
    let (race, count) = (shared.race(), shared.scene().checkpoints.len());
    let clock = minutes(race.secs(app.sim.tick_secs()));
    let (state, colour) = match race.state() {
        RaceState::Waiting => ("Walk through the lit ring to start the clock".to_owned(), PRESENT),
        RaceState::Running => (format!("Checkpoint {} of {count}", race.next() + 1), REQUESTED),
        RaceState::Finished => ("Finished! Walk through the first ring to race again".to_owned(), PRESENT),
    };
    let at = free.center_top() + egui::vec2(0.0, 8.0);
    let area = Area::new(egui::Id::unique("race")).fixed_pos(at).pivot(Align2::CENTER_TOP);
    area.interactable(false).show(ui.ctx(), |ui| {
        frame().show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.colored_label(colour, state);
                if race.state() != RaceState::Waiting {
                    ui.label(RichText::new(clock).monospace().size(18.0));
                    ui.label(counted(u64::from(race.falls()), "fall"));
                }
                if let Some(best) = app.best.time() {
                    ui.weak(format!("best {}", minutes(best.secs)));
                }
            });
        });
    });
}

/// Minutes, seconds and tenths.
pub(super) fn minutes(secs: f32) -> String {
    let tenths = (secs * 10.0).round() as u32;
    format!("{}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_clock_reads_as_a_clock() {
        for (secs, text) in [(0.0, "0:00.0"), (59.96, "1:00.0"), (61.54, "1:01.5"), (605.2, "10:05.2")] {
            assert_eq!(super::minutes(secs), text);
        }
    }
}
