//! Judges of style: one discriminator for each node of a course, each with its clips. A character between two nodes is
//! judged by both, by its blend weights; a judge learns from those that are nearly at its node.

use policy_core::DISCRIMINATOR_INPUT_LEN;

use crate::amp::{DiscriminatorLearner, DiscriminatorReport, style_reward};
use crate::env::{Course, Demonstrations, Place};

/// A judge learns from rows in which its node weighs more than this.
const LEARNING_WEIGHT: f32 = 0.6;

/// A node's clips and the discriminator that knows them; a node that nothing acts as needs none.
#[derive(Debug)]
pub struct Judge {
    /// The clips.
    pub demonstrations: Demonstrations,
    /// The discriminator.
    pub discriminator: Option<DiscriminatorLearner>,
}

/// Judges in the order of a course's nodes, and then of the edges that have one half-way.
#[derive(Debug)]
pub struct Judges {
    /// One for each node, one for each of the edges in `halfway`.
    pub judges: Vec<Judge>,
    halfway: Vec<usize>,
    rows: Vec<u32>,
    gathered: Vec<f32>,
    logits: Vec<f32>,
    style: Vec<f32>,
}

/// Edge and blend weight of every row.
type Places<'a> = (&'a [usize], &'a [f32]);

impl Judges {
    /// These judges; the last ones judge half-way along these edges.
    ///
    /// # Panics
    /// When there are fewer judges than such edges.
    #[must_use]
    pub fn new(judges: Vec<Judge>, halfway: Vec<usize>) -> Self {
        assert!(halfway.len() <= judges.len(), "judges of edges");
        let (rows, gathered, logits, style) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { judges, halfway, rows, gathered, logits, style }
    }

    /// Clips of all nodes.
    #[must_use]
    pub fn demonstrations(&self) -> Vec<&Demonstrations> {
        let nodes = self.judges.len() - self.halfway.len();
        self.judges[..nodes].iter().map(|j| &j.demonstrations).collect()
    }

    /// Edges with a judge half-way, in the order of their judges.
    #[must_use]
    pub fn halfway(&self) -> &[usize] {
        &self.halfway
    }

    /// Style reward of every row of discriminator inputs.
    ///
    /// # Panics
    /// When there is not one place for each row, or an edge is not on the course.
    pub fn style(&mut self, course: &Course, places: Places<'_>, inputs: &[f32]) -> &[f32] {
        self.style.clear();
        self.style.resize(places.0.len(), 0.0);
        let nodes = self.judges.len() - self.halfway.len();
        for (index, judge) in self.judges.iter_mut().enumerate() {
            let Some(discriminator) = &mut judge.discriminator else { continue };
            let weight = |place: Place| weight(course, &self.halfway, nodes, index, place);
            rows_above(places, weight, 0.0, &mut self.rows);
            self.gathered.clear();
            for row in self.rows.iter().map(|r| *r as usize * DISCRIMINATOR_INPUT_LEN) {
                self.gathered.extend_from_slice(&inputs[row..row + DISCRIMINATOR_INPUT_LEN]);
            }
            self.logits.resize(self.rows.len(), 0.0);
            discriminator.logits_into(&self.gathered, &mut self.logits);
            for (row, logit) in self.rows.iter().map(|r| *r as usize).zip(&self.logits) {
                let place = Place { edge: places.0[row], t: places.1[row] };
                self.style[row] += weight(place) * style_reward(*logit);
            }
        }
        &self.style
    }

    /// Gradient steps of all judges; returns the mean over those that learned.
    pub fn learn(&mut self, course: &Course, places: Places<'_>, inputs: &[f32]) -> DiscriminatorReport {
        let mut sum = DiscriminatorReport::default();
        let mut count = 0.0;
        let nodes = self.judges.len() - self.halfway.len();
        for (index, judge) in self.judges.iter_mut().enumerate() {
            let Some(discriminator) = &mut judge.discriminator else { continue };
            let weight = |place: Place| weight(course, &self.halfway, nodes, index, place);
            rows_above(places, weight, LEARNING_WEIGHT, &mut self.rows);
            let report = discriminator.update(&judge.demonstrations, inputs, &self.rows);
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

/// Weight of a judge at a place: that of its node, or how near the place is to the middle of its edge. Where an edge has a
/// judge half-way, those of its ends weigh nothing beyond the middle.
fn weight(course: &Course, halfway: &[usize], nodes: usize, judge: usize, place: Place) -> f32 {
    match halfway.get(judge.wrapping_sub(nodes)) {
        Some(edge) if *edge == place.edge => 1.0 - (2.0 * place.t - 1.0).abs(),
        Some(_) => 0.0,
        None if halfway.contains(&place.edge) => (2.0 * course.weight(place, judge) - 1.0).max(0.0),
        None => course.weight(place, judge),
    }
}

/// Rows at places where a judge weighs more than `least`.
fn rows_above((edges, blend): Places<'_>, weight: impl Fn(Place) -> f32, least: f32, out: &mut Vec<u32>) {
    out.clear();
    let heavy = |(edge, t): (&usize, &f32)| weight(Place { edge: *edge, t: *t }) > least;
    out.extend(
        (0..edges.len() as u32).zip(edges.iter().zip(blend)).filter(|(_, at)| heavy(*at)).map(|(r, _)| r),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::env::{CourseNode, EnvironmentConfig};

    #[test]
    fn the_weights_of_all_judges_sum_to_one() {
        let node = |name: &str| CourseNode::new(name, &EnvironmentConfig::default(), 1.0);
        let course = Course::new(["a", "b", "c"].map(node).to_vec(), vec![vec![0, 1, 2]]);
        let halfway = [0];
        for edge in 0..2 {
            for t in [0.0, 0.2, 0.5, 0.7, 1.0] {
                let at = Place { edge, t };
                let all: Vec<f32> = (0..4).map(|judge| weight(&course, &halfway, 3, judge, at)).collect();
                assert!((all.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{edge} {t} {all:?}");
                assert_eq!(all[3] > 0.0, edge == 0 && t > 0.0 && t < 1.0);
                assert!(edge == 1 || t != 0.5 || all[3] == 1.0);
            }
        }
    }
}
