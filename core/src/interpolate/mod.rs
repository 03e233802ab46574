//! From samples to a query in the parameter plane: f(theta) = sum_j L_j(theta) f(theta_j), linear in the data.

mod coordinates;
mod diffuse;
mod kernel;
pub(crate) mod neighbours;

use crate::Real;
use crate::error::EvaluateError;
use crate::linalg::{MAX_COLUMNS, slice_or_empty, slice_or_empty_mut};
use crate::model::Curve;
use crate::model::wire::{MAX_PARAMETERS, Matrix};
use crate::workspace::scratch_len;
pub use coordinates::Coordinates;
pub(crate) use diffuse::{ridge_rows, weight};
use neighbours::Nearest;

/// How far from the samples that take part a query may be, in their spread (the root of their mean square distance from
/// their centroid): from farther they are one point, and the weights that reproduce quadratics grow with the square of
/// the ratio, and with them the rounding of the data.
pub(crate) const REACH: f32 = 10.0;

/// Rounding of the variance in single precision, in the square of sum |L_j|. The same in double precision, so that both
/// state the same error.
const VARIANCE_ROUNDING: f32 = 1e-6;

/// Weights L_j of at most `N` samples, and where these lie relative to the query.
#[derive(Clone, Debug)]
pub struct Weights<T, const N: usize> {
    count: usize,
    samples: [u16; N],
    /// The weights; while they are computed, first the squares of the samples' distances.
    values: [T; N],
    /// Number of parameters.
    dimensions: usize,
    /// Offsets from the query in the interpolation's coordinates, divided by the radius; zeros beyond the dimensions.
    offsets: [[T; MAX_PARAMETERS]; N],
    radius: T,
    /// Degree of the polynomials that the weights are sure to reproduce.
    degree: usize,
    /// Square of the deviation where the radius is 1.
    variance: T,
}

/// Which samples are looked for.
struct Search<'s, 'a, T> {
    dimensions: usize,
    /// Rows of coordinates, by rising last one, and of parameters.
    points: &'s Matrix<'a>,
    parameters: &'s Matrix<'a>,
    /// The query's coordinates, and what differences from it are multiplied by.
    query: [T; MAX_PARAMETERS],
    scales: [T; MAX_PARAMETERS],
    /// The border, and the query's side of it if it has one.
    border: Curve<'a>,
    side: Option<bool>,
}

fn value<T: Real>(bytes: &[u8; 4]) -> T {
    T::from_f32(f32::from_le_bytes(*bytes))
}

impl<T: Real> Search<'_, '_, T> {
    /// The way from the query to a point.
    #[inline(always)]
    fn offset(&self, point: &[[u8; 4]]) -> [T; MAX_PARAMETERS] {
        let difference = |d: usize, bytes| self.scales[d] * (value::<T>(bytes) - self.query[d]);
        match point {
            [a, b] => [difference(0, a), difference(1, b), T::ZERO, T::ZERO],
            _ => core::array::from_fn(|d| point.get(d).map_or(T::ZERO, |bytes| difference(d, bytes))),
        }
    }

    /// Whether the border lies between the query and a sample; `known` is the border at the a/l that was asked for
    /// last, for samples come in rows of equal a/l.
    fn apart(&self, sample: usize, known: &mut (T, Option<T>)) -> bool {
        let (numbers, _) = self.parameters.blob.data.as_chunks::<4>();
        let (Some(side), Some([first, second])) = (
            self.side,
            slice_or_empty(numbers, 2 * sample..2 * sample + 2).as_array(),
        ) else {
            return false;
        };
        let confinement = value(second);
        if confinement != known.0 {
            *known = (confinement, self.border.within(confinement));
        }
        known.1.is_some_and(|border| (value::<T>(first) < border) != side)
    }
}

impl<T: Real, const N: usize> Weights<T, N> {
    /// Numbers that the computation needs beside the weights: the monomials' columns and the kernel's matrix.
    pub const SCRATCH: usize = scratch_len(0, N);

    /// No weights.
    pub const EMPTY: Self = Self {
        count: 0,
        degree: 0,
        dimensions: 1,
        samples: [0; N],
        values: [T::ZERO; N],
        offsets: [[T::ZERO; MAX_PARAMETERS]; N],
        radius: T::ZERO,
        variance: T::ZERO,
    };

