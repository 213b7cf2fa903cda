//! The panels. Each reads an [`App`] and pushes [`ViewerCommand`]s; none changes anything by itself.

mod analysis;
mod blend_mode;
mod comparison;
mod failure;
mod first_steps;
mod graph;
mod help;
mod layers;
mod leave;
mod pad;
mod paths;
mod physics;
mod preferences;
mod profiler;
mod race;
mod record;
mod replay;
mod simple;
mod skills;
mod toasts;
mod view;

use egui::{Color32, Frame, Margin, Rect, Ui};

use crate::app::{self, App, PanelKind, Preferences, Side, ViewerCommand};

/// Colour of what is asked for.
pub(crate) const REQUESTED: Color32 = Color32::from_rgb(0xe8, 0x8a, 0x3c);
/// Colour of what is so.
pub(crate) const PRESENT: Color32 = Color32::from_rgb(0x5f, 0xb7, 0xd6);
/// Colour of what is wrong.
pub(crate) const WRONG: Color32 = Color32::from_rgb(0xe0, 0x5a, 0x4e);

/// Width of the sides, points.
const SIDE_WIDTH: f32 = 290.0;
/// Least width of the picture beside them, points.
const LEAST_VIEW: f32 = 300.0;

/// Draws everything; returns the part of the window that no panel covers.
pub(crate) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) -> Rect {
    let is_simple = !app.layout.preferences.advanced;
    if !app.layout.hidden {
        bar(ui, app, commands);
        if is_simple {
            simple::show(ui, app);
        } else {
            columns(ui, app, commands);
        }
    }
    let free = ui.available_rect_before_wrap();
    if app.layout.hidden || !is_simple {
        status(ui, app, free);
    } else {
        first_steps::show(ui, app, free, commands);
    }
    first_steps::tour(ui, app, free);
    race::show(ui, app, free);
    replay::show(ui, app, free);
    comparison::show(ui, app, free);
    toasts::show(ui, app, free, commands);
    if app.help {
        help::show(ui, app, commands);
    }
    if app.choosing {
        preferences::show(ui, app, commands);
    }
    if app.leaving {
        leave::show(ui, app, commands);
    }
    if let Some(failure) = &app.failure {
        failure::show(ui, failure, commands);
    }
    free
}

/// Colour of a policy, wherever it is drawn.
fn policy_colour(policy: usize) -> Color32 {
    egui::ecolor::Hsva::new((policy as f32 * 0.381_966) % 1.0, 0.55, 0.9, 1.0).into()
}

fn frame() -> Frame {
    Frame::new().fill(Color32::from_rgba_unmultiplied(22, 25, 30, 225)).inner_margin(Margin::same(8))
}

/// The bar on top: one switch for each panel of the advanced layout, then what every player needs.
fn bar(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let preferences = app.layout.preferences;
    egui::Panel::top("bar").frame(frame()).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            if preferences.advanced {
                for kind in PanelKind::ALL {
                    let open = app.layout.side_of(kind).is_some();
                    if ui.selectable_label(open, kind.title()).on_hover_text(kind.text()).clicked() {
                        commands.push(ViewerCommand::TogglePanel(kind));
                    }
                }
                ui.separator();
            }
            if ui.button("Help (F1)").on_hover_text("What every key and button does").clicked() {
                commands.push(ViewerCommand::Help(!app.help));
            }
            let told = "Camera, sensitivity, text size, quality, keys";
            if ui.button("Settings (F4)").on_hover_text(told).clicked() {
                commands.push(ViewerCommand::ChoosePreferences(!app.choosing));
            }
            let mut advanced = preferences.advanced;
            let told = "Panels that show how the method works, for the curious";
            if ui.checkbox(&mut advanced, "Advanced").on_hover_text(told).changed() {
                commands.push(ViewerCommand::Preferences(Preferences { advanced, ..preferences }));
            }
            let compares = app.views() > 1;
            let (label, told) = match compares {
                true => ("End comparison", "Back to the scene, from its start"),
                false => {
                    ("Compare", "Three ways to blend under the same stick, side by side, with falls counted")
                }
            };
            if app.sim.playback().is_none() && ui.button(label).on_hover_text(told).clicked() {
                commands.push(ViewerCommand::Compare(!compares));
            }
        });
    });
}

