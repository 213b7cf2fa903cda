//! One gradient step (forward, backward, Adam, single precision) in the trainer and in two training libraries.
//!
//! Every library gets the same parameters and the same batch, already in its own tensors, and uses its own automatic
//! differentiation and its own Adam. The trainer splits the batch into lanes, as it does when it trains. How many
//! threads there are is for all of them `RAYON_NUM_THREADS`. Nothing is measured before loss, gradient and what three
//! steps do to the parameters were compared with the trainer's.

mod burn_autodiff;
mod candle_autograd;
mod job;
mod own;

use anyhow::{Context, Result, ensure};

pub use job::{Job, Loss, jobs};

/// How far losses and gradients may lie apart, as a share of the loss and of the largest number of the gradient.
pub const TOLERANCE: f32 = 1e-4;
/// How far the parameters may lie apart after three steps, as a share of the way they went, on average. Adam divides
/// by the gradient's own size, so rounding shows where that is nearly zero.
pub const STEP_TOLERANCE: f64 = 0.01;

/// A network in training.
pub trait Learner {
    /// The loss of the batch and its gradient by the parameters, in the trainer's order, without a step.
    ///
    /// # Errors
    /// When the library refuses.
    fn loss_and_gradient(&mut self) -> Result<(f32, Vec<f32>)>;

    /// Takes one gradient step.
    ///
    /// # Errors
    /// When the library refuses.
    fn step(&mut self) -> Result<()>;

    /// The parameters, in the trainer's order.
    ///
    /// # Errors
    /// When the library refuses.
    fn parameters(&self) -> Result<Vec<f32>>;
}

/// All learners of a job by name, the trainer's own first.
///
/// # Errors
/// When a library does not take the network.
pub fn learners(job: &Job) -> Result<Vec<(&'static str, Box<dyn Learner>)>> {
    Ok(vec![
        ("trainer", Box::new(own::Own::new(job))),
        ("candle", Box::new(candle_autograd::Candle::new(job).context("candle")?)),
        ("burn", Box::new(burn_autodiff::Burn::new(job))),
    ])
}

/// Compares a learner's loss, gradient and three steps with those of `expected`; both learners take the steps.
///
/// # Errors
/// When they lie further apart than the tolerances say, or a learner fails.
pub fn check(found: &mut dyn Learner, expected: &mut dyn Learner) -> Result<()> {
    let (loss, gradient) = found.loss_and_gradient()?;
    let (expected_loss, expected_gradient) = expected.loss_and_gradient()?;
    ensure!(
        (loss - expected_loss).abs() <= TOLERANCE * expected_loss.abs(),
        "loss: expected {expected_loss}, found {loss}"
    );
    ensure!(gradient.len() == expected_gradient.len(), "gradient: found {} numbers", gradient.len());
    let largest = expected_gradient.iter().fold(0.0f32, |most, g| most.max(g.abs()));
    ensure!(largest > 0.0, "gradient: expected some, found none");
    for (index, (g, e)) in gradient.iter().zip(&expected_gradient).enumerate() {
        ensure!((g - e).abs() <= TOLERANCE * largest, "gradient {index}: expected {e}, found {g}");
    }
    let start = expected.parameters()?;
    for _ in 0..3 {
        found.step()?;
        expected.step()?;
    }
    let (end, expected_end) = (found.parameters()?, expected.parameters()?);
    let (apart, way) = (distance(&end, &expected_end), distance(&start, &expected_end));
    ensure!(way > 0.0 && apart <= STEP_TOLERANCE * way, "parameters: {apart} apart after a way of {way}");
    Ok(())
}

/// Sum of the absolute differences.
fn distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum()
}
