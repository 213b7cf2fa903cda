//! Where the time goes.

use egui::Ui;
use egui_plot::{Legend, Line, Plot, PlotPoints};

use crate::app::{App, Series};

/// Points that numbers are means of.
const WINDOW: usize = 60;

pub(super) fn show(ui: &mut Ui, app: &App) {
    let plots = &app.plots;
    let curves: [(&str, &Series); 4] = [
        ("policy", &plots.policy),
        ("physics", &plots.physics),
        ("draw", &plots.draw),
        ("panels", &plots.ui),
    ];
    ui.label(format!("real-time factor {:.2}", app.clock.realtime_factor));
    egui::Grid::new("numbers").num_columns(2).show(ui, |ui| {
        for (name, series) in curves {
            ui.label(name);
            ui.label(format!("{:.3} ms", series.mean(WINDOW)));
            ui.end_row();
        }
    });
    let plot = Plot::new("times").height(110.0).include_y(0.0).allow_drag(false).allow_zoom(false);
    plot.allow_scroll(false).show_axes([false, true]).legend(Legend::default()).show(ui, |plot| {
        for (name, series) in curves {
            let points: PlotPoints<'_> = series.points().collect();
            plot.line(Line::new(name, points));
        }
    });
    if !app.adapter.is_empty() {
        ui.weak(&app.adapter);
    }
}
