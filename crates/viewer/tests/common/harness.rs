//! The demo in a harness that drives its widgets.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use viewer::app::{App, PanelKind};

use super::app_with;

/// A demo in a window of 900 x 700 points.
pub fn harness(app: App) -> Harness<'static, App> {
    harness_of(app, egui::vec2(900.0, 700.0))
}

/// A demo in a window of any size, points.
pub fn harness_of(app: App, size: egui::Vec2) -> Harness<'static, App> {
    Harness::builder().with_size(size).build_ui_state(|ui, app: &mut App| app.ui(ui), app)
}

/// The same with one panel open.
pub fn open(kind: PanelKind) -> Harness<'static, App> {
    harness(app_with(kind))
}

/// Clicks the button that carries `label` and lets two frames pass.
pub fn click(harness: &mut Harness<'_, App>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run_steps(2);
}
