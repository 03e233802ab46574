//! Sums of Stokeslets, `v(x) = sum_j J(x - y_j) f_j` with `J(d) = I / |d| + d d^T / |d|^3`: where nearly all the time
//! of the full-order model is spent.
//!
//! The loops run over plain slices in lanes that fill one AVX-512 register, so that the compiler turns them into
//! vector instructions; which set (AVX-512, AVX2 with FMA, or the baseline) is chosen at run time. They exist in
//! single precision too, for sources that are well away from the target: twice the lanes and a shorter reciprocal root.
//! Parts of such a sum are added up in double precision.

use multiversion::multiversion;
use multiversion::target::match_target;

use super::real::{Real, fused, total};

/// Point forces, one slice a component: positions `(x, y, z)` and strengths `(fx, fy, fz)`.
#[derive(Debug, Clone, Default)]
pub struct Sources<S = f64> {
    /// x, y, z, fx, fy, fz.
    components: [Vec<S>; 6],
}

impl<S: Real> Sources<S> {
    /// An empty set with room for `capacity` sources.
    pub fn with_capacity(capacity: usize) -> Self {
        Self {
            components: std::array::from_fn(|_| Vec::with_capacity(capacity)),
        }
    }

    /// Adds a source at `position` with `strength`.
    pub fn push(&mut self, position: [f64; 3], strength: [f64; 3]) {
        for (component, value) in self.components.iter_mut().zip(position.into_iter().chain(strength)) {
            component.push(S::from_f64(value));
        }
    }

    /// Copies in another precision.
    pub fn rounded<T: Real>(&self) -> Sources<T> {
        Sources {
            components: self
                .components
                .each_ref()
                .map(|component| component.iter().map(|&value| T::from_f64(value.into())).collect()),
        }
    }

    /// Adds copies of other sources, rounded.
    pub fn append(&mut self, sources: SourceSlice<'_, f64>) {
        for (component, values) in self.components.iter_mut().zip(sources.components) {
            component.extend(values.iter().map(|&value| S::from_f64(value)));
        }
    }

    /// Their number.
    pub fn len(&self) -> usize {
        self.components[0].len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all sources, but keeps their room.
    pub fn clear(&mut self) {
        self.components.iter_mut().for_each(Vec::clear);
    }

    /// Adds `count` sources of no strength at the origin; returns the six components of the new ones, to be filled in.
    pub fn extend(&mut self, count: usize) -> [&mut [S]; 6] {
        let start = self.len();
        for component in &mut self.components {
            component.resize(start + count, S::default());
        }
        let [x, y, z, fx, fy, fz] = &mut self.components;
        [
            &mut x[start..],
            &mut y[start..],
            &mut z[start..],
            &mut fx[start..],
            &mut fy[start..],
            &mut fz[start..],
        ]
    }

    /// The strength of source `j`.
    pub fn strength(&self, j: usize) -> [f64; 3] {
        [3, 4, 5].map(|c| self.components[c][j].into())
    }

    /// All of them.
    pub fn all(&self) -> SourceSlice<'_, S> {
        self.range(0, self.len())
    }

    /// The `count` sources from `start` on.
    pub fn range(&self, start: usize, count: usize) -> SourceSlice<'_, S> {
        let [x, y, z, fx, fy, fz] = &self.components;
        let end = start + count;
        SourceSlice {
            components: [
                &x[start..end],
                &y[start..end],
                &z[start..end],
                &fx[start..end],
                &fy[start..end],
                &fz[start..end],
            ],
        }
    }
}

/// A part of some [`Sources`]; all slices have the same length.
#[derive(Debug, Clone, Copy)]
pub struct SourceSlice<'a, S = f64> {
    components: [&'a [S]; 6],
}