    /// Takes the `wanted` samples nearest to a query, in order of distance.
    #[inline(never)]
    fn find(&mut self, search: &Search<'_, '_, T>, left_out: Option<usize>, wanted: usize) {
        let dimensions = search.dimensions.max(1);
        let mut nearest = Nearest::<T, MAX_PARAMETERS, N>::new(wanted);
        let (numbers, _) = search.points.blob.data.as_chunks::<4>();
        let last = |values: &[T; MAX_PARAMETERS]| values.get(dimensions - 1).copied().unwrap_or(T::ONE);
        let (own, scale) = (last(&search.query), last(&search.scales));
        // The points come by rising last coordinate. From the query's on both ways, the nearer first, until all that
        // follow are farther in it than all that are kept.
        let [mut start, mut end] = [0, numbers.len() / dimensions];
        while start < end {
            let middle = (start + end) / 2;
            let before = numbers.get((middle + 1) * dimensions - 1).map(value) < Some(own);
            *(if before { &mut start } else { &mut end }) = if before { middle + 1 } else { middle };
        }
        let (below, above) = numbers.split_at_checked(start * dimensions).unwrap_or_default();
        let (mut below, mut above) = (below.rchunks_exact(dimensions), above.chunks_exact(dimensions));
        let along = |point: Option<&[[u8; 4]]>| {
            let last = point.and_then(<[_]>::last).map(value::<T>);
            let difference = last.map_or(T::from_f32(f32::INFINITY), |last| scale * (last - own));
            difference * difference
        };
        // The next point on either way, down and up, its distance in the last coordinate, and its number.
        let mut next = [below.next(), above.next()];
        let mut distances = next.map(along);
        let mut numbers = [start, start];
        let mut border = (T::ZERO, search.border.within(T::ZERO));
        loop {
            let [down, up] = distances;
            let (point, distance, number);
            if up <= down {
                (point, distance, number) = (next[1], up, numbers[1]);
                next[1] = above.next();
                distances[1] = along(next[1]);
                numbers[1] += 1;
            } else {
                numbers[0] = numbers[0].wrapping_sub(1);
                (point, distance, number) = (next[0], down, numbers[0]);
                next[0] = below.next();
                distances[0] = along(next[0]);
            }
            let (true, Some(point)) = (distance < nearest.limit(), point) else {
                break;
            };
            let offset = search.offset(point);
            let square = square(offset);
            if square < nearest.limit() && Some(number) != left_out && !search.apart(number, &mut border) {
                nearest.offer(number, square, offset);
            }
        }
        self.dimensions = dimensions;
        self.count = nearest.count();
        let places = self.samples.iter_mut().zip(&mut self.values).zip(&mut self.offsets);
        for (((sample, square), place), (neighbour, offset)) in places.zip(nearest.iter()) {
            (*sample, *square, *place) = (neighbour.number, neighbour.square, *offset);
        }
    }

    /// Distance of the `rank`-th nearest sample, counted from 1.
    fn distance(&self, rank: usize) -> T {
        rank.checked_sub(1)
            .and_then(|j| self.values.get(j))
            .map_or(T::ZERO, |square| square.sqrt())
    }

    /// Divides the offsets by a radius, after a check that the query is within reach of the samples.
    fn scale(&mut self, radius: T) -> Result<(), EvaluateError> {
        self.radius = radius;
        let scale = if radius > T::ZERO { T::ONE / radius } else { T::ZERO };
        let mut centroid = [T::ZERO; MAX_PARAMETERS];
        let share = T::ONE / T::from_index(self.count.max(1));
        let offsets = slice_or_empty_mut(&mut self.offsets, 0..self.count);
        for offset in &mut *offsets {
            for (x, mean) in offset.iter_mut().zip(&mut centroid) {
                *x *= scale;
                *mean += *x * share;
            }
        }
        let spread = offsets
            .iter()
            .fold(T::ZERO, |sum, offset| sum + square(minus(*offset, centroid)))
            * share;
        let limit = T::from_f32(REACH);
        if square(centroid) <= limit * limit * spread {
            return Ok(());
        }
        Err(EvaluateError::BeyondExtrapolation {
            distance: (square(centroid) / spread).sqrt().to_f32(),
            limit: REACH,
        })
    }

