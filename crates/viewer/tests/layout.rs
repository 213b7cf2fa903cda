//! Where panels are: opened, closed, moved, and never wider than the window allows.

mod common;

use common::app_with;
use common::harness::{click, harness_of, open};
use egui_kittest::Harness;
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
fn help_fits_the_window() {
    for size in [egui::vec2(1280.0, 720.0), egui::vec2(800.0, 500.0)] {
        let mut app = app_with(PanelKind::Record);
        app.help = true;
        let mut harness = harness_of(app, size);
        harness.run_steps(4);
        let rect = harness.ctx.memory(|m| m.area_rect(egui::Id::unique("help"))).unwrap();
        assert!(rect.top() >= 0.0 && rect.bottom() <= size.y, "{rect} in {size}");
    }
}

#[test]
fn panels_leave_a_view_however_small_the_window() {
    for (width, least) in [(1280.0, 400.0), (800.0, 400.0), (640.0, 300.0), (320.0, 320.0)] {
        let layout = viewer::app::PanelLayout::default();
        let app = App::new(common::simulation(), layout);
        let mut harness = harness_of(app, egui::vec2(width, 480.0));
        harness.run_steps(3);
        let free = harness.ctx.content_rect().width() - side_widths(&harness);
        assert!(free >= least, "{width}: {free} are left");
    }
}

/// Width of the columns of panels.
fn side_widths(harness: &Harness<'_, App>) -> f32 {
    let width = |id: &str| {
        egui::containers::panel::PanelState::load(&harness.ctx, egui::Id::unique(id))
            .map_or(0.0, |s| s.outer_rect.width())
    };
    width("left") + width("right")
}
