//! Where the player is among its policies, in words.

use super::App;

/// What is blended at present: the sliders of the layers while they steer, else the place on the graph.
#[must_use]
pub fn place(app: &App) -> String {
    let nodes = app.sim.pack().graph().nodes();
    if let (true, Some(_)) = (app.layers.active, app.sim.overrides.blend) {
        let layers = &app.layers;
        let percent = |t: f32| format!("{:.0}", 100.0 * t);
        let shares = if layers.automatic { percent(layers.t[0]) } else { layers.t.map(percent).join(", ") };
        return format!("layers: {} - {} {shares} %", nodes[layers.from].name, nodes[layers.to].name);
    }
    let position = app.sim.player().report().position;
    match position.as_node() {
        Some(node) => nodes[node].name.clone(),
        None => {
            format!("{} - {} {:.0} %", nodes[position.from].name, nodes[position.to].name, 100.0 * position.t)
        }
    }
}