/// The panels on both sides of the picture. Where there is too little room they share one column, and where there
/// is too little even for that a line says so.
fn columns(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let on = |side: Side| -> Vec<PanelKind> {
        app.layout.open.iter().filter(|(_, s)| *s == side).map(|(kind, _)| *kind).collect()
    };
    let (mut left, mut right) = (on(Side::Left), on(Side::Right));
    let room = ui.available_width();
    if room < SIDE_WIDTH + LEAST_VIEW {
        if !left.is_empty() || !right.is_empty() {
            let top = egui::Panel::top("too narrow").frame(frame());
            top.show(ui, |ui| ui.weak("The window is too narrow for panels"));
        }
        return;
    }
    if room < 2.0 * SIDE_WIDTH + LEAST_VIEW && !left.is_empty() {
        left.append(&mut right);
    }
    column(ui, app, (Side::Left, &left), commands);
    column(ui, app, (Side::Right, &right), commands);
}

/// Panels from top to bottom.
fn column(ui: &mut Ui, app: &App, (side, kinds): (Side, &[PanelKind]), commands: &mut Vec<ViewerCommand>) {
    if kinds.is_empty() {
        return;
    }
    let panel = match side {
        Side::Left => egui::Panel::left("left"),
        Side::Right => egui::Panel::right("right"),
    };
    panel.default_size(SIDE_WIDTH).frame(frame()).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for kind in kinds {
                titled(ui, app, *kind, commands);
            }
        });
    });
}

fn titled(ui: &mut Ui, app: &App, kind: PanelKind, commands: &mut Vec<ViewerCommand>) {
    ui.horizontal(|ui| {
        ui.heading(kind.title());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let title = kind.title();
            if ui.small_button("x").on_hover_text(format!("Close {title}")).clicked() {
                commands.push(ViewerCommand::TogglePanel(kind));
            }
            if ui.small_button("<>").on_hover_text(format!("Move {title} to the other side")).clicked() {
                commands.push(ViewerCommand::SwapSide(kind));
            }
        });
    });
    ui.push_id(kind.title(), |ui| match kind {
        PanelKind::Paths => paths::show(ui, app, commands),
        PanelKind::Graph => graph::show(ui, app, commands),
        PanelKind::Layers => layers::show(ui, app, commands),
        PanelKind::BlendMode => blend_mode::show(ui, app, commands),
        PanelKind::Skills => skills::show(ui, app, commands),
        PanelKind::Pad => pad::show(ui, app),
        PanelKind::Analysis => analysis::show(ui, app),
        PanelKind::Physics => physics::show(ui, app, commands),
        PanelKind::View => view::show(ui, app, commands),
        PanelKind::Profiler => profiler::show(ui, app),
        PanelKind::Record => record::show(ui, app, commands),
    });
    ui.add_space(6.0);
    ui.separator();
}

/// One line at the foot of the picture: what the character does.
fn status(ui: &Ui, app: &App, free: Rect) {
    let player = app.sim.player();
    let skill = player.report().skill.map(|s| app.sim.pack().skills()[s.skill.index()].name.as_str());
    let state = format!("  {}", app.clock.state());
    let state = state.trim_end();
    let text = match app.sim.playback() {
        Some(clip) => {
            format!("{}   {:.2} of {:.2} s{state}", clip.clip(), clip.secs(app.alpha()), clip.duration())
        }
        None => {
            let refused = app.refused().map(|what| format!("   {what}")).unwrap_or_default();
            format!("{}   {:.2} m/s{state}{refused}", skill.unwrap_or(&app::place(app)), player.speed())
        }
    };
    let at = free.left_bottom() + egui::vec2(14.0, -12.0);
    let painter = ui.painter();
    let font = egui::FontId::proportional(15.0);
    let shade = Color32::from_black_alpha(140);
    painter.text(at + egui::vec2(1.0, 1.0), egui::Align2::LEFT_BOTTOM, &text, font.clone(), shade);
    painter.text(at, egui::Align2::LEFT_BOTTOM, &text, font, Color32::WHITE);
}
