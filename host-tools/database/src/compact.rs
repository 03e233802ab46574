//! Snapshots as small integers.
//!
//! Positions are rounded to multiples of [`POSITION_STEP`], velocities to multiples of [`VELOCITY_STEP`], and nothing
//! else is lost. Each instant is predicted from those known before it, and only the errors of the prediction are kept:
//!
//! - a velocity from the one before and the last differences between instants;
//! - a position, once all velocities are known, from the one before, the velocities around it and the last
//!   differences of the positions;
//! - and for both a constant in the axial direction, which takes the translation of the capsule.
//!
//! The coefficients of these combinations are those that fit best at each instant. So the instants need no even
//! spacing, a relaxation is followed at its own rates, and a steady translation costs nothing. The errors are small, of
//! either sign; zig-zag coding (0, -1, 1, -2, ... become 0, 1, 2, 3, ...) makes them unsigned, and their bytes are
//! stored plane by plane, all the lowest bytes first, so that deflate finds the high planes nearly empty.
//!
//! In NumPy, with `f` a configuration's file and `m` the `mesh.npz`:
//!
//! ```python
//! def decode(name, columns):  # (planes, N_t, sector nodes, 3) bytes and (N_t, columns) coefficients
//!     u = sum(p.astype(np.int64) << 8 * k for k, p in enumerate(f[name])); k = (u >> 1) ^ -(u & 1)
//!     for i, c in enumerate(f[name + "_predictor"].astype(np.int64)):
//!         if i > 0: k[i] += k[i - 1]
//!         k[i] += (sum(a * b for a, b in zip(c, columns(k, i))) + (1 << 23)) >> 24
//!     return k
//! axial = np.array([1 << 14, 0, 0])
//! past = lambda k, i, n: [k[i - j] - k[i - j - 1] for j in range(1, n + 1) if i > j]
//! kv = decode("velocities", lambda k, i: [axial] * (i > 0) + past(k, i, 6))
//! around = lambda i: [kv[i]] * (i > 0) + [kv[j] - kv[j - 1] for j in (i - 1, i, i + 1) if 0 < i and 0 < j < len(kv)]
//! kx = decode("positions", lambda k, i: [axial] * (i > 0) + around(i) + past(k, i, 2))
//! x, v = kx * 2.0**-21, kv * 2.0**-20
//! full = lambda s: np.einsum("nij,tnj->tni", m["operations"][m["operation"]], s[:, m["representative"]])
//! ```
//!
//! `full` is for files of one sector; a file without symmetry has all the nodes already.

use ndarray::{Array2, Array4, ArrayView2, ArrayView4};

use crate::DatabaseError;
use crate::predictor::{Row, fit, predict};

/// The fixed-point step of positions, in l. An error of half a step in each component is 4.2e-7 l.
pub const POSITION_STEP: f64 = 1.0 / 2_097_152.0;

/// The fixed-point step of velocities, in V. An error of half a step in each component is 8.3e-7 V.
pub const VELOCITY_STEP: f64 = 1.0 / 1_048_576.0;

/// The largest magnitude that is stored.
pub const LIMIT: f64 = 1e6;

/// Snapshots of one field: a row an instant, `[N_t][N]`.
pub type Snapshots = Vec<Vec<[f64; 3]>>;

/// One field as it is stored.
#[derive(Debug, Clone, PartialEq)]
pub struct Code {
    /// Byte planes of the zig-zag coded errors of prediction, `(planes, N_t, N, 3)`.
    pub planes: Array4<u8>,
    /// The coefficients of the prediction in units of 2^-24, `(N_t, columns)`.
    pub predictor: Array2<i32>,
}

/// Positions and velocities as they are stored.
///
/// # Errors
/// [`DatabaseError::TooLarge`] when a magnitude reaches [`LIMIT`].
pub fn encode(positions: &[Vec<[f64; 3]>], velocities: &[Vec<[f64; 3]>]) -> Result<[Code; 2], DatabaseError> {
    let positions = round("positions", positions, POSITION_STEP)?;
    let velocities = round("velocities", velocities, VELOCITY_STEP)?;
    Ok([
        encode_rows(&positions, &|rows, i| position_columns(rows, &velocities, i)),
        encode_rows(&velocities, &velocity_columns),
    ])
}

