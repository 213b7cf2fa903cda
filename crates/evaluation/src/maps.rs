//! Policies on maps of two principal components: by the states that they visit (the paper's figure 5) and by their parameters
//! (figure 6).

mod scatter;

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use pca::Components;
use physics::Model;
use policy_core::{CharacterPack, Mlp, NodeId};
use rayon::prelude::*;

use super::eval_character::EvalCharacter;
use super::plots::PlotError;

/// One map: rows of numbers of each policy, and their two leading components.
#[derive(Clone, Debug)]
pub struct Map {
    title: &'static str,
    names: Vec<String>,
    rows: Vec<Vec<Vec<f32>>>,
    components: Components,
    edges: Vec<[usize; 2]>,
}

/// Both maps of the policies that lie on a path. Skills that run by switch lie far away and would leave no room for the rest.
#[derive(Clone, Debug)]
pub struct Maps {
    /// By normalised observations that each policy visits.
    pub states: Map,
    /// By parameters: one point for each policy, with the edges of the graph.
    pub parameters: Map,
}

impl Maps {
    /// Watches each policy go straight ahead for so many seconds. `None` when the pack has no path.
    #[must_use]
    pub fn of(model: &Model, pack: &Arc<CharacterPack>, secs: f32) -> Option<Self> {
        let graph = pack.graph();
        let on_a_path = |node: &NodeId| graph.paths().iter().any(|path| path.nodes().contains(node));
        let chosen: Vec<NodeId> = (0..graph.nodes().len()).map(NodeId::new).filter(on_a_path).collect();
        if chosen.is_empty() {
            return None;
        }
        let names = || chosen.iter().map(|node| graph.node(*node).name.clone()).collect();
        let ticks = (secs * pack.control_hz()) as usize;
        let visited = chosen.par_iter().map(|node| visited(model, pack, *node, ticks)).collect();
        let parameters = |node: &NodeId| vec![parameters(&pack.policies()[node.index()])];
        let at = |node: NodeId| chosen.iter().position(|c| *c == node);
        let edges = graph.edges().iter().filter_map(|e| Some([at(e.nodes[0])?, at(e.nodes[1])?]));
        let parameters = chosen.iter().map(parameters).collect();
        Some(Self {
            states: Map::new("visited states", names(), visited, Vec::new()),
            parameters: Map::new("parameters", names(), parameters, edges.collect()),
        })
    }

    /// Correlation between the distances of policies by parameters and by the mean states that they visit.
    #[must_use]
    pub fn correlation(&self) -> f64 {
        correlation(&self.parameters.distances(), &self.states.distances())
    }
}

impl Map {
    fn new(
        title: &'static str,
        names: Vec<String>,
        rows: Vec<Vec<Vec<f32>>>,
        edges: Vec<[usize; 2]>,
    ) -> Self {
        let all: Vec<&[f32]> = rows.iter().flatten().map(Vec::as_slice).collect();
        let components = Components::of(&all, 2);
        Self { title, names, rows, components, edges }
    }

    /// Share of the variance that the two components hold, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.components.variances.iter().sum::<f64>() / self.components.total_variance.max(1e-12)
    }

    /// The points as CSV: policy, x, y.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut csv = String::from("policy,x,y\n");
        for (name, points) in self.names.iter().zip(self.points()) {
            for [x, y] in points {
                let _ = writeln!(csv, "{name},{x:.4},{y:.4}");
            }
        }
        csv
    }

    /// Draws the points of each policy in its own colour, and the edges, to an SVG file.
    ///
    /// # Errors
    /// When the picture can't be written.
    pub fn draw(&self, svg: &Path) -> Result<(), PlotError> {
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        scatter::draw(svg, self.title, &names, &self.points(), &self.edges)
    }

    /// Points of each policy on the two components.
    fn points(&self) -> Vec<Vec<[f64; 2]>> {
        let point = |row: &Vec<f32>| {
            let at = self.components.project(row);
            [0, 1].map(|axis| at.get(axis).copied().unwrap_or_default())
        };
        self.rows.iter().map(|rows| rows.iter().map(point).collect()).collect()
    }

    /// Distances between the mean rows of all pairs of policies.
    fn distances(&self) -> Vec<f64> {
        let means: Vec<Vec<f32>> = self.rows.iter().map(|rows| mean(rows)).collect();
        let pairs = (0..means.len()).flat_map(|a| (a + 1..means.len()).map(move |b| (a, b)));
        pairs.map(|(a, b)| distance(&means[a], &means[b])).collect()
    }
}

/// Normalised observations that a policy visits while it goes straight ahead.
fn visited(model: &Model, pack: &Arc<CharacterPack>, node: NodeId, ticks: usize) -> Vec<Vec<f32>> {
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

/// Pearson's correlation of two lists of equal length; zero when one of them is constant.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len()).max(1) as f64;
    let (ma, mb) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let covariance: f64 = a.iter().zip(b).map(|(x, y)| (x - ma) * (y - mb)).sum();
    let spread = |v: &[f64], m: f64| v.iter().map(|x| (x - m).powi(2)).sum::<f64>().sqrt();
    let scale = spread(a, ma) * spread(b, mb);
    if scale < 1e-12 { 0.0 } else { covariance / scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_of_lines_is_one() {
        assert!((correlation(&[1.0, 2.0, 3.0], &[2.0, 4.0, 6.0]) - 1.0).abs() < 1e-12);
        assert!((correlation(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]) + 1.0).abs() < 1e-12);
        assert_eq!(correlation(&[1.0, 1.0], &[0.0, 5.0]), 0.0);
    }

    #[test]
    fn a_map_has_a_point_for_each_row_and_distances_for_each_pair() {
        let rows = vec![vec![vec![0.0, 0.0, 1.0], vec![2.0, 0.0, 1.0]], vec![vec![1.0, 4.0, 1.0]]];
        let map = Map::new("made up", vec!["a".into(), "b".into()], rows, vec![[0, 1]]);
        assert_eq!(map.csv().lines().count(), 4);
        assert!((map.share() - 1.0).abs() < 1e-9, "all of it lies in a plane");
        assert_eq!(map.distances(), [4.0]);
        let folder = tempfile::tempdir().unwrap();
        let svg = folder.path().join("map.svg");
        map.draw(&svg).unwrap();
        let drawn = std::fs::read_to_string(svg).unwrap();
        assert!(drawn.contains("made up") && drawn.matches("<circle").count() >= 3);
        let flat = Map::new("made up", vec!["a".into()], vec![vec![vec![1.0]]], Vec::new());
        assert_eq!(flat.points(), [[[0.0, 0.0]]]);
    }
}