/// The Stokeslet tensor `J(d)`, as its components xx, yy, zz, xy, xz, yz.
pub fn stokeslet([dx, dy, dz]: [f64; 3]) -> [f64; 6] {
    let inverse = 1.0 / (dx * dx + dy * dy + dz * dz).sqrt();
    let cube = inverse * inverse * inverse;
    [
        inverse + dx * dx * cube,
        inverse + dy * dy * cube,
        inverse + dz * dz * cube,
        dx * dy * cube,
        dx * dz * cube,
        dy * dz * cube,
    ]
}

/// `J(target - y_j) f_j` summed over the sources; one exactly at the target is left out.
pub fn sum(sources: SourceSlice<'_>, target: [f64; 3]) -> [f64; 3] {
    let mut out = [[0.0; 3]];
    add_sums(sources, &[target], &mut out);
    out[0]
}

/// Adds `sum_j J(target - y_j) f_j` to `out`, for each target, in the precision of the sources.
pub fn add_sums<S: StokesletSums>(sources: SourceSlice<'_, S>, targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    S::add_sums(sources.components, targets, out);
}

/// Numbers that the sums can be taken in.
pub trait StokesletSums: Real {
    /// [`add_sums`] for the six components of the sources.
    fn add_sums(sources: [&[Self]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]);
}

impl StokesletSums for f64 {
    fn add_sums(sources: [&[Self]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
        // The sums over the lanes take longer than a few sources.
        if targets.len() >= LANES / 2 && sources[0].len() <= 4 * LANES {
            few_sources(sources, targets, out);
        } else {
            double(sources, targets, out);
        }
    }
}

impl StokesletSums for f32 {
    fn add_sums(sources: [&[Self]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
        single(sources, targets, out);
    }
}

// Without the instruction, a fused multiply-add is a slow library call.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn double(sources: [&[f64]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    match_target! {
        "x86_64+fma" => tiles::<f64, true, LANES>(sources, targets, out),
        _ => tiles::<f64, false, LANES>(sources, targets, out),
    }
}

