//! Cubic splines in time that follow the values and rates of snapshots.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;

use crate::dense::product;
use std::ops::Range;

/// Order of the splines.
const ORDER: usize = 4;
/// The weight of a rate against a value: a third of the shorter interval beside its instant, for a control lies so far
/// from it.
const RATE_SHARE: f64 = 1.0 / 3.0;
/// The most spans of time with modes of their own.
const MAX_SPANS: usize = 4;
/// The least controls of a span, unless there are fewer.
const MIN_CONTROLS: usize = 8;

/// A span of time: successive controls, and the instants between the places of the first and of the next span's first.
pub(crate) struct Span {
    pub(crate) controls: Range<usize>,
    pub(crate) instants: Range<usize>,
}

/// The splines of a cluster, and the least-squares fit to values and rates at its instants.
pub(crate) struct TimeFit {
    /// Each end four times.
    pub(crate) knots: Vec<f64>,
    /// `[2 N_t, N_b]`: controls from values and weighted rates.
    operator: Mat<f64>,
}

impl TimeFit {
    /// The weight of the rate at each instant.
    pub(crate) fn rate_weights(times: &[f64]) -> Vec<f64> {
        let last = times.len() - 1;
        let weight = |i: usize| {
            let before = (i > 0).then(|| times[i] - times[i - 1]);
            let after = (i < last).then(|| times[i + 1] - times[i]);
            let nearer = before.into_iter().chain(after).fold(f64::INFINITY, f64::min);
            RATE_SHARE * nearer
        };
        (0..times.len()).map(weight).collect()
    }

    /// Slows the start of snapshots `[r, 2 N_t]`, values and then weighted rates, to what a cubic through both ends of
    /// the first interval follows without overshoot: three times the mean rate (Fritsch and Carlson 1980). A membrane
    /// may relax much faster than the snapshots follow each other.
    pub(crate) fn limit_start(snapshots: &mut Mat<f64>) {
        let count = snapshots.ncols() / 2;
        let norm = |entry: &dyn Fn(usize) -> f64| (0..snapshots.nrows()).map(|r| entry(r).powi(2)).sum::<f64>().sqrt();
        let rate = norm(&|r| snapshots[(r, count)]);
        let limit = 3.0 * RATE_SHARE * norm(&|r| snapshots[(r, 1)] - snapshots[(r, 0)]);
        if rate > limit {
            snapshots.col_mut(count).iter_mut().for_each(|x| *x *= limit / rate);
        }
    }

    /// Splines for snapshots `[r, 2 N_t]`, values and then weighted rates, of some samples: as few knots as leave no
    /// more than a length (root mean square over the samples) of the value and of the weighted rate at each instant.
    ///
    /// Knots lie at instants. Where the fit is not good enough, the interval gets another knot in its middle; where it
    /// has no instant in it, both its ends are doubled, until the spline is the cubic with the values and rates of the
    /// instants.
    pub(crate) fn new(times: &[f64], snapshots: &[Mat<f64>], tolerance: f64) -> Self {
        let count = times.len();
        let budget = tolerance * tolerance * snapshots.len() as f64;
        let weights = Self::rate_weights(times);
        let mut multiplicity: Vec<usize> = vec![0; count];
        (multiplicity[0], multiplicity[count - 1]) = (ORDER, ORDER);
        loop {
            let fit = Self::with(times, &multiplicity, &weights);
            // Residual of the fit of a unit snapshot.
            let design = design(&fit.knots, times, &weights);
            let projected = product(&fit.operator, &design.transpose().to_owned());
            let left = Mat::from_fn(2 * count, 2 * count, |a, b| {
                projected[(a, b)] - if a == b { 1.0 } else { 0.0 }
            });
            let mut residual = vec![0.0; 2 * count];
            for snapshot in snapshots {
                let left = product(snapshot, &left);
                for (row, residual) in residual.iter_mut().enumerate() {
                    *residual += left.col(row).squared_norm_l2();
                }
            }
            let bad = |i: usize| residual[i] > budget || residual[count + i] > budget;
            let ends: Vec<usize> = (0..count).filter(|i| multiplicity[*i] > 0).collect();
            let mut refined = false;
            for interval in ends.windows(2) {
                let [first, last] = [interval[0], interval[1]];
                if !(first..=last).any(bad) {
                    continue;
                }
                let middle = (first + last) / 2;
                if middle > first {
                    multiplicity[middle] = 1;
                    refined = true;
                } else {
                    for end in [first, last] {
                        refined |= multiplicity[end] == 1;
                        multiplicity[end] = multiplicity[end].max(2);
                    }
                }
            }
            if !refined {
                return fit;
            }
        }
    }

