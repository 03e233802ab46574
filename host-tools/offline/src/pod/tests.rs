//! The double POD of a small motion.

use super::*;
use crate::dense::product;

const INSTANTS: usize = 24;

/// Five samples of a motion and its rate, 12 rows, of a mesh of 4 nodes.
pub(crate) fn states() -> Vec<[State; 2]> {
    motion(12, 5)
}

/// Samples of a motion and its rate.
pub(crate) fn motion(rows: usize, samples: usize) -> Vec<[State; 2]> {
    // Value and rate of a decay and of swings.
    let time = |n: usize, t: f64| match n {
        0 => [1.0 - (-0.7 * t).exp(), 0.7 * (-0.7 * t).exp()],
        _ => [(n as f64 * t).sin(), n as f64 * (n as f64 * t).cos()],
    };
    let size = |n: usize, j: usize| 0.3f64.powi(n as i32) * (1.0 + j as f64 * (1.0 + 0.3 * (n * j) as f64).cos());
    let state = |j: usize, which: usize| State {
        translation: times()
            .iter()
            .map(|t| [(1.0 + 0.1 * j as f64) * t, 1.0 + 0.1 * j as f64][which])
            .collect(),
        shape: Mat::from_fn(rows, INSTANTS, |r, i| {
            (0..6)
                .map(|n| size(n, j) * time(n, times()[i])[which] * ((1.3 * n as f64 + 0.5) * r as f64).sin())
                .sum()
        }),
    };
    (0..samples).map(|j| [state(j, 0), state(j, 1)]).collect()
}

pub(crate) fn times() -> Vec<f64> {
    (0..INSTANTS).map(|i| 0.1 * i as f64).collect()
}

pub(crate) fn snapshots(states: &[[State; 2]], truncation: Truncation) -> Snapshots {
    let states: Vec<[&State; 2]> = states.iter().map(|[u, v]| [u, v]).collect();
    Snapshots::new(&states, &times(), 4, truncation).unwrap()
}

fn orthonormal(columns: &Mat<f64>) -> f64 {
    let gram = product(&columns.transpose().to_owned(), columns);
    let error = |k: usize, l: usize| (gram[(k, l)] - if k == l { 1.0 } else { 0.0 }).abs();
    (0..gram.nrows())
        .flat_map(|k| (0..gram.ncols()).map(move |l| (k, l)))
        .map(|(k, l)| error(k, l))
        .fold(0.0, f64::max)
}

/// Root mean square error of the displacement at the first and last instant, where the spline is its first and last
/// control, and greatest error of the translation there.
fn errors_at_ends(states: &[[State; 2]], snapshots: &Snapshots, pod: &DoublePod) -> [f64; 2] {
    let modes = snapshots.modes_at_nodes(pod);
    let (mut square, mut axial) = (0.0, 0.0f64);
    let ends = [(pod.spans.first(), 0), (pod.spans.last(), INSTANTS - 1)];
    for (span, i) in ends {
        let span = span.unwrap();
        let slice = if i == 0 { 0 } else { span.slices.len() - 1 };
        let control = if i == 0 { 0 } else { pod.axial_controls.nrows() - 1 };
        for (j, [state, _]) in states.iter().enumerate() {
            let psi = Mat::from_fn(span.parameter_modes.ncols(), 1, |l, _| span.parameter_modes[(j, l)]);
            let alpha = product(&span.slices[slice], &psi);
            for r in 0..12 {
                let value: f64 = (0..alpha.nrows()).map(|k| modes[(r, k)] * alpha[(k, 0)]).sum();
                square += (value - state.shape[(r, i)]).powi(2);
            }
            let translation: f64 = (0..pod.axial_modes.ncols())
                .map(|a| pod.axial_controls[(control, a)] * pod.axial_modes[(j, a)])
                .sum();
            axial = axial.max((translation - state.translation[i]).abs());
        }
    }
    [(square / (2.0 * 4.0 * 5.0)).sqrt(), axial]
}

#[test]
fn the_tolerance_is_kept_and_modes_are_orthonormal() {
    let states = states();
    let mut sizes = Vec::new();
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let snapshots = snapshots(&states, Truncation::Tolerance(tolerance));
        let pod = snapshots.reduce(&[0, 1, 2, 3, 4]).unwrap();
        let modes = snapshots.modes_at_nodes(&pod);
        assert!(orthonormal(&modes) < 1e-12);
        assert!(pod.spans.iter().all(|span| orthonormal(&span.parameter_modes) < 1e-12));
        let [shape, translation] = errors_at_ends(&states, &snapshots, &pod);
        // The tolerance is a mean over the instants, of which these are two.
        assert!(
            shape < 4.0 * tolerance && translation < 2.0 * tolerance,
            "{tolerance} {shape:e} {translation:e}"
        );
        assert!(pod.space_error <= tolerance && snapshots.parameter_error(&pod) <= PARAMETER_SHARE * tolerance);
        sizes.push((pod.modes.ncols(), pod.axial_controls.nrows()));
    }
    assert!(sizes[0] < sizes[1] && sizes[1] < sizes[2], "{sizes:?}");
}