/// Adds the velocity of a few sources to many targets, in double precision: here the lanes are targets.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn few_sources(sources: [&[f64]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    match_target! {
        "x86_64+fma" => transposed_tiles::<true>(sources, targets, out),
        _ => transposed_tiles::<false>(sources, targets, out),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn single(sources: [&[f32]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    match_target! {
        "x86_64+fma" => tiles::<f32, true, { 2 * LANES }>(sources, targets, out),
        _ => tiles::<f32, false, { 2 * LANES }>(sources, targets, out),
    }
}

/// Doubles in one AVX-512 register. Lists of a multiple of this length (twice this in single precision) are summed
/// fastest.
pub const LANES: usize = 8;
/// Targets handled together: a source is loaded once for all of them, and their sums fit into the registers.
const TARGETS: usize = 2;
/// Sources whose sum is taken in their own precision before it is added in double precision.
const PART: usize = 1024;

/// All targets with all sources, `L` of them in a register.
#[inline(always)]
fn tiles<S: Real, const FMA: bool, const L: usize>(sources: [&[S]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    let [x, y, z, fx, fy, fz] = sources;
    let positions = x.chunks(PART).zip(y.chunks(PART)).zip(z.chunks(PART));
    let strengths = fx.chunks(PART).zip(fy.chunks(PART)).zip(fz.chunks(PART));
    for (((x, y), z), ((fx, fy), fz)) in positions.zip(strengths) {
        let part = [x, y, z, fx, fy, fz];
        let (tiles, rest) = targets.as_chunks();
        let (tile_values, rest_values) = out.as_chunks_mut();
        for (targets, values) in tiles.iter().zip(tile_values) {
            tile::<S, FMA, TARGETS, L>(part, targets, values);
        }
        for (&target, value) in rest.iter().zip(rest_values) {
            tile::<S, FMA, 1, L>(part, &[target], std::array::from_mut(value));
        }
    }
}

#[inline(always)]
fn tile<S: Real, const FMA: bool, const T: usize, const L: usize>(
    sources: [&[S]; 6],
    targets: &[[f64; 3]; T],
    out: &mut [[f64; 3]; T],
) {
    let mut x = [[S::default(); 3]; T];
    for t in 0..T {
        for d in 0..3 {
            x[t][d] = S::from_f64(targets[t][d]);
        }
    }
    let mut sums = [[[S::default(); L]; 3]; T];
    let (y0, y0_rest) = sources[0].as_chunks();
    let (y1, y1_rest) = sources[1].as_chunks();
    let (y2, y2_rest) = sources[2].as_chunks();
    let (f0, f0_rest) = sources[3].as_chunks();
    let (f1, f1_rest) = sources[4].as_chunks();
    let (f2, f2_rest) = sources[5].as_chunks();
    let positions = y0.iter().zip(y1).zip(y2);
    let strengths = f0.iter().zip(f1).zip(f2);
    for (((&y0, &y1), &y2), ((&f0, &f1), &f2)) in positions.zip(strengths) {
        for t in 0..T {
            interact::<S, FMA, L>(&x[t], &[y0, y1, y2], &[f0, f1, f2], &mut sums[t]);
        }
    }
    if !y0_rest.is_empty() {
        // The rest is filled up with sources of no strength, away from the targets.
        let far = S::from_f64(1e9);
        let y = [filled(y0_rest, far), filled(y1_rest, far), filled(y2_rest, far)];
        let none = S::default();
        let f = [filled(f0_rest, none), filled(f1_rest, none), filled(f2_rest, none)];
        for t in 0..T {
            interact::<S, FMA, L>(&x[t], &y, &f, &mut sums[t]);
        }
    }
    for t in 0..T {
        for d in 0..3 {
            out[t][d] += total(&sums[t][d]);
        }
    }
}

#[inline(always)]
fn transposed_tiles<const FMA: bool>(sources: [&[f64]; 6], targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    for (targets, out) in targets.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let mut x = [[1e9; LANES]; 3];
        for (l, target) in targets.iter().enumerate() {
            for d in 0..3 {
                x[d][l] = target[d];
            }
        }
        let sums = transposed_tile::<FMA>(sources, &x);
        for (l, value) in out.iter_mut().enumerate() {
            for d in 0..3 {
                value[d] += sums[d][l];
            }
        }
    }
}

/// The sums at a register of targets.
#[inline(always)]
fn transposed_tile<const FMA: bool>(sources: [&[f64]; 6], x: &[[f64; LANES]; 3]) -> [[f64; LANES]; 3] {
    let mut sums = [[0.0; LANES]; 3];
    let count = sources[0].len();
    let [sx, sy, sz, fx, fy, fz] = sources;
    let (sx, sy, sz) = (&sx[..count], &sy[..count], &sz[..count]);
    let (fx, fy, fz) = (&fx[..count], &fy[..count], &fz[..count]);
    for j in 0..count {
        let y = [[sx[j]; LANES], [sy[j]; LANES], [sz[j]; LANES]];
        let f = [[fx[j]; LANES], [fy[j]; LANES], [fz[j]; LANES]];
        for l in 0..LANES {
            let [vx, vy, vz] = pair::<f64, FMA>(
                [x[0][l], x[1][l], x[2][l]],
                [y[0][l], y[1][l], y[2][l]],
                [f[0][l], f[1][l], f[2][l]],
                [sums[0][l], sums[1][l], sums[2][l]],
            );
            sums[0][l] = vx;
            sums[1][l] = vy;
            sums[2][l] = vz;
        }
    }
    sums
}

#[inline(always)]
fn filled<S: Real, const L: usize>(rest: &[S], filling: S) -> [S; L] {
    let mut lanes = [filling; L];
    lanes.iter_mut().zip(rest).for_each(|(lane, value)| *lane = *value);
    lanes
}

/// Adds the Stokeslets of one register of sources at one target.
#[inline(always)]
fn interact<S: Real, const FMA: bool, const L: usize>(
    target: &[S; 3],
    y: &[[S; L]; 3],
    f: &[[S; L]; 3],
    sums: &mut [[S; L]; 3],
) {
    for l in 0..L {
        let [vx, vy, vz] = pair::<S, FMA>(
            *target,
            [y[0][l], y[1][l], y[2][l]],
            [f[0][l], f[1][l], f[2][l]],
            [sums[0][l], sums[1][l], sums[2][l]],
        );
        sums[0][l] = vx;
        sums[1][l] = vy;
        sums[2][l] = vz;
    }
}

/// `sum + J(x - y) f`.
#[inline(always)]
fn pair<S: Real, const FMA: bool>(x: [S; 3], y: [S; 3], f: [S; 3], sum: [S; 3]) -> [S; 3] {
    let dx = x[0] - y[0];
    let dy = x[1] - y[1];
    let dz = x[2] - y[2];
    let square = fused::<S, FMA>(dx, dx, fused::<S, FMA>(dy, dy, dz * dz));
    let inverse = S::reciprocal_root::<FMA>(square);
    let dot = fused::<S, FMA>(dx, f[0], fused::<S, FMA>(dy, f[1], dz * f[2]));
    let along = dot * (inverse * inverse);
    [
        fused::<S, FMA>(inverse, fused::<S, FMA>(along, dx, f[0]), sum[0]),
        fused::<S, FMA>(inverse, fused::<S, FMA>(along, dy, f[1]), sum[1]),
        fused::<S, FMA>(inverse, fused::<S, FMA>(along, dz, f[2]), sum[2]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number in [-1, 1) that looks random.
    fn noise(i: usize) -> f64 {
        ((i * 7919 + 104_729) as f64 * 0.618_033_988_749_894_8).fract() * 2.0 - 1.0
    }

    fn point(i: usize) -> [f64; 3] {
        [noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)]
    }

    /// Largest error of the sums over `count` sources, relative to the sum of absolute values.
    fn error<S: StokesletSums>(count: usize) -> f64 {
        let mut sources = Sources::<S>::default();
        for j in 0..count {
            sources.push(point(j), point(1000 + j));
        }
        let targets: Vec<_> = (0..7).map(|i| point(5000 + i).map(|c| 2.0 * c)).collect();
        let mut out = vec![[1.0; 3]; targets.len()];
        add_sums(sources.all(), &targets, &mut out);
        let mut error = 0.0_f64;
        for (target, value) in targets.iter().zip(&out) {
            let mut expected = [1.0; 3];
            let mut scale = 1.0;
            for j in 0..count {
                let y = point(j);
                let f = point(1000 + j);
                let [xx, yy, zz, xy, xz, yz] = stokeslet([0, 1, 2].map(|d| target[d] - y[d]));
                expected[0] += xx * f[0] + xy * f[1] + xz * f[2];
                expected[1] += xy * f[0] + yy * f[1] + yz * f[2];
                expected[2] += xz * f[0] + yz * f[1] + zz * f[2];
                scale += xx + yy + zz;
            }
            for d in 0..3 {
                error = error.max((value[d] - expected[d]).abs() / scale);
            }
        }
        error
    }

    #[test]
    fn sums_agree_with_the_tensor_for_every_length_in_both_precisions() {
        for count in [0, 1, 7, 8, 9, 16, 64, 85, 1024, 2100] {
            let (double, single) = (error::<f64>(count), error::<f32>(count));
            assert!(double < 1e-12 && single < 3e-7, "{count}: {double:.1e}, {single:.1e}");
        }
    }

    #[test]
    fn a_source_does_not_act_on_itself() {
        let mut sources = Sources::<f64>::default();
        sources.push([0.3, 0.2, 0.1], [1.0, 2.0, 3.0]);
        assert_eq!(sum(sources.all(), [0.3, 0.2, 0.1]), [0.0; 3]);
    }
}
