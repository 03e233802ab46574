//! Whether given velocities are the rates at which the positions change.
//!
//! Velocities in another unit, of another sign or in another frame would make a model that swings between its instants.

use super::Collection;
use super::motion::{median, rounded};
use crate::DatabaseError;

/// The most that the way from one snapshot to the next may differ from that by the mean of both velocities, as a share
/// of the greater one, in half of all intervals. A motion that the instants resolve differs by a few per cent, and one
/// that they do not by a half; velocities of another unit or sign by all.
const MAX: f64 = 0.9;
/// Ways shorter than this share of the longest are rest.
const REST: f64 = 1e-6;

/// Checks given velocities against the positions.
///
/// # Errors
/// [`DatabaseError::BadCollection`].
pub(super) fn check(collection: &Collection) -> Result<(), DatabaseError> {
    let mut intervals = Vec::new();
    for (positions, velocities) in collection.positions.iter().zip(&collection.velocities) {
        for i in 1..positions.len() {
            let half = 0.5 * (collection.times[i] - collection.times[i - 1]);
            let mut sums = [0.0; 3];
            for (n, (after, before)) in positions[i].iter().zip(&positions[i - 1]).enumerate() {
                for d in 0..3 {
                    let way = after[d] - before[d];
                    let by_velocity = half * (velocities[i][n][d] + velocities[i - 1][n][d]);
                    for (sum, x) in sums.iter_mut().zip([way, by_velocity, way - by_velocity]) {
                        *sum += x * x;
                    }
                }
            }
            intervals.push(sums.map(f64::sqrt));
        }
    }
    let greater = |[way, by_velocity, _]: &[f64; 3]| way.max(*by_velocity);
    let longest = intervals.iter().map(greater).fold(0.0, f64::max);
    intervals.retain(|interval| greater(interval) > REST * longest);
    let mut shares: Vec<f64> = intervals
        .iter()
        .map(|interval| interval[2] / greater(interval))
        .collect();
    if shares.is_empty() || median(&mut shares) <= MAX {
        return Ok(());
    }
    let mut ratios: Vec<f64> = intervals
        .iter()
        .map(|[way, by_velocity, _]| by_velocity / way)
        .collect();
    Err(DatabaseError::collection(format!(
        "`velocities` are not the rates of `positions`: between snapshots they lead {} times as far, in half of all \
         intervals; expected the same units, frame and direction (without `velocities` they are derived)",
        rounded(median(&mut ratios))
    )))
}