#[test]
fn the_end_of_a_motion_needs_fewer_modes_than_its_start() {
    // Two shapes that stay, and sixteen that pass.
    const LONG: usize = 80;
    let times: Vec<f64> = (0..LONG).map(|i| 0.05 * i as f64).collect();
    let share = |n: usize, j: usize| 1.0 + (j as f64 * (0.4 + 0.7 * n as f64)).cos();
    let value = |n: usize, j: usize, t: f64| match n {
        0 | 1 => [
            share(n, j) * (0.2 * t * n as f64).cos(),
            -share(n, j) * 0.2 * n as f64 * (0.2 * t * n as f64).sin(),
        ],
        _ => {
            let (size, rate) = (0.1 * share(n, j) * (-4.0 * t).exp(), (3 * n) as f64);
            [
                size * (rate * t).cos(),
                -size * (4.0 * (rate * t).cos() + rate * (rate * t).sin()),
            ]
        }
    };
    let state = |j: usize, which: usize| State {
        translation: times.iter().map(|t| [*t, 1.0][which]).collect(),
        shape: Mat::from_fn(24, LONG, |r, i| {
            (0..18)
                .map(|n| value(n, j, times[i])[which] * ((1.1 * n as f64 + 0.5) * r as f64).sin())
                .sum()
        }),
    };
    let states: Vec<[State; 2]> = (0..7).map(|j| [state(j, 0), state(j, 1)]).collect();
    let joined: Vec<[&State; 2]> = states.iter().map(|[u, v]| [u, v]).collect();
    let tolerance = 1e-4;
    let snapshots = Snapshots::new(&joined, &times, 8, Truncation::Tolerance(tolerance)).unwrap();
    let pod = snapshots.reduce(&[0, 1, 2, 3, 4, 5, 6]).unwrap();

    assert_eq!(pod.spans.len(), 4);
    let controls: usize = pod.spans.iter().map(|span| span.slices.len()).sum();
    assert_eq!(controls, pod.axial_controls.nrows());
    let spans = snapshots.spans.iter();
    assert_eq!(spans.clone().map(|span| span.instants.start).min(), Some(0));
    assert_eq!(spans.map(|span| span.instants.end).max(), Some(LONG));
    let [first, .., last] = &pod.spans[..] else {
        unreachable!()
    };
    let rows = |span: &SpanPod| span.slices.iter().map(Mat::nrows).max().unwrap();
    assert!(rows(last) < rows(first), "{} {}", rows(last), rows(first));
    assert!(last.parameter_modes.ncols() < first.parameter_modes.ncols());

    // At its two ends the spline is its first and last control.
    let modes = snapshots.modes_at_nodes(&pod);
    for (span, slice, i) in [(first, 0, 0), (last, last.slices.len() - 1, LONG - 1)] {
        let alpha = product(&span.slices[slice], &span.parameter_modes.transpose().to_owned());
        let found = product(&leading(&modes, alpha.nrows()), &alpha);
        let square: f64 = (0..7)
            .flat_map(|j| (0..24).map(move |r| (j, r)))
            .map(|(j, r)| (found[(r, j)] - states[j][0].shape[(r, i)]).powi(2))
            .sum();
        let error = (square / (8.0 * 7.0)).sqrt();
        assert!(error < 4.0 * tolerance, "{i}: {error:e}");
    }
}

#[test]
fn ranks_are_those_asked_for() {
    let states = states();
    let snapshots = snapshots(&states, Truncation::Ranks(Ranks { space: 4, parameter: 2 }));
    let pod = snapshots.reduce(&[0, 1, 2, 3, 4]).unwrap();
    assert_eq!(pod.spans.len(), 1);
    assert_eq!((pod.modes.ncols(), pod.spans[0].parameter_modes.ncols()), (3, 2));
}

#[test]
fn what_is_left_out_keeps_the_budget() {
    let slice = Mat::from_fn(20, 7, |k, l| 0.6f64.powi(k as i32) * ((3 * k + l) as f64).cos());
    let end = kept_rows(&slice, 1e-6).nrows();
    let square = |rows: Range<usize>| -> f64 {
        rows.flat_map(|k| (0..7).map(move |l| (k, l)))
            .map(|(k, l)| slice[(k, l)].powi(2))
            .sum()
    };
    // A panel less would leave too much out.
    assert!(square(end..20) <= 1e-6 && square(end - LANES..20) > 1e-6);
    assert_eq!(end % LANES, 0);
}

#[test]
fn a_subset_is_reduced_as_if_the_rest_had_never_been() {
    let mut states = states();
    let whole = snapshots(&states, Truncation::Tolerance(1e-6))
        .reduce(&[0, 1, 3, 4])
        .unwrap();
    states.remove(2);
    let alone = snapshots(&states, Truncation::Tolerance(1e-6))
        .reduce(&[0, 1, 2, 3])
        .unwrap();
    for (a, b) in whole.space_values.iter().zip(&alone.space_values) {
        assert!((a - b).abs() < 1e-6 * whole.space_values[0], "{a} {b}");
    }
    assert_eq!(whole.modes.ncols(), alone.modes.ncols());
}
