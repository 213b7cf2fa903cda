//! Matrix products of row-major slices, single precision. The products themselves are the `gemm` crate's; this
//! file owns only the layout and the length checks. One product uses one thread: callers split rows.

use gemm::Parallelism;

/// Shape of a product: `rows x inner` times `inner x columns`.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Rows of the result.
    pub rows: usize,
    /// Length of the sums.
    pub inner: usize,
    /// Columns of the result.
    pub columns: usize,
}

/// What a product does with the values already in its destination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Write {
    /// They are lost.
    Replace,
    /// The product is added to them.
    Add,
}

/// `out = a b`, with `a` `[rows][inner]` and `b` `[inner][columns]`.
///
/// # Panics
/// When a slice has another length than its shape says.
pub fn multiply(out: &mut [f32], write: Write, a: &[f32], b: &[f32], shape: Shape) {
    let Shape { rows, inner, columns } = shape;
    product(out, write, (a, 1, inner), (b, 1, columns), Shape { rows, inner, columns });
}

/// `out = a b^T`, with `a` `[rows][inner]` and `b` `[columns][inner]`.
///
/// # Panics
/// When a slice has another length than its shape says.
pub fn multiply_right_transposed(out: &mut [f32], write: Write, a: &[f32], b: &[f32], shape: Shape) {
    product(out, write, (a, 1, shape.inner), (b, shape.inner, 1), shape);
}

/// `out = a^T b`, with `a` `[inner][rows]` and `b` `[inner][columns]`.
///
/// # Panics
/// When a slice has another length than its shape says.
pub fn multiply_left_transposed(out: &mut [f32], write: Write, a: &[f32], b: &[f32], shape: Shape) {
    product(out, write, (a, shape.rows, 1), (b, 1, shape.columns), shape);
}

/// An operand: values, column stride, row stride.
type Operand<'a> = (&'a [f32], usize, usize);

fn product(out: &mut [f32], write: Write, lhs: Operand<'_>, rhs: Operand<'_>, shape: Shape) {
    let Shape { rows, inner, columns } = shape;
    assert_eq!(out.len(), rows * columns, "result of a product");
    assert_eq!(lhs.0.len(), rows * inner, "left operand of a product");
    assert_eq!(rhs.0.len(), inner * columns, "right operand of a product");
    let stride = |s: usize| isize::try_from(s).expect("a slice is shorter than isize::MAX");
    // SAFETY: the three lengths were checked above and every stride pair is a permutation of (1, row length) of
    // its matrix, so each element addressed lies in its slice; `out` is borrowed mutably and overlaps neither.
    unsafe {
        gemm::gemm(
            rows,
            columns,
            inner,
            out.as_mut_ptr(),
            1,
            stride(columns),
            write == Write::Add,
            lhs.0.as_ptr(),
            stride(lhs.1),
            stride(lhs.2),
            rhs.0.as_ptr(),
            stride(rhs.1),
            stride(rhs.2),
            1.0,
            1.0,
            false,
            false,
            false,
            Parallelism::None,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_layouts_agree_with_the_definition() {
        let shape = Shape { rows: 5, inner: 7, columns: 3 };
        let a: Vec<f32> = (0..35).map(|i| (i as f32 * 0.37).sin()).collect();
        let b: Vec<f32> = (0..21).map(|i| (i as f32 * 0.91).cos()).collect();
        let expected: Vec<f32> =
            (0..15).map(|i| (0..7).map(|k| a[i / 3 * 7 + k] * b[k * 3 + i % 3]).sum::<f32>()).collect();
        let a_t: Vec<f32> = (0..35).map(|i| a[i % 5 * 7 + i / 5]).collect();
        let b_t: Vec<f32> = (0..21).map(|i| b[i % 7 * 3 + i / 7]).collect();
        let close = |out: &[f32], factor: f32| {
            assert!(out.iter().zip(&expected).all(|(o, e)| (o - factor * e).abs() < 1e-5), "{out:?}");
        };
        let mut out = vec![9.0; 15];
        multiply(&mut out, Write::Replace, &a, &b, shape);
        close(&out, 1.0);
        multiply_right_transposed(&mut out, Write::Add, &a, &b_t, shape);
        close(&out, 2.0);
        multiply_left_transposed(&mut out, Write::Add, &a_t, &b, shape);
        close(&out, 3.0);
    }
}
