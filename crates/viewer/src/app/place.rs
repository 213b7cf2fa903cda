//! Where the player is among its policies, in words.

use policy_core::NodeId;

use super::App;
use crate::text::spaced;

/// What is blended at present: the sliders of the layers while they steer, else the place on the graph.
#[must_use]
pub fn place(app: &App) -> String {
    let graph = app.sim.pack().graph();
    let name = |node: NodeId| spaced(&graph.node(node).name);
    if let (true, Some(_)) = (app.layers.active, app.sim.overrides.blend) {
        let layers = &app.layers;
        let percent = |t: f32| format!("{:.0}", 100.0 * t);
        let shares = if layers.automatic { percent(layers.t[0]) } else { layers.t.map(percent).join(", ") };
        return format!("layers: {} - {} {shares} %", name(layers.from), name(layers.to));
    }
    let position = app.sim.player().report().position;
    match position.as_node() {
        Some(node) => name(node),
        None => {
            format!("{} - {} {:.0} %", name(position.from), name(position.to), 100.0 * position.t)
        }
    }
}
