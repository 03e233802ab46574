//! How smooth a database is along its rows: a reduced-order model cannot be more accurate than the scatter of its data.
//!
//! The k-th difference of samples at equal steps of Ca removes what is smooth: that of a function falls with k if the
//! steps resolve it, while independent scatter of unit deviation is amplified by the root of the binomial (2k, k).
//! Differences that have stopped to fall therefore tell the scatter.

use capsule_database::{Database, Trajectory};
use serde::Serialize;

use crate::StudyError;

/// The orders of the differences.
pub const ORDERS: [usize; 4] = [3, 4, 5, 6];

/// Samples closer than this many steps to the last steady one of their row are left out: there the solution itself
/// varies fast.
const AWAY_FROM_LIMIT: usize = 2;

/// Tolerance on equal steps and rows.
const SAME: f64 = 1e-9;

/// Differences along one row of equal confinement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// a/l
    pub confinement: f64,
    /// First and last capillary number.
    pub capillary_numbers: [f64; 2],
    /// For each of [`ORDERS`] that the row is long enough for: laboratory frame.
    pub laboratory: Vec<Difference>,
    /// The same in the frame of the volume centroid: of the shape alone.
    pub shape: Vec<Difference>,
}

/// Differences of one order; root mean square over the nodes, as a fraction of a.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// The order k.
    pub order: usize,
    /// The greatest, over windows of k + 1 samples and all instants.
    pub greatest: f64,
    /// Where: the window's middle in Ca, and the instant.
    pub at: [f64; 2],
    /// The median over windows and instants from t = 1 on.
    pub median: f64,
    /// The median over the amplification of independent scatter.
    pub scatter: f64,
}

/// Differences along the rows of a database, of its steady samples at steps of `step` in Ca, at the instants of the
/// database.
///
/// # Errors
/// Those of the database.
pub fn smoothness(database: &Database, step: f64) -> Result<Vec<Row>, StudyError> {
    let mut steady: Vec<[f64; 2]> = database
        .entries()?
        .into_iter()
        .filter(|entry| entry.status.is_steady())
        .map(|entry| [entry.parameters[0], entry.parameters[1]])
        .collect();
    steady.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
    let mut rows = Vec::new();
    for row in steady.chunk_by(|a, b| (a[1] - b[1]).abs() < SAME) {
        let mut grid: Vec<[f64; 2]> = row
            .iter()
            .copied()
            .filter(|[ca, _]| (ca / step - (ca / step).round()).abs() < SAME / step)
            .collect();
        grid.truncate(grid.len().saturating_sub(AWAY_FROM_LIMIT));
        let equal = grid
            .windows(2)
            .all(|pair| (pair[1][0] - pair[0][0] - step).abs() < SAME);
        if grid.len() > ORDERS[0] && equal {
            rows.push(differences(database, &grid)?);
        }
    }
    Ok(rows)
}

fn differences(database: &Database, grid: &[[f64; 2]]) -> Result<Row, StudyError> {
    let times = database.times();
    let samples: Vec<Trajectory> = grid
        .iter()
        .map(|parameters| database.read(parameters)?.extended(database.mesh(), times))
        .collect::<Result<_, _>>()?;
    let of = |frame: &dyn Fn(&Trajectory, usize) -> f64| {
        let orders = ORDERS.iter().filter(|&&order| order < grid.len());
        orders
            .map(|&order| difference(&samples, grid, times, order, frame))
            .collect()
    };
    let ends = |index: usize| grid.get(index).map_or(0.0, |parameters| parameters[0]);
    Ok(Row {
        confinement: grid[0][1],
        capillary_numbers: [ends(0), ends(grid.len() - 1)],
        laboratory: of(&|_, _| 0.0),
        shape: of(&|sample, instant| sample.centroid[instant]),
    })
}

fn difference(
    samples: &[Trajectory],
    grid: &[[f64; 2]],
    times: &[f64],
    order: usize,
    origin: &dyn Fn(&Trajectory, usize) -> f64,
) -> Difference {
    let weights: Vec<f64> = (0..=order)
        .map(|j| if j % 2 == 0 { 1.0 } else { -1.0 } * binomial(order, j))
        .collect();
    let (mut greatest, mut at) = (0.0, [0.0; 2]);
    let mut late = Vec::new();
    for (start, window) in samples.windows(order + 1).enumerate() {
        for (instant, &time) in times.iter().enumerate() {
            let mut square = 0.0;
            for node in 0..window[0].positions[instant].len() {
                for d in 0..3 {
                    let sum: f64 = window
                        .iter()
                        .zip(&weights)
                        .map(|(sample, weight)| {
                            let origin = if d == 0 { origin(sample, instant) } else { 0.0 };
                            weight * (sample.positions[instant][node][d] - origin)
                        })
                        .sum();
                    square += sum * sum;
                }
            }
            let value = (square / window[0].positions[instant].len() as f64).sqrt() / grid[0][1];
            if value > greatest {
                (greatest, at) = (value, [0.5 * (grid[start][0] + grid[start + order][0]), time]);
            }
            if time >= 1.0 {
                late.push(value);
            }
        }
    }
    late.sort_by(f64::total_cmp);
    let median = late.get(late.len() / 2).copied().unwrap_or_default();
    Difference {
        order,
        greatest,
        at,
        median,
        scatter: median / binomial(2 * order, order).sqrt(),
    }
}

fn binomial(n: usize, k: usize) -> f64 {
    (1..=k).map(|i| (n + 1 - i) as f64 / i as f64).product()
}
