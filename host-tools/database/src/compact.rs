//! Snapshots as small integers.
//!
//! Velocities are rounded to multiples of [`STEP`]; each is predicted from the two instants before it and only the error
//! of that prediction, a second difference, is kept. Positions are predicted by integrating the (rounded) velocities
//! with the trapezoidal rule; what that misses is rounded, and kept as second differences too. Nothing accumulates: a
//! decoded number is within half a step of the original. The differences are small, of either sign; zig-zag coding
//! (0, -1, 1, -2, ... become 0, 1, 2, 3, ...) makes them unsigned, and their bytes are stored plane by plane, all the
//! lowest bytes first, so that deflate finds the high planes nearly empty.
//!
//! In NumPy, with `f` a configuration's file and `m` the `mesh.npz`:
//!
//! ```python
//! def decode(b):  # (planes, N_t, sector nodes, 3) bytes
//!     u = sum(p.astype(np.int64) << 8 * k for k, p in enumerate(b)); d = (u >> 1) ^ -(u & 1)
//!     d[1:] = d[1:].cumsum(0); return d.cumsum(0) * 2.0**-21
//! v, h = decode(f["velocities"]), np.diff(f["times"])[:, None, None]
//! x = decode(f["positions"]); x[1:] += ((v[1:] + v[:-1]) * h / 2).cumsum(0)
//! full = lambda s: np.einsum("nij,tnj->tni", m["operations"][m["operation"]], s[:, m["representative"]])
//! ```
//!
//! `full` is for files of one sector; a file without symmetry has all the nodes already.

use ndarray::{Array4, ArrayView4};

use crate::DatabaseError;

/// The fixed-point step, in l for positions and in V for velocities. An error of half a step in each component is
/// 4.2e-7 l.
pub const STEP: f64 = 1.0 / 2_097_152.0;

/// The largest magnitude that is stored.
pub const LIMIT: f64 = 1e6;

/// Snapshots of one field: a row an instant, `[N_t][N]`.
pub type Snapshots = Vec<Vec<[f64; 3]>>;

/// Byte planes `(planes, N_t, N, 3)` of velocities, and the velocities as [`decode_velocities`] will return them.
///
/// # Errors
/// [`DatabaseError::TooLarge`] when a magnitude reaches [`LIMIT`].
pub fn encode_velocities(velocities: &[Vec<[f64; 3]>]) -> Result<(Array4<u8>, Snapshots), DatabaseError> {
    let integers = round("velocities", velocities)?;
    let decoded = integers.iter().map(|row| scale(row)).collect();
    Ok((to_planes(integers), decoded))
}

/// Byte planes `(planes, N_t, N, 3)` of positions, predicted from the decoded velocities at the same instants.
///
/// # Errors
/// [`DatabaseError::TooLarge`] when a magnitude reaches [`LIMIT`].
pub fn encode_positions(
    positions: &[Vec<[f64; 3]>],
    decoded_velocities: &[Vec<[f64; 3]>],
    times: &[f64],
) -> Result<Array4<u8>, DatabaseError> {
    let mut rest = positions.to_vec();
    combine(&mut rest, &integral(decoded_velocities, times), -1.0);
    Ok(to_planes(round("positions", &rest)?))
}

/// The velocities from their byte planes.
#[must_use]
pub fn decode_velocities(planes: ArrayView4<u8>) -> Snapshots {
    from_planes(planes).iter().map(|row| scale(row)).collect()
}

/// The positions from their byte planes, the decoded velocities and the instants.
#[must_use]
pub fn decode_positions(planes: ArrayView4<u8>, decoded_velocities: &[Vec<[f64; 3]>], times: &[f64]) -> Snapshots {
    let mut positions = decode_velocities(planes);
    combine(&mut positions, &integral(decoded_velocities, times), 1.0);
    positions
}

/// The trapezoidal rule from the first instant to each.
fn integral(velocities: &[Vec<[f64; 3]>], times: &[f64]) -> Snapshots {
    let mut sum = vec![[0.0; 3]; velocities.first().map_or(0, Vec::len)];
    let mut rows = Vec::with_capacity(times.len());
    for i in 0..times.len() {
        if i > 0 {
            let half = 0.5 * (times[i] - times[i - 1]);
            for (s, (a, b)) in sum.iter_mut().zip(velocities[i - 1].iter().zip(&velocities[i])) {
                for d in 0..3 {
                    s[d] += half * (a[d] + b[d]);
                }
            }
        }
        rows.push(sum.clone());
    }
    rows
}

/// `fields += sign * others`
fn combine(fields: &mut [Vec<[f64; 3]>], others: &[Vec<[f64; 3]>], sign: f64) {
    for (field, other) in fields.iter_mut().flatten().zip(others.iter().flatten()) {
        for d in 0..3 {
            field[d] += sign * other[d];
        }
    }
}

fn round(what: &str, fields: &[Vec<[f64; 3]>]) -> Result<Vec<Vec<[i64; 3]>>, DatabaseError> {
    let too_large = |v: &&f64| v.is_nan() || v.abs() >= LIMIT;
    if let Some(&value) = fields.iter().flat_map(|f| f.as_flattened()).find(too_large) {
        return Err(DatabaseError::TooLarge {
            what: what.to_owned(),
            value,
            limit: LIMIT,
        });
    }
    let integer = |v: f64| (v / STEP).round() as i64;
    Ok(fields
        .iter()
        .map(|f| f.iter().map(|v| v.map(integer)).collect())
        .collect())
}

fn scale(row: &[[i64; 3]]) -> Vec<[f64; 3]> {
    row.iter().map(|v| v.map(|k| k as f64 * STEP)).collect()
}

