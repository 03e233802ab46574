//! Singular values, and what they say about truncation (paper, section 4.4, Figs. 8 and 9).

use faer::Mat;
use serde::Serialize;

use crate::OfflineError;
use crate::samples::{Sample, State};
use crate::svd::left_singular;

/// The singular values of one of the paper's matrices.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spectrum {
    /// `S_u`, `S_v` (parameters, eq. 15) or `T_u`, `T_v` (space, eq. 17); S and T of a cluster hold both fields.
    pub matrix: &'static str,
    /// The confinements of the cluster, with shapes in the centroid's frame; `None` for
    /// the whole database in the laboratory frame, as in the paper.
    pub cluster: Option<[f64; 2]>,
    /// Descending.
    pub singular_values: Vec<f64>,
}

/// 1 - RIC(K) for K = 1, 2, ...: the part of the energy beyond the first K singular values (paper, eq. 50, which prints
/// this quantity as RIC).
#[must_use]
pub fn one_minus_ric(singular_values: &[f64]) -> Vec<f64> {
    let mut tails = vec![0.0; singular_values.len()];
    let mut sum = 0.0;
    // From the smallest up, so that small tails are not lost in rounding.
    for (tail, value) in tails.iter_mut().zip(singular_values).rev() {
        *tail = sum;
        sum += value * value;
    }
    if sum > 0.0 {
        tails.iter_mut().for_each(|t| *t /= sum);
    }
    tails
}

/// The spectra of the whole database in the laboratory frame: displacements since t = 0, and velocities.
///
/// # Errors
/// [`OfflineError::NoConvergence`].
pub(crate) fn laboratory(samples: &[Sample], scales: &[f64], nodes: usize) -> Result<Vec<Spectrum>, OfflineError> {
    let displacements: Vec<_> = samples
        .iter()
        .map(|s| in_laboratory(&s.displacement, scales, nodes, true))
        .collect();
    let velocities: Vec<_> = samples
        .iter()
        .map(|s| in_laboratory(&s.velocity, scales, nodes, false))
        .collect();
    let mut spectra = Vec::new();
    for (fields, parameter, space) in [(displacements, "S_u", "T_u"), (velocities, "S_v", "T_v")] {
        let (rows, instants) = fields.first().map_or((0, 0), Mat::shape);
        let stacked = Mat::from_fn(fields.len(), rows * instants, |j, k| fields[j][(k % rows, k / rows)]);
        let joined = Mat::from_fn(rows, instants * fields.len(), |i, k| {
            fields[k / instants][(i, k % instants)]
        });
        for (matrix, values) in [(parameter, stacked), (space, joined)] {
            let (_, singular_values) = left_singular(values.as_ref())?;
            spectra.push(Spectrum {
                matrix,
                cluster: None,
                singular_values,
            });
        }
    }
    Ok(spectra)
}

/// Shape and translation put together again, weighted like the shape; with `since_start`, less the first instant.
fn in_laboratory(state: &State, scales: &[f64], nodes: usize, since_start: bool) -> Mat<f64> {
    let root = (nodes as f64).sqrt();
    let at = |row: usize, i: usize| {
        let translation = if row.is_multiple_of(3) {
            scales[row / 3] * state.translation[i] / root
        } else {
            0.0
        };
        state.shape[(row, i)] + translation
    };
    let start = |row| if since_start { at(row, 0) } else { 0.0 };
    Mat::from_fn(state.shape.nrows(), state.shape.ncols(), |row, i| {
        at(row, i) - start(row)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_of_known_values() {
        let tails = one_minus_ric(&[3.0, 2.0, 1.0]);
        assert_eq!(tails, [5.0 / 14.0, 1.0 / 14.0, 0.0]);
        assert_eq!(one_minus_ric(&[0.0, 0.0]), [0.0, 0.0]);
        // 1 + 1e-20 is 1, but the tail is still there.
        assert!((one_minus_ric(&[1.0, 1e-10])[0] - 1e-20).abs() < 1e-30);
    }
}
