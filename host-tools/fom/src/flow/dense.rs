//! A dense matrix and its product with a vector, whose time is that of reading the matrix from memory.

use faer::Mat;
use multiversion::multiversion;
use multiversion::target::match_target;
use rayon::prelude::*;

use super::precision::Precision;
use super::real::{Real, fused, total};
use super::stokeslet::LANES;

/// A matrix, row by row; each row is filled up with zeros to a multiple of [`LANES`].
#[derive(Debug, Clone)]
pub enum Dense {
    /// Stored in single precision: half the memory.
    Single(Rows<f32>),
    /// Stored in double precision.
    Double(Rows<f64>),
}

/// The entries of a matrix.
#[derive(Debug, Clone, Default)]
pub struct Rows<S> {
    rows: usize,
    stride: usize,
    entries: Vec<S>,
}

impl Default for Dense {
    fn default() -> Self {
        Self::Double(Rows::default())
    }
}

/// Rows handled together, so that the vector is loaded once for all of them.
const TOGETHER: usize = 4;
/// Rows of one task.
const TASK: usize = 96;

impl Dense {
    /// A copy of a matrix.
    pub fn new(matrix: &Mat<f64>, precision: Precision) -> Self {
        match precision {
            Precision::Mixed => Self::Single(Rows::new(matrix)),
            Precision::Double => Self::Double(Rows::new(matrix)),
        }
    }

    /// Its product with a vector; all sums are in double precision.
    pub fn multiply(&self, vector: &[f64]) -> Vec<f64> {
        match self {
            Self::Single(rows) => rows.multiply(vector, single),
            Self::Double(rows) => rows.multiply(vector, double),
        }
    }
}

impl<S: Real> Rows<S> {
    fn new(matrix: &Mat<f64>) -> Self {
        let stride = matrix.ncols().next_multiple_of(LANES);
        let mut entries = vec![S::default(); matrix.nrows() * stride];
        for (i, row) in entries.chunks_mut(stride.max(1)).enumerate() {
            for (j, entry) in row[..matrix.ncols()].iter_mut().enumerate() {
                *entry = S::from_f64(matrix[(i, j)]);
            }
        }
        Self {
            rows: matrix.nrows(),
            stride,
            entries,
        }
    }

    fn multiply(&self, vector: &[f64], kernel: impl Fn(&[S], &[f64], &mut [f64]) + Sync) -> Vec<f64> {
        let mut padded = vector.to_vec();
        padded.resize(self.stride, 0.0);
        let mut product = vec![0.0; self.rows];
        product
            .par_chunks_mut(TASK)
            .zip(self.entries.par_chunks((TASK * self.stride).max(1)))
            .for_each(|(product, rows)| kernel(rows, &padded, product));
        product
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn double(rows: &[f64], vector: &[f64], product: &mut [f64]) {
    match_target! {
        "x86_64+fma" => products::<f64, true>(rows, vector, product),
        _ => products::<f64, false>(rows, vector, product),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn single(rows: &[f32], vector: &[f64], product: &mut [f64]) {
    match_target! {
        "x86_64+fma" => products::<f32, true>(rows, vector, product),
        _ => products::<f32, false>(rows, vector, product),
    }
}

#[inline(always)]
fn products<S: Real, const FMA: bool>(rows: &[S], vector: &[f64], product: &mut [f64]) {
    let stride = vector.len();
    let (blocks, rest) = product.as_chunks_mut::<TOGETHER>();
    let remaining = &rows[blocks.len() * TOGETHER * stride..];
    for (product, rows) in blocks.iter_mut().zip(rows.chunks(TOGETHER * stride)) {
        let (first, second) = rows.split_at(2 * stride);
        let ((a, b), (c, d)) = (first.split_at(stride), second.split_at(stride));
        *product = dots::<S, FMA, TOGETHER>([a, b, c, d], vector);
    }
    for (product, row) in rest.iter_mut().zip(remaining.chunks(stride)) {
        [*product] = dots::<S, FMA, 1>([row], vector);
    }
}

#[inline(always)]
fn dots<S: Real, const FMA: bool, const T: usize>(rows: [&[S]; T], vector: &[f64]) -> [f64; T] {
    let rows = rows.map(|row| row.as_chunks::<LANES>().0);
    let vector = vector.as_chunks::<LANES>().0;
    let rows = rows.map(|row| &row[..vector.len()]);
    let mut sums = [[0.0; LANES]; T];
    for (j, x) in vector.iter().enumerate() {
        for t in 0..T {
            for l in 0..LANES {
                sums[t][l] = fused::<f64, FMA>(rows[t][j][l].into(), x[l], sums[t][l]);
            }
        }
    }
    sums.map(|lanes| total(&lanes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_agree_with_the_matrix_for_every_size() {
        for (rows, columns) in [(1, 1), (3, 8), (6, 9), (101, 37)] {
            let matrix = Mat::from_fn(rows, columns, |i, j| ((i * 31 + j * 17) as f64).sin());
            let vector: Vec<f64> = (0..columns).map(|j| (j as f64).cos()).collect();
            let expected = &matrix * Mat::from_fn(columns, 1, |j, _| vector[j]);
            for (precision, tolerance) in [(Precision::Double, 1e-13), (Precision::Mixed, 1e-6)] {
                let product = Dense::new(&matrix, precision).multiply(&vector);
                assert_eq!(product.len(), rows);
                assert!((0..rows).all(|i| (product[i] - expected[(i, 0)]).abs() < tolerance));
            }
        }
    }
}
