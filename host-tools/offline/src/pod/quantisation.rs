//! How many columns are stored in two bytes an entry: as many as the rounding of the others requires.

use capsule_core::model::panels::LANES;
use faer::Mat;

use super::ranks::trailing;
use super::{DoublePod, Snapshots, SpanPod};

/// Root-mean-square error that the quantisation of the modes and of the parameter modes may add, each, as a share of
/// the tolerance.
const MODES_SHARE: f64 = 0.2;
/// The same for the core: a wide column costs a query as much as one more column.
const CORE_SHARE: f64 = 0.3;

impl Snapshots {
    /// Mean square error that quantisation may add: a share of the truncation error or of the tolerance.
    fn quantisation_budget(&self, pod: &DoublePod, share: f64) -> f64 {
        (share * pod.space_error.max(self.tolerance())).powi(2)
    }

    /// Number of leading modes that are stored in two bytes an entry; `greatest` is the greatest entry of a mode at the
    /// nodes.
    pub(crate) fn wide_modes(&self, pod: &DoublePod, greatest: impl Fn(usize) -> f64) -> usize {
        let count = pod.modes.ncols();
        let snapshots = (self.shape[0].ncols() * pod.samples()) as f64;
        // Of each of the three components of a node, times the mode's mean square coefficient.
        let rounding = |k: usize| 3.0 * rounding(greatest(k)) * pod.squares[k] / snapshots;
        trailing(count, self.quantisation_budget(pod, MODES_SHARE), rounding)
            .next_multiple_of(LANES)
            .min(count)
    }

    /// Number of leading parameter modes of a span that are.
    pub(crate) fn wide_parameter_modes(&self, pod: &DoublePod, span: &SpanPod) -> usize {
        let psi = &span.parameter_modes;
        let greatest = |l: usize| (0..psi.nrows()).map(|j| psi[(j, l)].abs()).fold(0.0, f64::max);
        // Times the mean square of what the mode is multiplied by at the nodes.
        let controls = (self.nodes * span.slices.len()) as f64;
        let rounding = |l: usize| rounding(greatest(l)) * span.values[l].powi(2) / controls;
        trailing(psi.ncols(), self.quantisation_budget(pod, MODES_SHARE), rounding)
    }

    /// Number of leading columns of its core that are.
    pub(crate) fn wide_core_columns(&self, pod: &DoublePod, span: &SpanPod) -> usize {
        let (samples, columns) = span.parameter_modes.shape();
        let greatest =
            |slice: &Mat<f64>, k: usize, from: usize| (from..columns).map(|l| slice[(k, l)].abs()).fold(0.0, f64::max);
        // Psi is orthonormal over the samples.
        let error = |from: usize| -> f64 {
            let rows = span
                .slices
                .iter()
                .flat_map(|slice| (0..slice.nrows()).map(move |k| (slice, k)));
            let sum: f64 = rows.map(|(slice, k)| rounding(greatest(slice, k, from))).sum();
            columns as f64 * sum / (self.nodes * span.slices.len() * samples) as f64
        };
        let budget = self.quantisation_budget(pod, CORE_SHARE);
        (0..columns).find(|from| error(*from) <= budget).unwrap_or(columns)
    }
}

/// Mean square error of rounding numbers to one byte with the scale of the greatest of them: the variance of a uniform
/// distribution over one scale.
fn rounding(greatest: f64) -> f64 {
    let scale = greatest / f64::from(i8::MAX);
    scale * scale / 12.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Truncation;
    use crate::pod::tests::{snapshots, states};

    /// Rounded to one byte with the scale of the greatest.
    fn rounded(values: &[f64]) -> Vec<f64> {
        let scale = values.iter().fold(0.0, |a: f64, x| a.max(x.abs())) / 127.0;
        values.iter().map(|x| scale * (x / scale).round()).collect()
    }

    #[test]
    fn quantisation_adds_no_more_than_its_share() {
        let states = states();
        let snapshots = snapshots(&states, Truncation::Tolerance(2e-4));
        let pod = snapshots.reduce(&[0, 1, 2, 3, 4]).unwrap();
        let [span] = &pod.spans[..] else {
            panic!("few controls are one span")
        };
        let (samples, columns) = span.parameter_modes.shape();
        let psi = |j: usize| (0..columns).map(move |l| (l, j));
        let mean = |sum: f64| sum / (4 * span.slices.len() * samples) as f64;
        let budget = snapshots.quantisation_budget(&pod, CORE_SHARE);
        let wide = snapshots.wide_core_columns(&pod, span);
        assert!(0 < wide && wide < columns, "{wide} of {columns}");
        let error = |wide: usize| {
            let mut sum = 0.0;
            for (slice, k) in span
                .slices
                .iter()
                .flat_map(|slice| (0..slice.nrows()).map(move |k| (slice, k)))
            {
                let row: Vec<f64> = (0..columns).map(|l| slice[(k, l)]).collect();
                // The wide columns count as exact beside the narrow ones.
                let rest = rounded(&row[wide..]);
                let error = |(l, j): (usize, usize)| match l.checked_sub(wide) {
                    Some(m) => (rest[m] - row[l]) * span.parameter_modes[(j, l)],
                    None => 0.0,
                };
                sum += (0..samples)
                    .map(|j| psi(j).map(error).sum::<f64>().powi(2))
                    .sum::<f64>();
            }
            mean(sum)
        };
        assert!(error(wide) <= 1.5 * budget && error(wide - 1) > 0.5 * budget);

        let budget = snapshots.quantisation_budget(&pod, MODES_SHARE);
        let wide = snapshots.wide_parameter_modes(&pod, span);
        assert!(0 < wide && wide < columns, "{wide} of {columns}");
        let error = |wide: usize| {
            let modes: Vec<Vec<f64>> = (0..columns)
                .map(|l| {
                    let mode: Vec<f64> = (0..samples).map(|j| span.parameter_modes[(j, l)]).collect();
                    if l < wide { mode } else { rounded(&mode) }
                })
                .collect();
            let mut sum = 0.0;
            for (slice, j) in span
                .slices
                .iter()
                .flat_map(|slice| (0..samples).map(move |j| (slice, j)))
            {
                for k in 0..slice.nrows() {
                    let error = psi(j).map(|(l, j)| slice[(k, l)] * (modes[l][j] - span.parameter_modes[(j, l)]));
                    sum += error.sum::<f64>().powi(2);
                }
            }
            mean(sum)
        };
        assert!(error(wide) <= 1.5 * budget && error(wide - 1) > 0.5 * budget);
    }
}
