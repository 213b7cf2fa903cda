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

/// Judges in the order of a course's nodes.
#[derive(Debug)]
pub struct Judges {
    /// One for each node.
    pub judges: Vec<Judge>,
    rows: Vec<u32>,
    gathered: Vec<f32>,
    logits: Vec<f32>,
    style: Vec<f32>,
}

/// Edge and blend weight of every row.
type Places<'a> = (&'a [usize], &'a [f32]);

impl Judges {
    /// These judges.
    #[must_use]
    pub fn new(judges: Vec<Judge>) -> Self {
        Self { judges, rows: Vec::new(), gathered: Vec::new(), logits: Vec::new(), style: Vec::new() }
    }

    /// Clips of all nodes.
    #[must_use]
    pub fn demonstrations(&self) -> Vec<&Demonstrations> {
        self.judges.iter().map(|j| &j.demonstrations).collect()
    }

    /// Style reward of every row of discriminator inputs.
    ///
    /// # Panics
    /// When there is not one place for each row, or an edge is not on the course.
    pub fn style(&mut self, course: &Course, places: Places<'_>, inputs: &[f32]) -> &[f32] {
        self.style.clear();
        self.style.resize(places.0.len(), 0.0);
        for (node, judge) in self.judges.iter_mut().enumerate() {
            let Some(discriminator) = &mut judge.discriminator else { continue };
            rows_above(course, places, node, 0.0, &mut self.rows);
            self.gathered.clear();
            for row in self.rows.iter().map(|r| *r as usize * DISCRIMINATOR_INPUT_LEN) {
                self.gathered.extend_from_slice(&inputs[row..row + DISCRIMINATOR_INPUT_LEN]);
            }
            self.logits.resize(self.rows.len(), 0.0);
            discriminator.logits_into(&self.gathered, &mut self.logits);
            for (row, logit) in self.rows.iter().map(|r| *r as usize).zip(&self.logits) {
                let place = Place { edge: places.0[row], t: places.1[row] };
                self.style[row] += course.weight(place, node) * style_reward(*logit);
            }
        }
        &self.style
    }

    /// Gradient steps of all judges; returns the mean over those that learned.
    pub fn learn(&mut self, course: &Course, places: Places<'_>, inputs: &[f32]) -> DiscriminatorReport {
        let mut sum = DiscriminatorReport::default();
        let mut count = 0.0;
        for (node, judge) in self.judges.iter_mut().enumerate() {
            let Some(discriminator) = &mut judge.discriminator else { continue };
            rows_above(course, places, node, LEARNING_WEIGHT, &mut self.rows);
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

/// Rows in which `node` weighs more than `least`.
fn rows_above(course: &Course, (edges, blend): Places<'_>, node: usize, least: f32, out: &mut Vec<u32>) {
    out.clear();
    let heavy = |(edge, t): (&usize, &f32)| course.weight(Place { edge: *edge, t: *t }, node) > least;
    out.extend(
        (0..edges.len() as u32).zip(edges.iter().zip(blend)).filter(|(_, at)| heavy(*at)).map(|(r, _)| r),
    );
}
