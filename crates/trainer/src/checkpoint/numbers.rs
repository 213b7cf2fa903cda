//! Numbers of tensors as bytes.

use half::f16;
use safetensors::tensor::{Dtype, TensorView};

/// Little-endian bytes of single-precision numbers.
#[must_use]
pub fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Little-endian bytes of the nearest half-precision numbers.
#[must_use]
pub fn half_bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| f16::from_f32(*v).to_le_bytes()).collect()
}

/// The numbers of a tensor, if they are `count` finite ones of single or half precision.
#[must_use]
pub fn floats(view: &TensorView<'_>, count: usize) -> Option<Vec<f32>> {
    let data = view.data();
    let values: Vec<f32> = match view.dtype() {
        Dtype::F32 if data.len() == 4 * count => {
            // `chunks_exact` gives chunks of that length.
            data.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
        }
        Dtype::F16 if data.len() == 2 * count => {
            data.chunks_exact(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32()).collect()
        }
        _ => return None,
    };
    values.iter().all(|v| v.is_finite()).then_some(values)
}
