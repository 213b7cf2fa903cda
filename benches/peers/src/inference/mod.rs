//! One policy under policy-core and under four inference libraries, to be measured in one run.
//!
//! Every library gets the same parameters and the same input, one observation at a time on one thread, as a game
//! would ask for it; each keeps its model and buffers between calls as far as its interface allows. Nothing is
//! measured before its answer was compared with policy-core's.

mod burn_flex;
mod candle;
mod network;
mod onnx;
mod onnx_runtime;
mod tract;

use anyhow::{Context, Result, ensure};

pub use network::{ACTION_LEN, Layer, Network, OBSERVATION_LEN};

/// How far a library's answer may lie from policy-core's, absolutely; the actions are of order one.
pub const TOLERANCE: f32 = 1e-4;

/// A library that evaluates the policy.
pub trait Peer {
    /// Evaluates one observation ([`OBSERVATION_LEN`] numbers) into one action ([`ACTION_LEN`] numbers).
    ///
    /// # Errors
    /// When the library refuses.
    fn evaluate_into(&mut self, observation: &[f32], action: &mut [f32]) -> Result<()>;
}

/// All peers by name, ready to evaluate `network`.
///
/// # Errors
/// When a library cannot be loaded or does not take the network.
pub fn peers(network: &Network) -> Result<Vec<(&'static str, Box<dyn Peer>)>> {
    Ok(vec![
        ("onnxruntime", Box::new(onnx_runtime::OnnxRuntime::new(network).context("onnxruntime")?)),
        ("candle", Box::new(candle::Candle::new(network).context("candle")?)),
        ("burn", Box::new(burn_flex::BurnFlex::new(network))),
        ("tract", Box::new(tract::Tract::new(network).context("tract")?)),
    ])
}

/// Compares a peer's answer with the expected one.
///
/// # Errors
/// When they differ by more than [`TOLERANCE`], or the peer fails.
pub fn check(name: &str, peer: &mut dyn Peer, observation: &[f32], expected: &[f32]) -> Result<()> {
    let mut action = [0.0; ACTION_LEN];
    peer.evaluate_into(observation, &mut action).with_context(|| name.to_owned())?;
    for (index, (found, expected)) in action.iter().zip(expected).enumerate() {
        ensure!(
            (found - expected).abs() <= TOLERANCE,
            "{name}: action {index}: expected {expected}, found {found}"
        );
    }
    Ok(())
}
