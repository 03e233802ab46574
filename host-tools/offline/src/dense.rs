//! Dense matrices: products on one thread, columns, orthogonal complement.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

/// Orthonormal basis of the part of unit vectors that is orthogonal to the columns of `known`, which are orthonormal.
/// Vectors that lie mostly in the span of `known` are left out.
pub(crate) fn orthogonal_complement(known: &Mat<f64>, vectors: &Mat<f64>) -> Mat<f64> {
    let left = vectors - product(known, &product(&known.transpose().to_owned(), vectors));
    let new: Vec<usize> = (0..left.ncols()).filter(|k| left.col(*k).norm_l2() > 0.5).collect();
    let new = Mat::from_fn(left.nrows(), new.len(), |r, k| left[(r, new[k])]);
    new.qr().compute_thin_Q()
}

/// The leading columns, as many as there are.
pub(crate) fn leading(matrix: &Mat<f64>, columns: usize) -> Mat<f64> {
    matrix.subcols(0, columns.min(matrix.ncols())).to_owned()
}

pub(crate) fn hstack(matrices: &[&Mat<f64>]) -> Mat<f64> {
    let columns = matrices.iter().map(|m| m.ncols()).sum();
    let mut stacked = Mat::zeros(matrices.first().map_or(0, |m| m.nrows()), columns);
    let mut at = 0;
    for matrix in matrices {
        stacked.as_mut().subcols_mut(at, matrix.ncols()).copy_from(matrix);
        at += matrix.ncols();
    }
    stacked
}

/// The product of two matrices on this thread alone, so that the result does not depend on the number of threads.
pub(crate) fn product(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    let mut result = Mat::zeros(a.nrows(), b.ncols());
    matmul(&mut result, Accum::Replace, a, b, 1.0, Par::Seq);
    result
}
