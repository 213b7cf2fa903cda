//! The simple layout: how fast the character is, what is blended, and which keys do what.

use egui::{
    Align2, Color32, CornerRadius, FontId, Frame, Margin, Rect, RichText, Sense, Stroke, TextStyle,
    TextWrapMode, Ui, WidgetText, vec2,
};
use policy_core::{Button, GamepadState, PolicyId};

use super::{PRESENT, frame, policy_colour};
use crate::app::{App, FirstStep, KeyAction};
use crate::sim::SHOVE_BUTTON;
use crate::text::spaced;

/// Height of the bar of weights, points.
const BAR_HEIGHT: f32 = 20.0;
/// Least width of a part that is named, points.
const NAMED_WIDTH: f32 = 64.0;
/// A narrower row of keys has smaller gaps, points.
const NARROW: f32 = 700.0;
/// A control that is pressed less is at rest.
const REST: f32 = 0.05;

pub(super) fn show(ui: &mut Ui, app: &App) {
    egui::Panel::bottom("simple").frame(frame()).show(ui, |ui| {
        ui.horizontal(|ui| {
            speed(ui, app);
            ui.separator();
            blend_bar(ui, app);
        });
        ui.horizontal_wrapped(|ui| {
            // In a small window a third row would leave too little of the view.
            let narrow = ui.available_width() < NARROW;
            let gap = if narrow { 0.0 } else { 6.0 };
            if narrow {
                ui.spacing_mut().item_spacing.x = 4.0;
            }
            for cap in caps(app) {
                draw_cap(ui, &cap, gap);
            }
            let (state, refused) = (app.clock.state(), app.refused().unwrap_or_default());
            ui.weak(format!("{state}  {refused}").trim());
        });
    });
}

fn speed(ui: &mut Ui, app: &App) {
    let mps = app.sim.player().speed();
    let text = RichText::new(format!("{mps:.1} m/s")).size(20.0).color(Color32::WHITE);
    // A fixed width: the bar beside it must not jump.
    let size = vec2(84.0, BAR_HEIGHT);
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    let response = ui.allocate_ui_with_layout(size, layout, |ui| ui.label(text)).inner;
    response.on_hover_text(format!("How fast the character moves: {:.0} km/h.", 3.6 * mps));
}

/// The shares of all policies, as parts of a bar.
fn blend_bar(ui: &mut Ui, app: &App) {
    let told = "How much each of the small networks steers at present. They are blended into one.";
    ui.label("Blending weights").on_hover_text(told);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), BAR_HEIGHT), Sense::hover());
    let corners = CornerRadius::same(3);
    ui.painter().rect_filled(rect, corners, ui.visuals().extreme_bg_color);
    let mut left = rect.left();
    for (policy, name, share) in shares(app) {
        let part = Rect::from_min_max(
            egui::pos2(left, rect.top()),
            egui::pos2(left + share * rect.width(), rect.bottom()),
        );
        ui.painter().rect_filled(part, corners, policy_colour(policy.index()).gamma_multiply(0.75));
        if part.width() > NAMED_WIDTH {
            let text = format!("{} {:.0} %", spaced(name), 100.0 * share);
            let font = FontId::proportional(13.0);
            ui.painter().with_clip_rect(part).text(
                part.center(),
                Align2::CENTER_CENTER,
                text,
                font,
                Color32::BLACK,
            );
        }
        left = part.right();
    }
    response.on_hover_text(told);
}

/// Name and share of each policy that steers, in the order of the pack; the shares add up to 1.
fn shares(app: &App) -> Vec<(PolicyId, &str, f32)> {
    let (pack, report) = (app.sim.pack(), app.sim.player().report());
    if let Some(running) = report.skill {
        let skill = &pack.skills()[running.skill.index()];
        return vec![(skill.policy, &skill.name, 1.0)];
    }
    let terms = report.blend.terms();
    let whole: f32 = terms.iter().map(|term| term.weights[0].max(0.0)).sum();
    let share = |weight: f32| if whole > 0.0 { weight.max(0.0) / whole } else { 0.0 };
    let name = |id: PolicyId| pack.manifest().policies.get(id.index()).map_or("", |p| p.name.as_str());
    let mut shares: Vec<_> =
        terms.iter().map(|term| (term.policy, name(term.policy), share(term.weights[0]))).collect();
    // Always in one order: the parts grow and shrink but do not change places.
    shares.sort_by_key(|(policy, ..)| policy.index());
    shares
}