    /// The monomials up to degree two in the dimensions at the samples, one column each: 1, x, y, x^2, x y, y^2 for
    /// two. The other entries are zeros.
    fn monomials<'s>(&self, columns: &'s mut [[T; N]]) -> &'s mut [[T; N]] {
        let p = self.dimensions;
        let columns = slice_or_empty_mut(columns, 0..1 + p + ridge_rows(p));
        columns.as_flattened_mut().fill(T::ZERO);
        for (j, offset) in self.offsets.iter().enumerate().take(self.count) {
            let mut entries = columns.iter_mut().filter_map(|column| column.get_mut(j));
            let offset = slice_or_empty(offset, 0..p);
            entries.by_ref().take(1).for_each(|entry| *entry = T::ONE);
            // The entries come second: a zip takes from the first before it sees that the second has no more.
            for (x, entry) in offset.iter().zip(entries.by_ref()) {
                *entry = *x;
            }
            for (d, x) in offset.iter().enumerate() {
                for (y, entry) in slice_or_empty(offset, d..p).iter().zip(entries.by_ref()) {
                    *entry = *x * *y;
                }
            }
        }
        columns
    }

    /// Checks that the weights sum to 1 but for rounding, and takes the rounding away.
    fn normalise(&mut self) -> Result<(), EvaluateError> {
        let values = slice_or_empty_mut(&mut self.values, 0..self.count);
        let sum = values.iter().copied().sum::<T>();
        if (sum - T::ONE).abs() > T::EPSILON.sqrt() || !sum.is_finite() {
            return Err(EvaluateError::Weights { sum: sum.to_f32() });
        }
        for value in values {
            *value = *value / sum;
        }
        Ok(())
    }

    /// The samples that take part and their weights.
    pub fn iter(&self) -> impl Iterator<Item = (usize, T)> + '_ {
        let (samples, values) = self.parts();
        samples
            .iter()
            .zip(values)
            .map(|(&sample, &value)| (sample.into(), value))
    }

    /// The samples that take part, and their weights.
    pub(crate) fn parts(&self) -> (&[u16], &[T]) {
        (
            slice_or_empty(&self.samples, 0..self.count),
            slice_or_empty(&self.values, 0..self.count),
        )
    }

    /// sum |L_j|: how much noise in the data may grow.
    pub fn lebesgue(&self) -> T {
        self.iter().map(|(_, value)| value.abs()).sum()
    }

    /// Standard deviation of the interpolation error for data with a generalised covariance: -r^5 for weights that
    /// reproduce quadratics, r^3 for those that are sure to reproduce linear functions only. It is the power function
    /// of that kernel (Wendland, Scattered Data Approximation, 2005, chapter 11): 0 where the query is a sample that
    /// the weights return, and growing with the distance from the samples to the power 5/2 or 3/2.
    ///
    /// Far outside the samples the variance is a small difference of numbers as large as the squares of the weights,
    /// and may come out as anything, also negative: it counts as at least their rounding.
    pub fn deviation(&self) -> T {
        let lebesgue = self.lebesgue();
        let rounding = T::from_f32(VARIANCE_ROUNDING) * (lebesgue * lebesgue - T::ONE);
        let powers = 2 * self.degree + 1;
        (0..powers)
            .fold(self.variance.max(rounding).max(T::ZERO), |square, _| {
                square * self.radius
            })
            .sqrt()
    }

    /// How far the nearest sample is, in the coordinates of the interpolation.
    pub fn nearest(&self) -> T {
        let offset = self.offsets.first().filter(|_| self.count > 0);
        offset.map_or(T::ZERO, |offset| square(*offset).sqrt() * self.radius)
    }

    /// L^T S L - 2 L^T s with the covariances S of the samples and s of these with the query.
    fn quadratic_form(&self) -> T {
        let two = T::from_f32(2.0);
        let mut sum = T::ZERO;
        let offsets = slice_or_empty(&self.offsets, 0..self.count);
        for (i, (value, offset)) in self.values.iter().zip(offsets).enumerate() {
            let mut row = -covariance(self.degree, square(*offset));
            for (other, place) in self.values.iter().zip(slice_or_empty(offsets, 0..i)) {
                row += *other * covariance(self.degree, square(minus(*offset, *place)));
            }
            sum += two * *value * row;
        }
        sum
    }
}

