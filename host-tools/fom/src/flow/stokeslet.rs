//! Sums of Stokeslets, `v(x) = sum_j J(x - y_j) f_j` with `J(d) = I / |d| + d d^T / |d|^3`: where nearly all the time of
//! the full-order model is spent.
//!
//! The loops run over plain slices in lanes of eight sources, so that the compiler turns them into vector
//! instructions; which set (AVX-512, AVX2 with FMA, or the baseline) is chosen at run time.

use multiversion::multiversion;
use multiversion::target::match_target;
use rayon::prelude::*;

/// Point forces, one slice a component: positions `(x, y, z)` and strengths `(fx, fy, fz)`.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    fx: Vec<f64>,
    fy: Vec<f64>,
    fz: Vec<f64>,
}

impl Sources {
    /// An empty set with room for `capacity` sources.
    pub fn with_capacity(capacity: usize) -> Self {
        let empty = || Vec::with_capacity(capacity);
        Self {
            x: empty(),
            y: empty(),
            z: empty(),
            fx: empty(),
            fy: empty(),
            fz: empty(),
        }
    }

    /// Adds a source at `position` with `strength`.
    pub fn push(&mut self, position: [f64; 3], strength: [f64; 3]) {
        self.x.push(position[0]);
        self.y.push(position[1]);
        self.z.push(position[2]);
        self.fx.push(strength[0]);
        self.fy.push(strength[1]);
        self.fz.push(strength[2]);
    }

    /// Their number.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Keeps the first `count` sources.
    pub fn truncate(&mut self, count: usize) {
        for component in [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.fx,
            &mut self.fy,
            &mut self.fz,
        ] {
            component.truncate(count);
        }
    }

    /// Removes all sources, but keeps their room.
    pub fn clear(&mut self) {
        self.truncate(0);
    }

    /// Adds `count` sources of no strength at the origin; returns the six components of the new ones, to be filled in.
    pub fn extend(&mut self, count: usize) -> [&mut [f64]; 6] {
        [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.fx,
            &mut self.fy,
            &mut self.fz,
        ]
        .map(|component| {
            let start = component.len();
            component.resize(start + count, 0.0);
            &mut component[start..]
        })
    }

    /// Source `j`: position and strength.
    pub fn get(&self, j: usize) -> ([f64; 3], [f64; 3]) {
        ([self.x[j], self.y[j], self.z[j]], [self.fx[j], self.fy[j], self.fz[j]])
    }

    /// All of them.
    pub fn all(&self) -> SourceSlice<'_> {
        self.range(0, self.x.len())
    }

    /// The `count` sources from `start` on.
    pub fn range(&self, start: usize, count: usize) -> SourceSlice<'_> {
        let range = start..start + count;
        SourceSlice {
            x: &self.x[range.clone()],
            y: &self.y[range.clone()],
            z: &self.z[range.clone()],
            fx: &self.fx[range.clone()],
            fy: &self.fy[range.clone()],
            fz: &self.fz[range],
        }
    }
}

/// A part of some [`Sources`]; all slices have the same length.
#[derive(Debug, Clone, Copy)]
pub struct SourceSlice<'a> {
    x: &'a [f64],
    y: &'a [f64],
    z: &'a [f64],
    fx: &'a [f64],
    fy: &'a [f64],
    fz: &'a [f64],
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

/// Adds `sum_j J(target - y_j) f_j` to `out`, for each target.
pub fn add_sums(sources: SourceSlice<'_>, targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    dispatched(
        (sources.x, sources.y, sources.z),
        (sources.fx, sources.fy, sources.fz),
        targets,
        out,
    );
}

/// [`add_sums`] by all threads of the pool.
pub fn add_all(sources: &Sources, targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    targets
        .par_chunks(TASK)
        .zip(out.par_chunks_mut(TASK))
        .for_each(|(targets, out)| add_sums(sources.all(), targets, out));
}

/// Targets summed by one task.
const TASK: usize = 32;

type Components<'a> = (&'a [f64], &'a [f64], &'a [f64]);

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2+fma", "x86_64+avx2+fma"))]
fn dispatched(position: Components<'_>, strength: Components<'_>, targets: &[[f64; 3]], out: &mut [[f64; 3]]) {
    // Without the instruction, a fused multiply-add is a slow library call.
    match_target! {
        "x86_64+fma" => blocks::<true>(position, strength, targets, out),
        _ => blocks::<false>(position, strength, targets, out),
    }
}

/// Sources handled together: one AVX-512 register of doubles. Lists of a multiple of this length are summed fastest.
pub const LANES: usize = 8;
/// Targets handled together, so that a source is loaded once for all of them.
const TARGETS: usize = 4;

#[inline(always)]
fn blocks<const FMA: bool>(
    position: Components<'_>,
    strength: Components<'_>,
    targets: &[[f64; 3]],
    out: &mut [[f64; 3]],
) {
    let mut targets = targets.chunks_exact(TARGETS);
    let mut out = out.chunks_exact_mut(TARGETS);
    for (block, values) in targets.by_ref().zip(out.by_ref()) {
        if let Ok(block) = block.try_into() {
            for (value, sum) in values
                .iter_mut()
                .zip(block_sums::<FMA, TARGETS>(position, strength, block))
            {
                add(value, sum);
            }
        }
    }
    for (&target, value) in targets.remainder().iter().zip(out.into_remainder()) {
        let [sum] = block_sums::<FMA, 1>(position, strength, &[target]);
        add(value, sum);
    }
}

#[inline(always)]
fn add(value: &mut [f64; 3], sum: [f64; 3]) {
    for d in 0..3 {
        value[d] += sum[d];
    }
}