    fn with(times: &[f64], multiplicity: &[usize], weights: &[f64]) -> Self {
        let knots = times.iter().zip(multiplicity);
        let knots: Vec<f64> = knots.flat_map(|(t, m)| std::iter::repeat_n(*t, *m)).collect();
        let count = times.len();
        let design = design(&knots, times, weights);
        let identity: Mat<f64> = Mat::identity(2 * count, 2 * count);
        // The spline starts and ends at the first and last snapshot: a value there is its first or last control.
        let solution = pinned(&design, &identity, [0, count - 1]);
        TimeFit {
            knots,
            operator: solution.transpose().to_owned(),
        }
    }

    /// Number of controls.
    pub(crate) fn count(&self) -> usize {
        self.knots.len() - ORDER
    }

    /// Time in one span.
    pub(crate) fn one_span(&self, times: &[f64]) -> Vec<Span> {
        vec![self.span(0..self.count(), times)]
    }

    /// Time in a few spans of as many controls: most lie at the start, where the motion is fastest.
    pub(crate) fn spans(&self, times: &[f64]) -> Vec<Span> {
        let controls = self.count();
        let count = (controls / MIN_CONTROLS).clamp(1, MAX_SPANS);
        let start = |span: usize| span * controls / count;
        (0..count)
            .map(|span| self.span(start(span)..start(span + 1), times))
            .collect()
    }

    fn span(&self, controls: Range<usize>, times: &[f64]) -> Span {
        let start = times.partition_point(|t| *t < self.place(controls.start));
        let end = times.partition_point(|t| *t <= self.place(controls.end.min(self.count() - 1)));
        Span {
            instants: start.min(end.saturating_sub(1))..end,
            controls,
        }
    }

    /// Where a control acts: the mean of the knots inside its spline (Greville 1967).
    fn place(&self, control: usize) -> f64 {
        self.knots[control + 1..control + ORDER].iter().sum::<f64>() / (ORDER - 1) as f64
    }

    /// Controls `[r, N_b]` of a sample's snapshots `[r, 2 N_t]`.
    pub(crate) fn controls(&self, snapshots: &Mat<f64>) -> Mat<f64> {
        product(snapshots, &self.operator)
    }
}

/// The least-squares solution `[n, m]` of a design `[rows, n]`, with the first and last unknown taken from two rows.
fn pinned(design: &Mat<f64>, right: &Mat<f64>, [first, last]: [usize; 2]) -> Mat<f64> {
    let (rows, unknowns) = design.shape();
    let inner = unknowns - 2;
    let known = |row: usize, column: usize| {
        design[(row, 0)] * right[(first, column)] + design[(row, unknowns - 1)] * right[(last, column)]
    };
    let reduced = Mat::from_fn(rows, inner, |row, k| design[(row, k + 1)]);
    let rest = Mat::from_fn(rows, right.ncols(), |row, column| {
        right[(row, column)] - known(row, column)
    });
    let solution = reduced.col_piv_qr().solve_lstsq(&rest);
    Mat::from_fn(unknowns, right.ncols(), |k, column| match k {
        0 => right[(first, column)],
        k if k == unknowns - 1 => right[(last, column)],
        k => solution[(k - 1, column)],
    })
}

/// Values and weighted rates `[2 N_t, N_b]` of all splines at the instants.
fn design(knots: &[f64], times: &[f64], weights: &[f64]) -> Mat<f64> {
    let mut design = Mat::zeros(2 * times.len(), knots.len() - ORDER);
    for (i, (t, weight)) in times.iter().zip(weights).enumerate() {
        let last = knots.len() - ORDER - 1;
        let interval = (ORDER - 1..last).take_while(|k| knots[k + 1] <= *t).count() + ORDER - 1;
        let quadratic = basis(knots, interval, 2, *t);
        let cubic = basis(knots, interval, 3, *t);
        for (j, value) in cubic.into_iter().enumerate() {
            let b = interval + 1 - ORDER + j;
            design[(i, b)] = value;
            // B' = 3 (B_b of degree 2 / its support - B_(b+1) of degree 2 / its support), without those that are zero
            // here.
            let slope = |j: usize, b: usize| 3.0 * quadratic[j] / (knots[b + 3] - knots[b]);
            let rising = if j > 0 { slope(j - 1, b) } else { 0.0 };
            let falling = if j < 3 { slope(j, b + 1) } else { 0.0 };
            design[(times.len() + i, b)] = weight * (rising - falling);
        }
    }
    design
}

