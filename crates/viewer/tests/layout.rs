//! Where panels are: opened, closed, moved, and never wider than the window allows.

mod common;

use common::app_with;
use common::harness::{click, harness_of, open};
use viewer::app::{App, PanelKind, Side};

#[test]
fn the_bar_opens_closes_and_panels_change_sides() {
    let mut harness = open(PanelKind::Record);
    click(&mut harness, "Analysis");
    assert!(harness.state().layout.side_of(PanelKind::Analysis).is_some());
    click(&mut harness, "Analysis");
    assert_eq!(harness.state().layout.side_of(PanelKind::Analysis), None);
    click(&mut harness, "<>");
    assert_eq!(harness.state().layout.side_of(PanelKind::Record), Some(Side::Right));
    click(&mut harness, "x");
    assert_eq!(harness.state().layout.side_of(PanelKind::Record), None);
}

#[test]
fn help_and_settings_fit_the_window() {
    for size in [egui::vec2(1280.0, 720.0), egui::vec2(800.0, 500.0), egui::vec2(640.0, 480.0)] {
        for name in ["help", "settings"] {
            let mut app = app_with(PanelKind::Record);
            (app.help, app.choosing) = (name == "help", name == "settings");
            let mut harness = harness_of(app, size);
            harness.run_steps(4);
            let rect = harness.ctx.memory(|m| m.area_rect(egui::Id::unique(name))).unwrap();
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
            assert!(screen.contains_rect(rect), "{name}: {rect} in {size}");
        }
    }
}

#[test]
fn panels_leave_a_view_however_small_the_window() {
    for (width, least) in [(1280.0, 400.0), (800.0, 400.0), (640.0, 300.0), (320.0, 300.0)] {
        let layout = common::advanced(viewer::app::PanelLayout::default().open);
        let app = App::new(common::simulation(), layout);
        let mut harness = harness_of(app, egui::vec2(width, 480.0));
        harness.run_steps(3);
        let free = harness.state().free.width();
        assert!(free >= least && free <= width, "{width}: {free} are left");
        // The harness has a margin of its own.
        assert_eq!(free < width - 20.0, width > 600.0, "{width}: a column where there is room for it");
    }
}