/// Room for the columns of monomials and for the kernel's matrix.
struct Storage<'s, T, const N: usize> {
    columns: &'s mut [[T; N]],
    matrix: &'s mut [[T; N]],
}

impl<'s, T: Real, const N: usize> Storage<'s, T, N> {
    fn new(scratch: &'s mut [T]) -> Result<Self, EvaluateError> {
        let (required, found) = (Weights::<T, N>::SCRATCH, scratch.len());
        let (rows, _) = scratch.as_chunks_mut::<N>();
        match rows.split_at_mut_checked(MAX_COLUMNS) {
            Some((columns, matrix)) if matrix.len() >= N => Ok(Self { columns, matrix }),
            _ => Err(EvaluateError::BufferTooShort { required, found }),
        }
    }
}

/// Polyharmonic kernel of the square of a distance that is positive definite, in any dimension, on weights that
/// annihilate polynomials of a degree: -r, r^3, -r^5 (Wendland 2005, theorem 8.16).
fn covariance<T: Real>(degree: usize, square: T) -> T {
    (0..degree).fold(-square.sqrt(), |value, _| -(value * square))
}

/// Square of the length of a vector of parameters. Written out as the next two: optimised for size, it would be a loop.
fn square<T: Real>([a, b, c, d]: [T; MAX_PARAMETERS]) -> T {
    (a * a + b * b) + (c * c + d * d)
}

