//! Databases of format version 1, which can be read but not written: evenly spaced instants, plain second differences.

use std::path::Path;

use ndarray::ArrayView4;
use serde::Deserialize;
use serde_json::Value;

use crate::compact::Snapshots;
use crate::{DatabaseError, Description};

/// The description from the text of a `database.json`.
pub(crate) fn description(path: &Path, value: Value) -> Result<Description, DatabaseError> {
    #[derive(Deserialize)]
    struct File {
        snapshot_interval: f64,
        end_time: f64,
        solver: Value,
    }
    let file: File = serde_json::from_value(value).map_err(DatabaseError::json(path))?;
    let last = (file.end_time / file.snapshot_interval + 1e-9).floor() as usize;
    let times = (0..=last).map(|i| i as f64 * file.snapshot_interval).collect();
    Ok(Description::new(times, file.solver))
}

/// Positions and velocities.
pub(crate) fn decode(positions: ArrayView4<u8>, velocities: ArrayView4<u8>, times: &[f64]) -> [Snapshots; 2] {
    let velocities = second_differences(velocities);
    let mut positions = second_differences(positions);
    let mut sum = vec![[0.0; 3]; velocities.first().map_or(0, Vec::len)];
    for i in 1..times.len() {
        let half = 0.5 * (times[i] - times[i - 1]);
        for (n, s) in sum.iter_mut().enumerate() {
            for d in 0..3 {
                s[d] += half * (velocities[i - 1][n][d] + velocities[i][n][d]);
                positions[i][n][d] += s[d];
            }
        }
    }
    [positions, velocities]
}

fn second_differences(planes: ArrayView4<u8>) -> Snapshots {
    let (count, instants, nodes, _) = planes.dim();
    let mut value = vec![[0i64; 3]; nodes];
    let mut change = value.clone();
    let mut rows = Vec::with_capacity(instants);
    for i in 0..instants {
        for n in 0..nodes {
            for d in 0..3 {
                let code = (0..count.min(8)).fold(0, |c, k| c | u64::from(planes[[k, i, n, d]]) << (8 * k));
                let error = (code >> 1).cast_signed() ^ -(code & 1).cast_signed();
                if i == 0 {
                    value[n][d] = error;
                } else {
                    change[n][d] = change[n][d].wrapping_add(error);
                    value[n][d] = value[n][d].wrapping_add(change[n][d]);
                }
            }
        }
        rows.push(value.iter().map(|v| v.map(|k| k as f64 / 2_097_152.0)).collect());
    }
    rows
}
