//! Discriminators of style: one for each node of the graph, each with its clips. A character between two nodes is scored by both,
//! by its blend weights. A discriminator learns from the characters that are nearly at its node.

use crate::amp::{DiscriminatorConfig, DiscriminatorLearner, DiscriminatorReport, style_reward};
use crate::env::{Demonstrations, TrainingGraph};

/// A discriminator learns from rows in which its node weighs more than this.
const LEARNING_WEIGHT: f32 = 0.6;

/// A node's clips and the discriminator that knows them; a node that nothing acts as needs none.
#[derive(Debug)]
pub struct NodeDiscriminator {
    /// The clips.
    pub demonstrations: Demonstrations,
    /// The discriminator.
    pub discriminator: Option<DiscriminatorLearner>,
}

/// Discriminators in the order of a graph's nodes, and then of the edges that have one half-way.
#[derive(Debug)]
pub struct Discriminators {
    /// One for each node, one for each of the edges in `halfway`.
    pub scorers: Vec<NodeDiscriminator>,
    halfway: Vec<usize>,
    rows: Vec<u32>,
    gathered: Vec<f32>,
    logits: Vec<f32>,
    style: Vec<f32>,
}

/// Edge and blend weight of every row.
type Positions<'a> = (&'a [usize], &'a [f32]);

impl Discriminators {
    /// These discriminators; the last ones score half-way along these edges.
    ///
    /// # Panics
    /// When there are fewer discriminators than such edges.
    #[must_use]
    pub fn new(scorers: Vec<NodeDiscriminator>, halfway: Vec<usize>) -> Self {
        assert!(halfway.len() <= scorers.len(), "scorers of edges");
        let (rows, gathered, logits, style) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { scorers, halfway, rows, gathered, logits, style }
    }

    /// Clips of all nodes.
    #[must_use]
    pub fn demonstrations(&self) -> Vec<&Demonstrations> {
        let nodes = self.scorers.len() - self.halfway.len();
        self.scorers[..nodes].iter().map(|j| &j.demonstrations).collect()
    }

    /// Sets the hyper-parameters of all discriminators. Sizes of networks and buffers stay as they are.
    pub fn set_config(&mut self, config: &DiscriminatorConfig) {
        for discriminator in self.scorers.iter_mut().filter_map(|s| s.discriminator.as_mut()) {
            discriminator.config.clone_from(config);
        }
    }

    /// Edges with a discriminator half-way, in the order of their discriminators.
    #[must_use]
    pub fn halfway(&self) -> &[usize] {
        &self.halfway
    }

    /// Style reward of every row of discriminator inputs.
    ///
    /// # Panics
    /// When there is not one position for each row, or an edge is not on the graph.
    pub fn style(&mut self, graph: &TrainingGraph, positions: Positions<'_>, inputs: &[f32]) -> &[f32] {
        self.style.clear();
        self.style.resize(positions.0.len(), 0.0);
        let nodes = self.scorers.len() - self.halfway.len();
        for (index, scorer) in self.scorers.iter_mut().enumerate() {
            let Some(discriminator) = &mut scorer.discriminator else { continue };
            let weight = |row| weight(graph, &self.halfway, nodes, index, row);
            rows_above(positions, weight, 0.0, &mut self.rows);
            self.gathered.clear();
            let width = discriminator.network.inputs();
            for row in self.rows.iter().map(|r| *r as usize * width) {
                self.gathered.extend_from_slice(&inputs[row..row + width]);
            }
            self.logits.resize(self.rows.len(), 0.0);
            discriminator.logits_into(&self.gathered, &mut self.logits);
            for (row, logit) in self.rows.iter().map(|r| *r as usize).zip(&self.logits) {
                self.style[row] += weight((positions.0[row], positions.1[row])) * style_reward(*logit);
            }
        }
        &self.style
    }

    /// Gradient steps of all discriminators; returns the mean over those that learned.
    pub fn learn(
        &mut self,
        graph: &TrainingGraph,
        positions: Positions<'_>,
        inputs: &[f32],
    ) -> DiscriminatorReport {
        let mut sum = DiscriminatorReport::default();
        let mut count = 0.0;
        let nodes = self.scorers.len() - self.halfway.len();
        for (index, scorer) in self.scorers.iter_mut().enumerate() {
            let Some(discriminator) = &mut scorer.discriminator else { continue };
            let weight = |row| weight(graph, &self.halfway, nodes, index, row);
            rows_above(positions, weight, LEARNING_WEIGHT, &mut self.rows);
            let report = discriminator.update(&scorer.demonstrations, inputs, &self.rows);
            sum.cross_entropy += report.cross_entropy;
            sum.accuracy += report.accuracy;
            sum.squared_gradient += report.squared_gradient;
            count += 1.0;
        }
        for value in [&mut sum.cross_entropy, &mut sum.accuracy, &mut sum.squared_gradient] {
            *value /= f32::max(count, 1.0);
        }
        sum
    }
}

/// Weight of a discriminator in a row, given by its edge and blend weight: that of its node, or how near the row is to the middle
/// of its edge. Where an edge has a discriminator half-way, those of its ends weigh nothing beyond the middle.
fn weight(
    graph: &TrainingGraph,
    halfway: &[usize],
    nodes: usize,
    scorer: usize,
    (edge, t): (usize, f32),
) -> f32 {
    let of_node = || graph.weight(graph.position_of(edge, t), scorer);
    match halfway.get(scorer.wrapping_sub(nodes)) {
        Some(middle) if *middle == edge => 1.0 - (2.0 * t - 1.0).abs(),
        Some(_) => 0.0,
        None if halfway.contains(&edge) => (2.0 * of_node() - 1.0).max(0.0),
        None => of_node(),
    }
}

/// Rows at positions where a discriminator weighs more than `least`.
fn rows_above(
    (edges, blend): Positions<'_>,
    weight: impl Fn((usize, f32)) -> f32,
    least: f32,
    out: &mut Vec<u32>,
) {
    out.clear();
    let heavy = |(edge, t): (&usize, &f32)| weight((*edge, *t)) > least;
    out.extend(
        (0..edges.len() as u32).zip(edges.iter().zip(blend)).filter(|(_, at)| heavy(*at)).map(|(r, _)| r),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::env::{EnvironmentConfig, GraphNode};

    #[test]
    fn the_weights_of_all_discriminators_sum_to_one() {
        let node = |name: &str| GraphNode::new(name, &EnvironmentConfig::default(), 1.0);
        let graph =
            TrainingGraph::along(["a", "b", "c"].map(node).to_vec(), &[vec![0, 1, 2]], [1.0; 2]).unwrap();
        let halfway = [0];
        for edge in 0..2 {
            for t in [0.0, 0.2, 0.5, 0.7, 1.0] {
                let all: Vec<f32> =
                    (0..4).map(|scorer| weight(&graph, &halfway, 3, scorer, (edge, t))).collect();
                assert!((all.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{edge} {t} {all:?}");
                assert_eq!(all[3] > 0.0, edge == 0 && t > 0.0 && t < 1.0);
                assert!(edge == 1 || t != 0.5 || all[3] == 1.0);
            }
        }
    }
}