/// a - b.
fn minus<T: Real>(a: [T; MAX_PARAMETERS], b: [T; MAX_PARAMETERS]) -> [T; MAX_PARAMETERS] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// The products of two vectors' entries.
fn times<T: Real>(a: [T; MAX_PARAMETERS], b: [T; MAX_PARAMETERS]) -> [T; MAX_PARAMETERS] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameters;
    use crate::model::Curve;
    use crate::model::wire::{Blob, Kernel, Paper, Samples};

    const N: usize = 32;
    const KERNEL: Kernel = Kernel {
        neighbours: 24,
        scales: [2.25, 1.0, 1.0, 1.0],
    };
    const PAPER: Paper = Paper {
        neighbours: 12,
        scales: [1.9, 1.0, 1.0, 1.0],
        radius: 1.2,
        displacement_rank: 10,
        velocity_rank: 10,
        window: 2.0,
    };

    /// A steady limit, linear in a/l.
    fn limit(confinement: f64) -> f64 {
        0.3 - 0.2 * confinement
    }

    /// The bytes of rows of two numbers: points (a/l, Ca) of a curve or samples (Ca, a/l).
    fn bytes<const R: usize>(rows: [[f32; 2]; R]) -> [[[u8; 4]; 2]; R] {
        rows.map(|row| row.map(f32::to_le_bytes))
    }

    fn matrix<const R: usize>(bytes: &[[[u8; 4]; 2]; R]) -> Matrix<'_> {
        Matrix::f32(R as u32, 2, bytes.as_flattened().as_flattened())
    }

    /// Sample of a grid of 20 columns.
    fn grid(sample: usize) -> [f32; 2] {
        let [column, row] = [sample % 20, sample / 20].map(|i| i as f64);
        [(0.01 + 0.01 * column) as f32, (0.75 + 0.05 * row) as f32]
    }

    /// The coordinates of the channel, with the limit.
    fn channel<'a>(limit: &Matrix<'a>, border: &Matrix<'a>) -> Coordinates<'a> {
        Coordinates {
            scales: KERNEL.scales,
            limit: Some(Curve::new(limit)),
            border: Curve::new(border),
        }
    }

    /// The places of samples.
    fn places<const R: usize>(coordinates: &Coordinates<'_>, samples: [[f32; 2]; R]) -> [[[u8; 4]; 2]; R] {
        bytes(samples.map(|sample| {
            let [x, y, ..] = coordinates.place(&Parameters::from(sample));
            [x, y]
        }))
    }

    fn weights<T: Real>(kernel: bool, rows: usize, query: [f64; 2], left_out: Option<usize>) -> Weights<T, N> {
        weights_beside(&Matrix::f32(0, 2, &[]), kernel, rows, query, left_out)
    }

    /// The same in a plane that is cut.
    fn weights_beside<T: Real>(
        border: &Matrix<'_>,
        kernel: bool,
        rows: usize,
        query: [f64; 2],
        left_out: Option<usize>,
    ) -> Weights<T, N> {
        let limit = bytes([[0.5, 0.2], [1.25, 0.05]]);
        let coordinates = channel(&matrix(&limit), border);
        let query = Parameters::from(query.map(T::from_f64));
        let grid: [_; 200] = core::array::from_fn(grid);
        let (places, grid) = (places(&coordinates, grid), bytes(grid));
        let part = |bytes| Matrix {
            rows: 20 * rows as u32,
            blob: Blob::new(&matrix(bytes).blob.data[..8 * 20 * rows]),
            ..matrix(bytes)
        };
        let samples = Samples {
            parameters: part(&grid),
            places: part(&places),
        };
        let (mut weights, mut scratch) = (Weights::EMPTY, [T::ZERO; 64 * 64]);
        let done = if kernel {
            weights.kernel(&KERNEL, &coordinates, &samples, &query, left_out, &mut scratch)
        } else {
            weights.diffuse(&PAPER, &coordinates, &samples, &query, left_out, &mut scratch)
        };
        done.unwrap();
        weights
    }

    /// sum_j L_j f(theta_j).
    fn interpolate<T: Real>(weights: &Weights<T, N>, f: impl Fn([f64; 2]) -> f64) -> f64 {
        let value = |sample| f(grid(sample).map(f64::from));
        weights
            .iter()
            .map(|(sample, weight)| weight.to_f64() * value(sample))
            .sum()
    }

    /// sum_j L_j f(x_j) with the coordinates x_j as they are stored, in singles.
    fn interpolate_places<T: Real>(weights: &Weights<T, N>, f: impl Fn([f64; 2]) -> f64) -> f64 {
        let limit = bytes([[0.5, 0.2], [1.25, 0.05]]);
        let none = Matrix::f32(0, 2, &[]);
        let places = places(
            &channel(&matrix(&limit), &none),
            core::array::from_fn::<_, 200, _>(grid),
        );
        let value = |sample: usize| f(places[sample].map(|bytes| f32::from_le_bytes(bytes).into()));
        weights
            .iter()
            .map(|(sample, weight)| weight.to_f64() * value(sample))
            .sum()
    }

    /// The coordinates of the channel, with the steady limit as it is stored.
    fn place([ca, confinement]: [f64; 2]) -> [f64; 2] {
        let stored = bytes([[0.5, 0.2], [1.25, 0.05]]);
        let none = Matrix::f32(0, 2, &[]);
        let [x, y, ..] = channel(&matrix(&stored), &none).place(&Parameters::from([ca, confinement]));
        let stretched = ca / limit(confinement).sqrt().sqrt();
        assert!((x - KERNEL.scales[0] * stretched.sqrt()).abs() < 1e-7 && y == KERNEL.scales[1] * confinement);
        [x, y]
    }

    const QUERIES: [[f64; 2]; 5] = [[0.105, 0.925], [0.012, 0.751], [0.2, 1.2], [0.111, 1.013], [0.03, 0.95]];

    #[test]
    fn both_reproduce_quadratics_in_their_coordinates() {
        for query in QUERIES {
            let root = |[x, y]: [f64; 2]| 1.0 + 3.0 * x - 2.0 * y + 0.5 * x * x - 4.0 * x * y + y * y;
            let found = interpolate_places(&weights::<f64>(true, 10, query, None), root);
            assert!((found - root(place(query))).abs() < 1e-12, "{query:?}");
            let found = interpolate_places(&weights::<f32>(true, 10, query, None), root);
            assert!((found - root(place(query))).abs() < 5e-6, "{query:?} {found}");
            // Five rows of a/l are within reach at the finer spacing of the first query only.
            let plain = |[x, y]: [f64; 2]| 1.0 + 3.0 * x - 2.0 * y + 50.0 * x * x - 4.0 * x * y;
            let found = interpolate(&weights::<f64>(false, 10, query, None), plain);
            assert!((found - plain(query)).abs() < 1e-5, "{query:?} {found}");
            let found = interpolate(&weights::<f32>(false, 10, query, None), plain);
            assert!((found - plain(query)).abs() < 2e-5, "{query:?} {found}");
        }
    }

    #[test]
    fn weights_sum_to_one_and_stay_moderate() {
        for query in QUERIES {
            for kernel in [true, false] {
                let weights = weights::<f32>(kernel, 10, query, None);
                let sum: f32 = weights.iter().map(|(_, weight)| weight).sum();
                assert!(
                    (sum - 1.0).abs() < 1e-6 && weights.lebesgue() < 4.0,
                    "{query:?} {}",
                    weights.lebesgue()
                );
            }
        }
    }

    #[test]
    fn rounding_is_taken_out_of_the_sum_of_weights_and_more_than_rounding_is_refused() {
        fn normalised<T: Real>(values: [f64; 3]) -> Result<f64, EvaluateError> {
            let mut weights = Weights::<T, N>::EMPTY;
            weights.count = 3;
            // Beyond the count lies what belongs to another query.
            weights.values = [T::ONE; N];
            weights.values[..3].copy_from_slice(&values.map(T::from_f64));
            weights.normalise()?;
            // The ratios stay.
            assert!((weights.values[1].to_f64() / weights.values[0].to_f64() - values[1] / values[0]).abs() < 1e-6);
            Ok(weights.iter().map(|(_, weight)| weight.to_f64()).sum())
        }
        for scale in [1.0 - 2e-4, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.0 + 2e-4] {
            let sum = normalised::<f32>([0.6 * scale, -0.3 * scale, 0.7 * scale]).unwrap();
            assert!((sum - 1.0).abs() < 2e-7, "{scale}: {sum}");
        }
        let sum = normalised::<f64>([0.6 + 1e-9, -0.3, 0.7]).unwrap();
        assert!((sum - 1.0).abs() < 4e-16, "{sum}");
        for far in [0.999, 1.001, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let refused = normalised::<f32>([0.6 * far, -0.3, 0.7]);
            assert!(
                matches!(refused, Err(EvaluateError::Weights { .. })),
                "{far}: {refused:?}"
            );
        }
        let Err(EvaluateError::Weights { sum }) = normalised::<f64>([0.6, 0.3, 0.7]) else {
            panic!("weights that sum to 1.6 were taken");
        };
        assert!((sum - 1.6).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn the_kernel_returns_the_sample_itself_but_for_the_scatter() {
        let weights = weights::<f64>(true, 10, [0.03, 0.8], None);
        for (sample, weight) in weights.iter() {
            assert!(
                (weight - if sample == 22 { 1.0 } else { 0.0 }).abs() < 0.05,
                "{sample} {weight}"
            );
        }
        let without = self::weights::<f64>(true, 10, [0.03, 0.8], Some(22));
        assert!(
            weights.deviation() < 0.1 * without.deviation(),
            "{} {}",
            weights.deviation(),
            without.deviation()
        );
    }

    #[test]
    fn samples_close_to_each_other_do_no_harm_in_single_precision() {
        // As beside the steady limit: a grid, and every sample a second and third time a little beside it.
        fn dense(sample: usize) -> [f32; 2] {
            let [ca, confinement] = grid(sample / 3);
            [ca + [0.0, 0.00125, 0.0025][sample % 3], confinement]
        }
        fn weights<T: Real>(query: [f64; 2]) -> Weights<T, N> {
            let limit = bytes([[0.5, 0.2], [1.25, 0.05]]);
            let coordinates = channel(&matrix(&limit), &Matrix::f32(0, 2, &[]));
            let samples: [_; 600] = core::array::from_fn(dense);
            let (places, samples) = (places(&coordinates, samples), bytes(samples));
            let samples = Samples {
                parameters: matrix(&samples),
                places: matrix(&places),
            };
            let query = Parameters::from(query.map(T::from_f64));
            let (mut weights, mut scratch) = (Weights::EMPTY, [T::ZERO; 64 * 64]);
            let done = weights.kernel(&KERNEL, &coordinates, &samples, &query, None, &mut scratch);
            done.unwrap();
            weights
        }
        let f = |[ca, a]: [f64; 2]| (30.0 * ca).sin() * (2.0 * a).exp();
        let sum = |weights: &mut dyn Iterator<Item = (usize, f64)>| -> f64 {
            weights.map(|(j, weight)| weight * f(dense(j).map(f64::from))).sum()
        };
        for query in [[0.105, 0.925], [0.1512, 0.81], [0.062, 1.02], [0.0905, 0.88]] {
            let single = weights::<f32>(query);
            let double = weights::<f64>(query);
            let found = [
                sum(&mut single.iter().map(|(j, weight)| (j, f64::from(weight)))),
                sum(&mut double.iter()),
            ];
            assert!(
                (found[0] - found[1]).abs() < 1e-3 && (found[1] - f(query)).abs() < 0.02,
                "{query:?} {found:?} {}",
                f(query)
            );
        }
    }

    #[test]
    fn the_deviation_that_falls_out_of_the_solution_is_the_quadratic_form() {
        for query in QUERIES {
            let weights = weights::<f64>(true, 10, query, None);
            let form = weights.quadratic_form();
            assert!((weights.variance - form).abs() < 1e-9, "{} {form}", weights.variance);
            let single = self::weights::<f32>(true, 10, query, None);
            assert!(
                (f64::from(single.variance) - form).abs() < 1e-5,
                "{} {form}",
                single.variance
            );
        }
    }

    #[test]
    fn a_sample_left_out_takes_no_part() {
        for kernel in [true, false] {
            let weights = weights::<f64>(kernel, 10, [0.03, 0.8], Some(22));
            assert!(weights.iter().all(|(sample, _)| sample != 22));
            assert!(weights.deviation() > 0.0);
        }
    }

    #[test]
    fn weights_do_not_cross_the_border() {
        let bytes = bytes([[0.7, 0.035], [1.0, 0.035]]);
        let border = matrix(&bytes);
        let place = grid;
        for kernel in [true, false] {
            for (query, below) in [([0.033, 0.92], true), ([0.037, 0.92], false)] {
                let weights = weights_beside::<f64>(&border, kernel, 10, query, None);
                for (sample, _) in weights.iter() {
                    let [ca, confinement] = place(sample);
                    assert!((ca < 0.035) == below || confinement > 1.0, "{ca} {confinement}");
                }
            }
            // Beyond its ends it parts nothing.
            let beyond = weights_beside::<f64>(&border, kernel, 10, [0.035, 1.03], None);
            let both = [true, false].map(|below| beyond.iter().any(|(j, _)| (place(j)[0] < 0.035) == below));
            assert_eq!(both, [true, true]);
        }
    }

    #[test]
    fn beyond_a_border_with_few_samples_on_its_side_the_kernel_reproduces_a_jump() {
        // Four columns of four rows lie below the border: fewer than the 24 that are wanted.
        let bytes = bytes([[0.7, 0.045], [0.93, 0.045]]);
        let border = matrix(&bytes);
        for query in [[0.013, 0.76], [0.04, 0.83], [0.043, 0.9]] {
            let value = |[x, y]: [f64; 2]| {
                let [border, _] = place([0.045, y]);
                let jump = if x < border { 3.0 } else { 0.0 };
                jump + 3.0 * x - 2.0 * y + 0.5 * x * x - 4.0 * x * y + y * y
            };
            let weights = weights_beside::<f64>(&border, true, 4, query, None);
            assert!(
                weights
                    .iter()
                    .any(|(sample, weight)| grid(sample)[0] > 0.045 && weight.abs() > 1e-3)
            );
            let expected = value(place(query));
            assert!(
                (interpolate_places(&weights, value) - expected).abs() < 1e-12,
                "{query:?}"
            );
            let single = weights_beside::<f32>(&border, true, 4, query, None);
            assert!(
                (interpolate_places(&single, value) - expected).abs() < 1e-5,
                "{query:?}"
            );
            assert!((weights.variance - weights.quadratic_form()).abs() < 1e-9);
        }
    }

    #[test]
    fn too_few_rows_for_the_tail_still_answer() {
        for kernel in [true, false] {
            for rows in [1, 2] {
                let weights = weights::<f32>(kernel, rows, [0.105, 0.775], None);
                let found = interpolate(&weights, |[ca, _]| ca);
                assert!((found - 0.105).abs() < 1e-3, "{rows} {found}");
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "eight thousand queries")]
    fn the_weights_follow_the_query_without_a_jump() {
        // Along lines through the plane, on which samples come and go.
        for [from, to] in [[[0.012, 0.76], [0.17, 1.17]], [[0.19, 0.78], [0.02, 1.19]]] {
            const STEPS: usize = 4000;
            let mut before: Option<[f64; 200]> = None;
            let mut greatest = 0.0_f64;
            for step in 0..=STEPS {
                let share = step as f64 / STEPS as f64;
                let query = [0, 1].map(|d| from[d] + share * (to[d] - from[d]));
                let mut all = [0.0; 200];
                for (sample, weight) in weights::<f64>(true, 10, query, None).iter() {
                    all[sample] = weight;
                }
                if let Some(before) = before.replace(all) {
                    let change: f64 = before.iter().zip(&all).map(|(a, b)| (a - b).abs()).sum();
                    greatest = greatest.max(change);
                }
            }
            // 1.1 if all samples counted alike.
            assert!(greatest < 0.15, "{greatest}");
        }
    }

    #[test]
    fn the_kernel_agrees_with_the_full_saddle_system() {
        // The same weights from [Phi P; P^T 0] [L; mu] = [phi; p] by Gaussian elimination with pivoting.
        let query = [0.105, 0.925];
        let weights = weights::<f64>(true, 10, query, None);
        let (n, offsets) = (weights.count, weights.offsets);
        const MONOMIALS: usize = 6;
        const SIZE: usize = 30;
        assert_eq!(n + MONOMIALS, SIZE);
        let mut columns = [[0.0; N]; MONOMIALS];
        weights.monomials(&mut columns);
        let mut system = [[0.0; SIZE + 1]; SIZE];
        for i in 0..n {
            for j in 0..n {
                system[i][j] = covariance(2, square(minus(offsets[i], offsets[j])));
            }
            // Scatter, and what grows from 0.6 to 1 of the greatest squared distance.
            let far = (square(offsets[i]) - f64::from(0.6_f32)).max(0.0) / f64::from(1.0 - 0.6_f32);
            system[i][i] += f64::from(3e-5_f32) + 3.0 * far.powi(3);
            for k in 0..MONOMIALS {
                (system[i][n + k], system[n + k][i]) = (columns[k][i], columns[k][i]);
            }
            system[i][SIZE] = covariance(2, square(offsets[i]));
        }
        system[n][SIZE] = 1.0;
        for k in 0..SIZE {
            let pivot = (k..SIZE)
                .max_by(|&a, &b| system[a][k].abs().total_cmp(&system[b][k].abs()))
                .unwrap();
            system.swap(k, pivot);
            for i in (0..SIZE).filter(|&i| i != k) {
                let factor = system[i][k] / system[k][k];
                for j in k..=SIZE {
                    system[i][j] -= factor * system[k][j];
                }
            }
        }
        for (j, (_, weight)) in weights.iter().enumerate() {
            assert!((weight - system[j][SIZE] / system[j][j]).abs() < 1e-9);
        }
    }

    #[test]
    fn diffuse_weights_agree_with_the_normal_equations() {
        // L = W P (P^T W P)^-1 p of eq. (30), where the samples determine all monomials.
        let query = [0.1075, 0.95];
        let weights = weights::<f64>(false, 10, query, None);
        const MONOMIALS: usize = 6;
        let mut columns = [[0.0; N]; MONOMIALS];
        weights.monomials(&mut columns);
        let w: [f64; N] = core::array::from_fn(|j| weight(square(weights.offsets[j]).sqrt()));
        let mut system = [[0.0; MONOMIALS + 1]; MONOMIALS];
        for a in 0..MONOMIALS {
            for b in 0..MONOMIALS {
                system[a][b] = (0..weights.count).map(|j| w[j] * columns[a][j] * columns[b][j]).sum();
            }
        }
        system[0][MONOMIALS] = 1.0;
        for k in 0..MONOMIALS {
            for i in (0..MONOMIALS).filter(|&i| i != k) {
                let factor = system[i][k] / system[k][k];
                for j in k..=MONOMIALS {
                    system[i][j] -= factor * system[k][j];
                }
            }
        }
        for (j, (_, found)) in weights.iter().enumerate() {
            let exact: f64 = (0..MONOMIALS)
                .map(|k| w[j] * columns[k][j] * system[k][MONOMIALS] / system[k][k])
                .sum();
            assert!((found - exact).abs() < 1e-4, "{found} {exact}");
        }
    }
}