type Lanes = [f64; LANES];

#[inline(always)]
fn block_sums<const FMA: bool, const T: usize>(
    position: Components<'_>,
    strength: Components<'_>,
    targets: &[[f64; 3]; T],
) -> [[f64; 3]; T] {
    let mut sums = [[[0.0; LANES]; 3]; T];
    let ((x, x_rest), (y, y_rest), (z, z_rest)) = chunks(position);
    let ((fx, fx_rest), (fy, fy_rest), (fz, fz_rest)) = chunks(strength);
    let positions = x.iter().zip(y).zip(z);
    let strengths = fx.iter().zip(fy).zip(fz);
    for (((&x, &y), &z), ((&fx, &fy), &fz)) in positions.zip(strengths) {
        for t in 0..T {
            interact::<FMA>(&targets[t], &[x, y, z], &[fx, fy, fz], &mut sums[t]);
        }
    }
    if !x_rest.is_empty() {
        // The rest is filled up with sources of no strength, away from the targets.
        let y = [filled(x_rest, 1e9), filled(y_rest, 1e9), filled(z_rest, 1e9)];
        let f = [filled(fx_rest, 0.0), filled(fy_rest, 0.0), filled(fz_rest, 0.0)];
        for t in 0..T {
            interact::<FMA>(&targets[t], &y, &f, &mut sums[t]);
        }
    }
    sums.map(|components| components.map(|lanes| lanes.iter().sum()))
}

type Chunks<'a> = (&'a [Lanes], &'a [f64]);

#[inline(always)]
fn chunks<'a>((a, b, c): Components<'a>) -> (Chunks<'a>, Chunks<'a>, Chunks<'a>) {
    (a.as_chunks(), b.as_chunks(), c.as_chunks())
}

#[inline(always)]
fn filled(rest: &[f64], filling: f64) -> Lanes {
    let mut lanes = [filling; LANES];
    lanes.iter_mut().zip(rest).for_each(|(lane, value)| *lane = *value);
    lanes
}

/// Adds the Stokeslets of one register of sources at one target.
#[inline(always)]
fn interact<const FMA: bool>(target: &[f64; 3], y: &[Lanes; 3], f: &[Lanes; 3], sums: &mut [Lanes; 3]) {
    for l in 0..LANES {
        let dx = target[0] - y[0][l];
        let dy = target[1] - y[1][l];
        let dz = target[2] - y[2][l];
        let square = fused::<FMA>(dx, dx, fused::<FMA>(dy, dy, dz * dz));
        let inverse = reciprocal_root::<FMA>(square);
        let dot = fused::<FMA>(dx, f[0][l], fused::<FMA>(dy, f[1][l], dz * f[2][l]));
        let along = dot * (inverse * inverse);
        sums[0][l] = fused::<FMA>(inverse, fused::<FMA>(along, dx, f[0][l]), sums[0][l]);
        sums[1][l] = fused::<FMA>(inverse, fused::<FMA>(along, dy, f[1][l]), sums[1][l]);
        sums[2][l] = fused::<FMA>(inverse, fused::<FMA>(along, dz, f[2][l]), sums[2][l]);
    }
}

/// `a b + c`, fused where the processor can.
#[inline(always)]
pub(super) fn fused<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

/// `1 / sqrt(x)` for normal positive `x`, 0 for 0 (a source does not act on itself), by multiplications only: halving
/// the exponent in the bits gives 3.5 %, a quadratic fitted to that guess 3e-5, a step of third order 5e-14. Square root
/// and division take longer.
#[inline(always)]
fn reciprocal_root<const FMA: bool>(x: f64) -> f64 {
    let guess = f64::from_bits(0x5fe6_eb50_c7b5_37a9_u64.wrapping_sub(x.to_bits() >> 1));
    let h = fused::<FMA>(-(x * guess), guess, 1.0);
    let factor = fused::<FMA>(
        h,
        fused::<FMA>(h, 0.375_227_683_937, 0.501_095_186_429),
        1.000_000_852_700,
    );
    let better = guess * factor;
    let h = fused::<FMA>(-(x * better), better, 1.0);
    let root = fused::<FMA>(better * h, fused::<FMA>(h, 0.375, 0.5), better);
    if x > 0.0 { root } else { 0.0 }
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

    #[test]
    fn sums_agree_with_the_tensor_for_every_length() {
        for count in [0, 1, 7, 8, 9, 64, 85] {
            let mut sources = Sources::default();
            for j in 0..count {
                sources.push(point(j), point(1000 + j));
            }
            let targets: Vec<_> = (0..7).map(|i| point(5000 + i).map(|c| 2.0 * c)).collect();
            let mut out = vec![[1.0; 3]; targets.len()];
            add_sums(sources.all(), &targets, &mut out);
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
                    assert!((value[d] - expected[d]).abs() < 1e-12 * scale);
                }
            }
        }
    }

    #[test]
    fn a_source_does_not_act_on_itself() {
        let mut sources = Sources::default();
        sources.push([0.3, 0.2, 0.1], [1.0, 2.0, 3.0]);
        assert_eq!(sum(sources.all(), [0.3, 0.2, 0.1]), [0.0; 3]);
    }

    #[test]
    fn reciprocal_root_is_good_over_the_range_of_distances() {
        for k in -400..400 {
            let x = 1.7_f64.powi(k / 4) * (1.0 + 0.2 * f64::from(k.rem_euclid(4)));
            assert!((reciprocal_root::<false>(x) * x.sqrt() - 1.0).abs() < 1e-12, "{x}");
        }
    }
}
