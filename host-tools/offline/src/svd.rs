//! Left singular vectors of wide matrices.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::svd::{ComputeSvdVectors, svd, svd_scratch};
use faer::{Mat, MatRef, Par};

use crate::OfflineError;

/// The left singular vectors and the singular values, descending, of a matrix with many more columns than rows.
///
/// The transpose is reduced by Householder QR and the small triangular factor decomposed, so that singular values far
/// below the square root of the rounding unit, relative to the first, are still right; those of the Gram matrix would
/// not be. The largest entry of each vector is made positive, and nothing depends on the number of threads, so equal
/// input gives equal bytes.
///
/// # Errors
/// [`OfflineError::NoConvergence`].
pub(crate) fn left_singular(matrix: MatRef<f64>) -> Result<(Mat<f64>, Vec<f64>), OfflineError> {
    let (rows, columns) = matrix.shape();
    let size = rows.min(columns);
    let mut vectors = Mat::zeros(rows, size);
    let mut values = Diag::zeros(size);
    let (thin, none) = (ComputeSvdVectors::Thin, ComputeSvdVectors::No);
    let scratch = svd_scratch::<f64>(rows, columns, thin, none, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    svd(
        matrix,
        values.as_mut(),
        Some(vectors.as_mut()),
        None,
        Par::Seq,
        stack,
        Default::default(),
    )
    .map_err(|_| OfflineError::NoConvergence { rows, columns })?;
    for k in 0..size {
        let largest = vectors
            .col(k)
            .iter()
            .fold(0.0, |a: f64, b| if b.abs() > a.abs() { *b } else { a });
        if largest < 0.0 {
            vectors.col_mut(k).iter_mut().for_each(|v| *v = -*v);
        }
    }
    Ok((vectors, values.column_vector().iter().copied().collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn graded_singular_values_are_found_to_the_last() {
        // U diag(10^-k) V^T with orthonormal discrete cosines.
        let (rows, columns) = (8, 200);
        let cosine = |n: usize| {
            Mat::from_fn(n, 8, |i, k| {
                let norm = if k == 0 { 1.0 } else { 2.0f64 };
                (norm / n as f64).sqrt() * (std::f64::consts::PI * k as f64 * (i as f64 + 0.5) / n as f64).cos()
            })
        };
        let (u, v) = (cosine(rows), cosine(columns));
        let matrix = Mat::from_fn(rows, columns, |i, j| {
            (0..8)
                .map(|k| u[(i, k)] * 10f64.powi(-2 * k as i32) * v[(j, k)])
                .sum::<f64>()
        });
        let (vectors, values) = left_singular(matrix.as_ref()).unwrap();
        for k in 0..7 {
            let exact = 10f64.powi(-2 * k as i32);
            assert!((values[k] / exact - 1.0).abs() < 1e-3, "{k}: {:e}", values[k]);
            let overlap: f64 = (0..rows).map(|i| vectors[(i, k)] * u[(i, k)]).sum();
            assert!((overlap.abs() - 1.0).abs() < 1e-6, "{k}: {overlap}");
        }
    }

    #[test]
    fn equal_input_gives_equal_bits() {
        let matrix = Mat::from_fn(20, 300, |i, j| ((i * j) as f64 * 0.37).sin());
        let (a, b) = (
            left_singular(matrix.as_ref()).unwrap(),
            left_singular(matrix.as_ref()).unwrap(),
        );
        assert_eq!(a, b);
    }
}
