//! Blending per layer: one slider for all, or one each; presets.

use egui::{ComboBox, Slider, Ui};
use policy_core::NodeId;

use crate::app::{App, Layers, Preset, ViewerCommand};
use crate::text::spaced;

const NAMES: [&str; 3] = ["hidden 1", "hidden 2", "output"];

pub(super) fn show(ui: &mut Ui, app: &App, commands: &mut Vec<ViewerCommand>) {
    let (mut layers, mut reset) = (app.layers.clone(), false);
    ui.checkbox(&mut layers.active, "Sliders instead of the triggers")
        .on_hover_text("The sliders below say what is blended, until a trigger is pulled");
    ui.horizontal(|ui| {
        policy(ui, app, "0 is", &mut layers.from);
        policy(ui, app, "1 is", &mut layers.to);
    });
    ui.horizontal(|ui| {
        ui.radio_value(&mut layers.automatic, true, "Automatic").on_hover_text("One slider for all layers");
        ui.radio_value(&mut layers.automatic, false, "Manual").on_hover_text("One slider for each layer");
        reset = ui.button("Reset layers").on_hover_text("All sliders to 0 %").clicked();
    });
    if layers.automatic {
        share(ui, &mut layers.t[0], "all layers");
    } else {
        for (t, name) in layers.t.iter_mut().zip(NAMES) {
            share(ui, t, name);
        }
    }
    presets(ui, app, &mut layers, commands);
    // Moving a slider switches the sliders on; putting them back does not.
    layers.active |= layers.t != app.layers.t;
    if reset {
        layers.t = [0.0; 3];
    }
    if layers != app.layers {
        commands.push(ViewerCommand::Layers(layers));
    }
}

/// A slider from 0 to 100 %.
fn share(ui: &mut Ui, t: &mut f32, name: &str) {
    let percent = |t: f64, _| format!("{:.0} %", 100.0 * t);
    let parsed = |text: &str| text.trim_end_matches(['%', ' ']).parse::<f64>().ok().map(|p| p / 100.0);
    let slider = Slider::new(t, 0.0..=1.0).text(name).custom_formatter(percent).custom_parser(parsed);
    ui.add(slider).on_hover_text("Share of the policy on the right");
}

fn policy(ui: &mut Ui, app: &App, label: &str, chosen: &mut NodeId) {
    let nodes = app.sim.pack().graph().nodes();
    let list = ComboBox::new(label, label).width(80.0).selected_text(spaced(&nodes[chosen.index()].name));
    let list = list.show_ui(ui, |ui| {
        for (index, node) in nodes.iter().enumerate() {
            ui.selectable_value(chosen, NodeId::new(index), spaced(&node.name))
                .on_hover_text(format!("The slider's end is {}", spaced(&node.name)));
        }
    });
    list.response.on_hover_text("The policy at this end of the sliders");
}

fn presets(ui: &mut Ui, app: &App, layers: &mut Layers, commands: &mut Vec<ViewerCommand>) {
    let pack = app.sim.pack();
    ui.horizontal(|ui| {
        let label = ui.label("Name").id;
        ui.add(egui::TextEdit::singleline(&mut layers.name).desired_width(90.0))
            .labelled_by(label)
            .on_hover_text("Name of the blend; paste a copied one here");
        let save = ui.button("Save preset").on_hover_text("Keeps the sliders under this name");
        if save.clicked() && !layers.name.trim().is_empty() {
            commands.push(ViewerCommand::SavePreset(layers.preset(pack)));
        }
        if ui.button("Copy").on_hover_text("The sliders as text, to share").clicked()
            && let Ok(text) = ron::to_string(&layers.preset(pack))
        {
            ui.ctx().copy_text(text);
        }
    });
    // A preset that somebody shared is pasted over the name.
    if let Some(shared) = shared(&layers.name)
        && let Some(loaded) = Layers::of_preset(&shared, pack)
    {
        *layers = loaded;
    }
    for (index, preset) in app.layout.presets.iter().enumerate() {
        ui.horizontal(|ui| {
            let loaded = Layers::of_preset(preset, pack);
            let load = ui.add_enabled(loaded.is_some(), egui::Button::new(&preset.name));
            let load = load.on_hover_text("Sets the sliders to this blend");
            let fits = load.on_disabled_hover_text("of policies that this pack lacks");
            if let (true, Some(loaded)) = (fits.clicked(), loaded) {
                *layers = loaded;
            }
            ui.weak(format!("{} - {}", preset.from, preset.to));
            if ui.small_button("x").on_hover_text(format!("Delete {}", preset.name)).clicked() {
                commands.push(ViewerCommand::DeletePreset(index));
            }
        });
    }
}

fn shared(text: &str) -> Option<Preset> {
    text.trim_start().starts_with('(').then(|| ron::from_str(text).ok()).flatten()
}