/// A key or a control of the pad, what it does, and whether it is pressed.
struct Cap {
    key: String,
    action: &'static str,
    told: &'static str,
    pressed: bool,
}

/// What the character can do, on the pad when there is one.
fn caps(app: &App) -> Vec<Cap> {
    let (input, pack) = (app.input(), app.sim.pack());
    let keys = &app.layout.preferences.keys;
    let key = |action| keys.key(action).name().to_owned();
    let on_pad = app.uses_pad();
    let named = |pad: &str, keys: String| if on_pad { pad.to_owned() } else { keys };
    let pressed = |button: Button| input.buttons.contains(button);
    let cap = |key: String, action: &'static str, told: &'static str, pressed: bool| Cap {
        key,
        action,
        told,
        pressed,
    };
    let mut caps = vec![cap(
        named("left stick", keys.walk()),
        "walk",
        "Walks where the camera looks. With Shift it is slower.",
        stick(&input) > REST,
    )];
    if FirstStep::Run.is_offered(pack) {
        let told = "Hold it while you walk: the longer, the faster.";
        caps.push(cap(named("RT", key(KeyAction::Faster)), "faster", told, input.right_trigger > REST));
    }
    if FirstStep::Crouch.is_offered(pack) {
        let told = "Hold it: the longer, the lower, down to a crawl.";
        caps.push(cap(named("LT", key(KeyAction::Lower)), "lower", told, input.left_trigger > REST));
    }
    if pack.graph().path_named("strafe").is_some() {
        let told = "Hold it: faces where the camera looks and walks aside and back.";
        caps.push(cap(named("R3", key(KeyAction::Strafe)), "strafe", told, pressed(Button::RightStick)));
    }
    if FirstStep::Roll.is_offered(pack) {
        let told = "Rolls forward, from a walk.";
        caps.push(cap(named("B", key(KeyAction::Roll)), "roll", told, pressed(Button::East)));
    }
    if let Some(jump) = pack.skill_named("jump") {
        let told = match pack.skills()[jump.index()].in_stride.is_empty() {
            true => "Jumps. A character that runs slows down first.",
            false => "Jumps. On the move it does so in its stride.",
        };
        caps.push(cap(named("Y", key(KeyAction::Jump)), "jump", told, pressed(Button::North)));
    }
    if pack.skill_named("punch").is_some() {
        let told = "Punches. A character that runs slows down first.";
        caps.push(cap(named("X", key(KeyAction::Punch)), "punch", told, pressed(Button::West)));
    }
    if pack.recovery().is_some() {
        let told = "Gets up. After a fall that comes by itself.";
        caps.push(cap(named("A", key(KeyAction::GetUp)), "get up", told, pressed(Button::South)));
    }
    let told = "Knocks the character over, to see how it gets up.";
    caps.push(cap(named("LB", key(KeyAction::Shove)), "knock over", told, pressed(SHOVE_BUTTON)));
    let told = "Drag a limb with the left mouse button; beside the character it turns the camera.";
    caps.push(cap("mouse".into(), "pull", told, app.grab.is_some()));
    caps
}

fn stick(input: &GamepadState) -> f32 {
    input.left_stick[0].hypot(input.left_stick[1])
}

/// Margin of a cap beside its text, points.
const CAP_MARGIN: i8 = 6;

/// A cap and what it does, on one row: where the rest of the row is too short for both, on the next one.
fn draw_cap(ui: &mut Ui, cap: &Cap, gap: f32) {
    let width = |ui: &Ui, text: &str| {
        let text = WidgetText::from(text);
        text.into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, TextStyle::Body).size().x
    };
    let needed = width(ui, &cap.key) + width(ui, cap.action) + 2.0 * f32::from(CAP_MARGIN) + 2.0;
    if ui.available_size_before_wrap().x < needed + ui.spacing().item_spacing.x {
        ui.end_row();
    }
    let (fill, text) = match cap.pressed {
        true => (PRESENT, Color32::BLACK),
        false => (Color32::from_gray(52), Color32::WHITE),
    };
    let shape = Frame::new()
        .fill(fill)
        .stroke(Stroke::new(1.0, Color32::from_gray(110)))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::symmetric(CAP_MARGIN, 2));
    let key = shape.show(ui, |ui| ui.label(RichText::new(&cap.key).color(text))).response;
    key.on_hover_text(cap.told);
    ui.label(cap.action).on_hover_text(cap.told);
    ui.add_space(gap);
}
