//! `trainer pca`: the paper's figures 5 (visited states) and 6 (parameters), as pictures and as CSV, and the correlation
//! between distances of parameters and of states.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use clap::Args;
use physics_bridge::Model;
use plotters::prelude::*;
use policy_core::{CharacterPack, Mlp, NodeId};
use rayon::prelude::*;
use trainer::evaluate::EvalCharacter;
use trainer::pca::{Components, correlation};
use trainer::storage::write_atomically;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The pack.
    pack: PathBuf,
    /// Folder for `states` and `parameters`, each as .csv and .svg.
    #[arg(long, default_value = "out/pca")]
    out: PathBuf,
    /// Seconds that each policy is watched.
    #[arg(long, default_value_t = 20.0)]
    secs: f32,
}

/// Computes and writes.
pub(crate) fn run(model: &Model, arguments: &Arguments) -> Result<()> {
    let path = &arguments.pack;
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let pack = Arc::new(CharacterPack::from_bytes(&bytes).with_context(|| path.display().to_string())?);
    std::fs::create_dir_all(&arguments.out)?;
    let ticks = (arguments.secs * pack.control_hz()) as usize;
    // What lies on a path: skills that run by switch lie far away and would leave no room for the rest.
    let graph = pack.graph();
    let on_a_path = |node: &NodeId| graph.paths().iter().any(|path| path.nodes().contains(node));
    let chosen: Vec<NodeId> = (0..graph.nodes().len()).map(NodeId::new).filter(on_a_path).collect();
    ensure!(!chosen.is_empty(), "{}: expected a path, found none", path.display());
    let nodes: Vec<_> = chosen.iter().map(|node| graph.node(*node)).collect();
    let visited: Vec<Vec<Vec<f32>>> =
        chosen.par_iter().map(|node| states(model, &pack, *node, ticks)).collect();
    let all: Vec<Vec<f32>> = visited.iter().flatten().cloned().collect();
    let states = Components::of(&all, 2);
    let mut csv = String::from("policy,x,y\n");
    for (node, rows) in nodes.iter().zip(&visited) {
        for row in rows {
            let p = states.project(row);
            let _ = writeln!(csv, "{},{:.4},{:.4}", node.name, p[0], p[1]);
        }
    }
    write_atomically(&arguments.out.join("states.csv"), csv.as_bytes())?;

    let flat: Vec<Vec<f32>> = chosen.iter().map(|node| parameters(&pack.policies()[node.index()])).collect();
    let components = Components::of(&flat, 2);
    let mut csv = String::from("policy,x,y\n");
    for (node, row) in nodes.iter().zip(&flat) {
        let p = components.project(row);
        let _ = writeln!(csv, "{},{:.4},{:.4}", node.name, p[0], p[1]);
    }
    write_atomically(&arguments.out.join("parameters.csv"), csv.as_bytes())?;

    let names: Vec<&str> = nodes.iter().map(|n| n.name.as_str()).collect();
    let points = |c: &Components, rows: &[Vec<f32>]| -> Vec<[f64; 2]> {
        rows.iter().map(|row| c.project(row)).map(|p| [p[0], p[1]]).collect()
    };
    let by_policy: Vec<_> = visited.iter().map(|rows| points(&states, rows)).collect();
    scatter(&arguments.out.join("states.svg"), "visited states", &names, &by_policy, &[])?;
    let by_policy: Vec<_> = flat.iter().map(|row| points(&components, std::slice::from_ref(row))).collect();
    let at = |node: NodeId| chosen.iter().position(|c| *c == node);
    let edges = graph.edges().iter().filter_map(|e| Some([at(e.nodes[0])?, at(e.nodes[1])?]));
    let edges: Vec<_> = edges.collect();
    scatter(&arguments.out.join("parameters.svg"), "parameters", &names, &by_policy, &edges)?;

    let (mut of_parameters, mut of_states) = (Vec::new(), Vec::new());
    for a in 0..nodes.len() {
        for b in a + 1..nodes.len() {
            of_parameters.push(distance(&flat[a], &flat[b]));
            of_states.push(distance(&mean(&visited[a]), &mean(&visited[b])));
        }
    }
    let share = |c: &Components| 100.0 * c.variances.iter().sum::<f64>() / c.total_variance.max(1e-12);
    say(format_args!("states: two components hold {:.0} % of the variance", share(&states)))?;
    say(format_args!("parameters: two components hold {:.0} % of the variance", share(&components)))?;
    say(format_args!("correlation of distances: {:.2}", correlation(&of_parameters, &of_states)))?;
    say(format_args!("wrote {}", arguments.out.display()))?;
    Ok(())
}

/// Draws the points of each policy in its own colour, and lines between policies.
fn scatter(
    path: &Path,
    title: &str,
    names: &[&str],
    points: &[Vec<[f64; 2]>],
    edges: &[[usize; 2]],
) -> Result<()> {
    let range = |axis: usize| {
        let all = points.iter().flatten().map(|p| p[axis]);
        let (low, high) = all.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        let margin = 0.05 * (high - low).max(1e-3);
        // Room for the legend on the right, where it covers nothing.
        low - margin..high + if axis == 0 { 6.0 * margin } else { margin }
    };
    let root = SVGBackend::new(path, (800, 600)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 20))
        .margin(10)
        .x_label_area_size(30)
        .y_label_area_size(45)
        .build_cartesian_2d(range(0), range(1))?;
    chart.configure_mesh().disable_mesh().x_desc("first component").y_desc("second component").draw()?;
    let size = if edges.is_empty() { 2 } else { 6 };
    for edge in edges {
        let ends = edge.iter().filter_map(|node| points[*node].first()).map(|p| (p[0], p[1]));
        chart.draw_series(LineSeries::new(ends, BLACK.mix(0.4)))?;
    }
    for (i, (name, points)) in names.iter().zip(points).enumerate() {
        let colour = Palette99::pick(i).to_rgba();
        chart
            .draw_series(points.iter().map(|p| Circle::new((p[0], p[1]), size, colour.filled())))?
            .label(*name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 5, colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    Ok(())
}

/// Normalised observations that a policy visits while it goes straight ahead.
fn states(model: &Model, pack: &Arc<CharacterPack>, node: NodeId, ticks: usize) -> Vec<Vec<f32>> {
    let mut character = EvalCharacter::at(model, pack, node);
    let mut rows = Vec::with_capacity(ticks);
    for _ in 0..ticks {
        let command = character.ahead(node);
        character.tick(&command);
        rows.push(character.controller.policy_input()[..pack.skeleton().observation_len()].to_vec());
    }
    rows
}

fn parameters(mlp: &Mlp) -> Vec<f32> {
    mlp.layers().iter().flat_map(|l| l.weight().chain(l.bias()).collect::<Vec<_>>()).collect()
}

fn mean(rows: &[Vec<f32>]) -> Vec<f32> {
    let width = rows.first().map_or(0, Vec::len);
    let n = rows.len().max(1) as f32;
    (0..width).map(|i| rows.iter().map(|r| r[i]).sum::<f32>() / n).collect()
}

fn distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
}