/// Positions and velocities from their planes and predictors; every one of the same instants and nodes.
#[must_use]
pub fn decode(
    positions: (ArrayView4<u8>, ArrayView2<i32>),
    velocities: (ArrayView4<u8>, ArrayView2<i32>),
) -> [Snapshots; 2] {
    let velocities = decode_rows(velocities, &velocity_columns);
    let positions = decode_rows(positions, &|rows, i| position_columns(rows, &velocities, i));
    [scale(&positions, POSITION_STEP), scale(&velocities, VELOCITY_STEP)]
}

/// The columns of a prediction of row `i` from the rows before it.
type Columns<'a> = dyn Fn(&[Row], usize) -> Vec<Row> + 'a;

/// The greatest number of columns.
const COLUMNS: usize = 7;
/// Numbers of past differences that predict a velocity and a position.
const PAST: [usize; 2] = [6, 2];
/// The constant in the axial direction. With coefficients up to 128 it takes any translation.
const AXIAL: [i64; 3] = [1 << 14, 0, 0];

fn velocity_columns(rows: &[Row], i: usize) -> Vec<Row> {
    if i == 0 {
        return Vec::new();
    }
    let mut columns = vec![vec![AXIAL; rows[0].len()]];
    columns.extend(past(rows, i, PAST[0]));
    columns
}

fn position_columns(rows: &[Row], velocities: &[Row], i: usize) -> Vec<Row> {
    if i == 0 {
        return Vec::new();
    }
    let mut columns = vec![vec![AXIAL; rows[0].len()], velocities[i].clone()];
    let around = (i - 1).max(1)..(i + 2).min(velocities.len());
    columns.extend(around.map(|j| difference(velocities, j)));
    columns.extend(past(rows, i, PAST[1]));
    columns
}

/// The last `count` differences before row `i`, or as many as there are.
fn past(rows: &[Row], i: usize, count: usize) -> impl Iterator<Item = Row> + '_ {
    (1..=count.min(i.saturating_sub(1))).map(move |j| difference(rows, i - j))
}

/// Row `i` less the row before.
fn difference(rows: &[Row], i: usize) -> Row {
    let mut difference = rows[i].clone();
    for (d, before) in difference.as_flattened_mut().iter_mut().zip(rows[i - 1].as_flattened()) {
        *d = d.wrapping_sub(*before);
    }
    difference
}

fn round(what: &str, fields: &[Vec<[f64; 3]>], step: f64) -> Result<Vec<Row>, DatabaseError> {
    let too_large = |v: &&f64| v.is_nan() || v.abs() >= LIMIT;
    if let Some(&value) = fields.iter().flat_map(|f| f.as_flattened()).find(too_large) {
        return Err(DatabaseError::TooLarge {
            what: what.to_owned(),
            value,
            limit: LIMIT,
        });
    }
    let integer = |v: f64| (v / step).round() as i64;
    Ok(fields
        .iter()
        .map(|f| f.iter().map(|v| v.map(integer)).collect())
        .collect())
}

fn scale(rows: &[Row], step: f64) -> Snapshots {
    rows.iter()
        .map(|row| row.iter().map(|v| v.map(|k| k as f64 * step)).collect())
        .collect()
}

/// The first prediction of row `i`, before that by columns: the row before it.
fn base(rows: &[Row], i: usize, nodes: usize) -> Row {
    match i {
        0 => vec![[0; 3]; nodes],
        _ => rows[i - 1].clone(),
    }
}

fn encode_rows(rows: &[Row], columns: &Columns) -> Code {
    let (instants, nodes) = (rows.len(), rows.first().map_or(0, Vec::len));
    let mut predictor = Array2::zeros((instants, COLUMNS));
    let mut codes: Vec<u64> = Vec::with_capacity(instants * nodes * 3);
    for i in 0..instants {
        let (base, columns) = (base(rows, i, nodes), columns(rows, i));
        let coefficients = fit(&rows[i], &base, &columns);
        for (entry, coefficient) in predictor.row_mut(i).iter_mut().zip(&coefficients) {
            *entry = *coefficient;
        }
        let predicted = predict(&base, &columns, &coefficients);
        let pairs = rows[i].as_flattened().iter().zip(predicted.as_flattened());
        codes.extend(pairs.map(|(r, p)| {
            let error = r.wrapping_sub(*p);
            ((error << 1) ^ (error >> 63)).cast_unsigned()
        }));
    }
    let largest = codes.iter().copied().max().unwrap_or(0);
    let count = (largest.checked_ilog2().unwrap_or(0) as usize) / 8 + 1;
    let bytes = (0..count)
        .flat_map(|k| codes.iter().map(move |c| (c >> (8 * k)) as u8))
        .collect();
    Code {
        planes: Array4::from_shape_vec((count, instants, nodes, 3), bytes).unwrap_or_default(),
        predictor,
    }
}