/// The B-splines of a degree that are not zero in `[knots[interval], knots[interval + 1]]`, at t (Cox and de Boor).
fn basis(knots: &[f64], interval: usize, degree: usize, t: f64) -> Vec<f64> {
    let mut values = vec![1.0];
    for d in 1..=degree {
        let mut next = vec![0.0; d + 1];
        for (j, value) in values.iter().enumerate() {
            let (start, end) = (knots[interval + 1 + j - d], knots[interval + 1 + j]);
            let share = (t - start) / (end - start);
            next[j] += (1.0 - share) * value;
            next[j + 1] += share * value;
        }
        values = next;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values and weighted rates of functions at instants.
    fn snapshots(times: &[f64], functions: &[fn(f64) -> [f64; 2]]) -> Mat<f64> {
        let weights = TimeFit::rate_weights(times);
        Mat::from_fn(functions.len(), 2 * times.len(), |r, i| {
            match i.checked_sub(times.len()) {
                None => functions[r](times[i])[0],
                Some(i) => weights[i] * functions[r](times[i])[1],
            }
        })
    }

    fn value(fit: &TimeFit, controls: &Mat<f64>, row: usize, t: f64) -> f64 {
        let last = fit.count() - 1;
        let interval = (ORDER - 1..last).take_while(|k| fit.knots[k + 1] <= t).count() + ORDER - 1;
        let values = basis(&fit.knots, interval, 3, t);
        values
            .iter()
            .enumerate()
            .map(|(j, value)| value * controls[(row, interval + 1 - ORDER + j)])
            .sum()
    }

    #[test]
    fn a_cubic_needs_no_knots_and_a_decay_needs_them_where_it_is_fast() {
        let times: Vec<f64> = (0..=40).map(|i| 0.1 * f64::from(i)).collect();
        let cubic: fn(f64) -> [f64; 2] = |t| [1.0 - t + 0.3 * t.powi(3), -1.0 + 0.9 * t * t];
        let data = snapshots(&times, &[cubic]);
        let fit = TimeFit::new(&times, &[data.to_owned()], 1e-9);
        assert_eq!(fit.count(), 4);
        let controls = fit.controls(&data);
        assert!((value(&fit, &controls, 0, 1.234) - cubic(1.234)[0]).abs() < 1e-12);

        let decay: fn(f64) -> [f64; 2] = |t| [(-3.0 * t).exp(), -3.0 * (-3.0 * t).exp()];
        let data = snapshots(&times, &[cubic, decay]);
        let mut counts = Vec::new();
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let fit = TimeFit::new(&times, &[data.to_owned()], tolerance);
            let controls = fit.controls(&data);
            for i in 0..=400 {
                let t = 0.01 * f64::from(i);
                let error = value(&fit, &controls, 1, t) - decay(t)[0];
                assert!(error.abs() < 3.0 * tolerance + 3e-5, "{tolerance} {t} {error:e}");
            }
            let early = fit.knots.iter().filter(|t| **t > 0.0 && **t < 2.0).count();
            assert!(2 * early >= fit.count() - 4, "{:?}", fit.knots);
            counts.push(fit.count());
        }
        assert!(
            counts[0] < counts[1] && counts[1] < counts[2] && counts[2] <= 2 * times.len(),
            "{counts:?}"
        );
    }

    #[test]
    fn doubled_knots_return_values_and_rates() {
        // Noise: nothing smooth is near, so every knot is doubled.
        let times = [0.0, 0.3, 1.0, 1.2, 2.0];
        let data = Mat::from_fn(3, 10, |r, i| ((7 * r + 3 * i) as f64 * 12.9898).sin());
        let fit = TimeFit::new(&times, &[data.to_owned()], 1e-9);
        let controls = fit.controls(&data);
        let weights = TimeFit::rate_weights(&times);
        for (i, t) in times.iter().enumerate() {
            assert!((value(&fit, &controls, 1, *t) - data[(1, i)]).abs() < 1e-12);
            let step = if i == 4 { -1e-6 } else { 1e-6 };
            let rate = (value(&fit, &controls, 1, t + step) - value(&fit, &controls, 1, *t)) / step;
            assert!((weights[i] * rate - data[(1, 5 + i)]).abs() < 1e-4, "{t}");
        }
    }

    #[test]
    fn a_start_too_fast_for_the_snapshots_does_not_overshoot() {
        let times = [0.0, 1.0, 2.0, 3.0];
        let decay: fn(f64) -> [f64; 2] = |t| [(-15.0 * t).exp(), -15.0 * (-15.0 * t).exp()];
        let mut data = snapshots(&times, &[decay]);
        TimeFit::limit_start(&mut data);
        let fit = TimeFit::new(&times, &[data.to_owned()], 1e-6);
        let controls = fit.controls(&data);
        for i in 0..=300 {
            let found = value(&fit, &controls, 0, 0.01 * f64::from(i));
            assert!((-0.05..=1.05).contains(&found), "{found}");
        }
    }
}
