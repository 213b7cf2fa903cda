//! Time and physics: pause, steps, the last ten seconds, speed, gravity, friction, strength, mass, ground, crowd.

use egui::{Slider, Ui};

use crate::app::{App, Clock, ViewerCommand};
use crate::sim::{Engine, GhostKind, GroundKind, LEAST_FRICTION, MAX_CHARACTERS, SceneKind};
use crate::text::noun;

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    time(ui, app, commands);
    matter(ui, app, commands);
    scene(ui, app, commands);
    let on_empty_floor = app.sim.shared().is_none();
    ui.add_enabled_ui(on_empty_floor, |ui| {
        engine(ui, app, commands);
        ui.horizontal(|ui| {
            ui.label("Ground");
            for ground in GroundKind::ALL {
                let label = ui.selectable_label(app.sim.config().ground == ground, ground.name());
                let label = label.on_hover_text("Another ground; the characters begin anew on it.");
                if label.on_disabled_hover_text(ONLY_EMPTY).clicked() {
                    commands.push(ViewerCommand::Ground(ground));
                }
            }
        });
    });
    let mut characters = app.sim.config().characters;
    let label = noun(characters as u64, "character");
    let most = app.sim.shared().map_or(MAX_CHARACTERS, |shared| shared.scene().starts.len());
    let slider = Slider::new(&mut characters, 1..=most).logarithmic(on_empty_floor).text(label);
    // A crowd is made anew for every number, so only where the drag ends.
    let response = ui.add(slider.update_while_editing(false));
    let response = response.on_hover_text("How many characters there are. All do what you ask.");
    if response.changed() {
        commands.push(ViewerCommand::Characters(characters));
    }
    ui.weak("Pull a body with the left mouse button.");
}

/// What is greyed in the playground, and why.
const ONLY_EMPTY: &str = "On the empty floor only: the playground is flat, in MuJoCo, and without ghosts.";
const NO_MASS: &str = "In the playground masses can't be changed.";

/// What stands on the floor.
fn scene(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    ui.horizontal(|ui| {
        ui.label("Scene");
        for scene in SceneKind::ALL {
            let label = ui.selectable_label(app.sim.config().scene == scene, scene.name());
            if label.on_hover_text("What stands on the floor; the characters begin anew.").clicked() {
                commands.push(ViewerCommand::Scene(scene));
            }
        }
    });
}

/// The engine, and a ghost in the other one.
fn engine(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let present = app.sim.engine();
    ui.horizontal(|ui| {
        ui.label("Engine");
        for engine in Engine::ALL {
            let label = ui.selectable_label(engine == present, engine.title());
            let label = label.on_hover_text("The characters begin anew in it.");
            if label.on_disabled_hover_text(ONLY_EMPTY).clicked() {
                commands.push(ViewerCommand::Engine(engine));
            }
        }
    });
    let ghost = GhostKind::Engine(present.other());
    let mut shown = app.sim.ghost().is_some_and(|g| g.kind() == ghost);
    let label = format!("Ghost in {}", present.other().title());
    let told = "A second character from the same state, under the same commands, in the other engine.";
    let ghost_box = ui.checkbox(&mut shown, label).on_hover_text(told);
    if ghost_box.on_disabled_hover_text(ONLY_EMPTY).changed() {
        commands.push(ViewerCommand::Ghost(shown.then_some(ghost)));
    }
}

fn time(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let engine = app.sim.engine();
    let no_history = format!("{} keeps no history to go back to.", engine.title());
    ui.horizontal(|ui| {
        let (label, pause) = if app.clock.paused { ("Play", false) } else { ("Pause", true) };
        if ui.button(label).on_hover_text("Stops time, or lets it go on (P)").clicked() {
            commands.push(ViewerCommand::Pause(pause));
        }
        let back = ui.add_enabled(engine.keeps_history(), egui::Button::new("Step back"));
        let back = back.on_hover_text("One tick back (B)");
        if back.on_disabled_hover_text(&no_history).clicked() {
            commands.push(ViewerCommand::StepBack);
        }
        if ui.button("Step").on_hover_text("One tick ahead (N)").clicked() {
            commands.push(ViewerCommand::Step);
        }
        if ui.button("Reset").on_hover_text("All characters back to the start (Backspace)").clicked() {
            commands.push(ViewerCommand::Reset);
        }
    });
    let (kept, age) = app.sim.history();
    let tick_secs = app.sim.tick_secs();
    let mut ago = 0.0 - age as f32 * tick_secs;
    let reach = (kept as f32 * tick_secs).max(tick_secs);
    let slider = Slider::new(&mut ago, -reach..=0.0).text("ago").suffix(" s").fixed_decimals(2);
    let moved = ui
        .add_enabled(engine.keeps_history(), slider)
        .on_hover_text("Goes back through the last seconds")
        .on_disabled_hover_text(&no_history)
        .changed();
    let wanted = ((-ago / tick_secs).round() as usize).min(kept);
    // The slider rounds to what it shows: that alone is no wish to go back.
    if moved && wanted != age {
        commands.push(ViewerCommand::Scrub(wanted));
    }
    let mut step = Clock::SPEEDS.iter().position(|s| *s >= app.clock.speed * 0.99).unwrap_or(0);
    let last = Clock::SPEEDS.len() - 1;
    let name = |index: f64| match Clock::SPEEDS[(index as usize).min(last)] {
        speed if speed < 1.0 => format!("1/{} ×", (1.0 / speed).round()),
        speed => format!("{speed} ×"),
    };
    let slider = Slider::new(&mut step, 0..=last).text("speed").custom_formatter(move |n, _| name(n));
    if ui.add(slider).on_hover_text("How fast time runs, against real time").changed() {
        commands.push(ViewerCommand::Speed(Clock::SPEEDS[step.min(last)]));
    }
}

fn matter(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let mut settings = app.sim.model().settings();
    let before = settings;
    let mut factor = |value, range, (unit, name, told): (&str, &str, &str)| {
        ui.add(Slider::new(value, range).suffix(unit).text(name)).on_hover_text(told);
    };
    factor(&mut settings.gravity, 0.0..=3.0, (" g", "gravity", "1 g is that of the Earth"));
    let told = "Of the ground, against that of the training";
    factor(&mut settings.friction, LEAST_FRICTION..=3.0, (" ×", "friction", told));
    factor(
        &mut settings.strength,
        0.0..=3.0,
        (" ×", "strength", "Of all joints, against the character's own"),
    );
    let mass = Slider::new(&mut settings.mass, 0.2..=3.0).suffix(" ×").text("mass");
    let mass = ui.add_enabled(app.sim.shared().is_none(), mass);
    mass.on_hover_text("Of all bodies, against the character's own").on_disabled_hover_text(NO_MASS);
    if settings != before {
        commands.push(ViewerCommand::Settings(settings));
    }
}
