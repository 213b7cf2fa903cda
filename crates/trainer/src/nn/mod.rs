//! Small dense networks with hand-written gradients, over the `gemm` crate.
//!
//! Owns products, forward and backward passes, Adam and the discriminator's loss with its gradient penalty.
//! Everything is single precision and writes to buffers made once.

mod adam;
mod discriminator_loss;
mod matrix;
mod network;
mod pass;

pub use adam::{Adam, clip_norm};
pub use discriminator_loss::{DiscriminatorLoss, DiscriminatorPass, sigmoid, softplus};
pub use matrix::{Shape, Write, multiply, multiply_left_transposed, multiply_right_transposed};
pub use network::{LayerRange, Network};
pub use pass::{Line, Pass};