fn decode_rows((planes, predictor): (ArrayView4<u8>, ArrayView2<i32>), columns: &Columns) -> Vec<Row> {
    let (count, instants, nodes, _) = planes.dim();
    let mut rows: Vec<Row> = Vec::with_capacity(instants);
    for i in 0..instants {
        let columns = columns(&rows, i);
        let mut row = predict(&base(&rows, i, nodes), &columns, &predictor.row(i).to_vec());
        for (n, value) in row.iter_mut().enumerate() {
            for (d, v) in value.iter_mut().enumerate() {
                let code = (0..count.min(8)).fold(0, |c, k| c | u64::from(planes[[k, i, n, d]]) << (8 * k));
                *v = v.wrapping_add((code >> 1).cast_signed() ^ -(code & 1).cast_signed());
            }
        }
        rows.push(row);
    }
    rows
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

    fn round_trip(positions: &[Vec<[f64; 3]>], velocities: &[Vec<[f64; 3]>]) -> (f64, f64) {
        let [x, v] = encode(positions, velocities).unwrap();
        let [x, v] = decode(
            (x.planes.view(), x.predictor.view()),
            (v.planes.view(), v.predictor.view()),
        );
        (worst(&x, positions), worst(&v, velocities))
    }

    /// Close together at the start, then wider.
    fn uneven() -> Vec<f64> {
        let early = [0.0, 0.005, 0.01, 0.02, 0.035, 0.05, 0.075, 0.1, 0.15];
        early.into_iter().chain((1..=100).map(|i| 0.2 * f64::from(i))).collect()
    }

    #[test]
    fn a_round_trip_is_within_half_a_step() {
        let mesh = octahedral(3);
        let t = relaxing(&mesh, &uneven());
        let (x, v) = round_trip(&t.positions, &t.velocities);
        assert!(x <= 0.5001 * POSITION_STEP && v <= 0.5001 * VELOCITY_STEP, "{x} {v}");
    }

    proptest! {
        #[test]
        fn any_numbers_come_back(
            rows in proptest::collection::vec(
                proptest::collection::vec([-9e5..9e5f64, -1.0..1.0, -1e-3..1e-3], 4),
                1..12,
            ),
        ) {
            let slower = |row: &Vec<[f64; 3]>| row.iter().map(|v| v.map(|c| 1e-2 * c)).collect();
            let velocities: Vec<_> = rows.iter().rev().map(slower).collect();
            let (x, v) = round_trip(&rows, &velocities);
            prop_assert!(x <= 0.51 * POSITION_STEP && v <= 0.51 * VELOCITY_STEP, "{} {}", x, v);
        }
    }

    #[test]
    fn a_relaxation_at_uneven_times_costs_less_than_half_a_byte_a_number() {
        let mesh = octahedral(3);
        let t = relaxing(&mesh, &uneven());
        let codes = encode(&t.positions, &t.velocities).unwrap();
        for code in codes {
            let late = code.planes.slice(ndarray::s![.., 12.., .., ..]);
            let beyond_a_nibble = late.iter().filter(|b| **b > 15).count();
            assert!(
                beyond_a_nibble * 100 < late.len(),
                "{beyond_a_nibble} of {}",
                late.len()
            );
            let steady = code.planes.slice(ndarray::s![.., 80.., .., ..]);
            assert!(steady.iter().all(|b| *b <= 2), "a translation costs nothing");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let rest = || vec![vec![[0.0; 3]]];
        let error = encode(&rest(), &[vec![[0.0, 2e6, 0.0]]]).unwrap_err();
        assert!(matches!(error, DatabaseError::TooLarge { value: 2e6, .. }));
        assert!(encode(&[vec![[f64::NAN, 0.0, 0.0]]], &rest()).is_err());
    }
}