/// Differences in time, second ones from the third instant on, zig-zag coded and split into byte planes.
fn to_planes(mut rows: Vec<Vec<[i64; 3]>>) -> Array4<u8> {
    difference(&mut rows, 0);
    difference(&mut rows, 1);
    let (instants, nodes) = (rows.len(), rows.first().map_or(0, Vec::len));
    let codes: Vec<u64> = rows
        .iter()
        .flatten()
        .flatten()
        .map(|d| ((d << 1) ^ (d >> 63)).cast_unsigned())
        .collect();
    let largest = codes.iter().copied().max().unwrap_or(0);
    let planes = (largest.checked_ilog2().unwrap_or(0) as usize) / 8 + 1;
    let bytes = (0..planes)
        .flat_map(|k| codes.iter().map(move |c| (c >> (8 * k)) as u8))
        .collect();
    Array4::from_shape_vec((planes, instants, nodes, 3), bytes).unwrap_or_default()
}

fn from_planes(planes: ArrayView4<u8>) -> Vec<Vec<[i64; 3]>> {
    let (_, instants, nodes, _) = planes.dim();
    let mut rows = vec![vec![[0i64; 3]; nodes]; instants];
    for (i, row) in rows.iter_mut().enumerate() {
        for (n, value) in row.iter_mut().enumerate() {
            for (d, v) in value.iter_mut().enumerate() {
                let code = (0..planes.dim().0.min(8)).fold(0, |c, k| c | u64::from(planes[[k, i, n, d]]) << (8 * k));
                *v = (code >> 1).cast_signed() ^ -(code & 1).cast_signed();
            }
        }
    }
    accumulate(&mut rows, 1);
    accumulate(&mut rows, 0);
    rows
}

/// Replaces every row after row `first` by its difference from the row before.
fn difference(rows: &mut [Vec<[i64; 3]>], first: usize) {
    for i in (first + 1..rows.len()).rev() {
        let (before, after) = rows.split_at_mut(i);
        for (a, b) in after[0].as_flattened_mut().iter_mut().zip(before[i - 1].as_flattened()) {
            *a = a.wrapping_sub(*b);
        }
    }
}

/// Undoes [`difference`].
fn accumulate(rows: &mut [Vec<[i64; 3]>], first: usize) {
    for i in first + 1..rows.len() {
        let (before, after) = rows.split_at_mut(i);
        for (a, b) in after[0].as_flattened_mut().iter_mut().zip(before[i - 1].as_flattened()) {
            *a = a.wrapping_add(*b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;
    use crate::trajectory::tests::relaxing;
    use proptest::prelude::*;

    fn worst(a: &[Vec<[f64; 3]>], b: &[Vec<[f64; 3]>]) -> f64 {
        assert_eq!((a.len(), a[0].len()), (b.len(), b[0].len()));
        let pairs = a.iter().flatten().flatten().zip(b.iter().flatten().flatten());
        pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    fn round_trip(positions: &[Vec<[f64; 3]>], velocities: &[Vec<[f64; 3]>], times: &[f64]) -> (f64, f64) {
        let (v, decoded) = encode_velocities(velocities).unwrap();
        let x = encode_positions(positions, &decoded, times).unwrap();
        let v = decode_velocities(v.view());
        assert_eq!(v, decoded);
        (
            worst(&decode_positions(x.view(), &v, times), positions),
            worst(&v, velocities),
        )
    }

    #[test]
    fn a_round_trip_is_within_half_a_step() {
        let mesh = octahedral(3);
        let times: Vec<f64> = (0..=100).map(|i| 0.2 * f64::from(i)).collect();
        let t = relaxing(&mesh, &times);
        let (x, v) = round_trip(&t.positions, &t.velocities, &times);
        assert!(x <= 0.5001 * STEP && v <= 0.5001 * STEP, "{x} {v}");
    }

    proptest! {
        #[test]
        fn any_numbers_at_any_instants_come_back(
            rows in proptest::collection::vec(proptest::collection::vec([-9e5..9e5f64, -1.0..1.0, -1e-3..1e-3], 4), 1..8),
            steps in proptest::collection::vec(1e-3..2.0f64, 8),
        ) {
            let times: Vec<f64> = steps.iter().scan(0.0, |t, h| { let now = *t; *t += h; Some(now) }).collect();
            let velocities: Vec<_> = rows.iter().rev().map(|r| r.iter().map(|v| v.map(|c| 1e-2 * c)).collect()).collect();
            let (x, v) = round_trip(&rows, &velocities, &times[..rows.len()]);
            prop_assert!(x <= 0.51 * STEP && v <= 0.51 * STEP, "{} {}", x, v);
        }
    }

    #[test]
    fn smooth_motion_needs_one_byte_a_number_at_late_times() {
        let mesh = octahedral(3);
        let times: Vec<f64> = (0..=100).map(|i| 0.2 * f64::from(i)).collect();
        let t = relaxing(&mesh, &times);
        let (_, decoded) = encode_velocities(&t.velocities).unwrap();
        let planes = encode_positions(&t.positions, &decoded, &times).unwrap();
        let late = planes.slice(ndarray::s![1.., 50.., .., ..]);
        assert!(late.iter().all(|b| *b == 0));
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let error = encode_velocities(&[vec![[0.0, 2e6, 0.0]]]).unwrap_err();
        assert!(matches!(error, DatabaseError::TooLarge { value: 2e6, .. }));
        assert!(encode_velocities(&[vec![[f64::NAN, 0.0, 0.0]]]).is_err());
    }
}
