//! Rates of the kernels beside the peaks measured in the same run, on one core.

use std::hint::black_box;

use capsule_fom::flow::Precision;
use capsule_fom::flow::dense::Dense;
use capsule_fom::flow::patch::{Patch, PatchRule};
use capsule_fom::flow::quadrature::TriangleRule;
use capsule_fom::flow::stokeslet::{Sources, StokesletSums, add_sums};
use capsule_opcount::{Arithmetic, least_time, peak, reading};
use faer::Mat;

/// Floating-point operations for a pair of source and target in single and in double precision: 27 that do not depend
/// on the precision (3 differences, 5 for the square, 5 for the product with the force, 2 for the part along the
/// distance, 12 for the sums), and 12 or 16 for the reciprocal root. Integer operations and selections are not counted.
const PAIR: [f64; 2] = [27.0 + 12.0, 27.0 + 16.0];
/// Nine fields at a point from six nodes, and the force from load and area.
const INTERPOLATION: f64 = 9.0 * 6.0 * 2.0 + 10.0;

/// Measures and prints the table.
pub fn print(repetitions: usize) {
    let fma = [Arithmetic::FusedSingle, Arithmetic::FusedDouble].map(|arithmetic| peak(arithmetic, repetitions));
    let memory = reading(256 << 20, repetitions.min(20)) / 1e9;
    let cache = reading(MATRIX * MATRIX * 4, repetitions) / 1e9;
    println!(
        "peaks: {:.0} GFlop/s in single and {:.0} in double precision (fused multiply-adds in registers), reading \
         {memory:.1} \
         GB/s from memory and {cache:.1} GB/s of an array of the size of the walls' matrix",
        fma[0] / 1e9,
        fma[1] / 1e9,
    );
    println!("kernel                                     kflop     kB      us  GFlop/s  of peak   GB/s  of reading");
    let row = |name: &str, precision: usize, flops: f64, bytes: f64, seconds: f64| {
        println!(
            "{name:<40} {:>7.0} {:>6.0} {:>7.1} {:>8.1} {:>7.0} % {:>6.1} {:>10.0} %",
            flops / 1e3,
            bytes / 1e3,
            seconds * 1e6,
            flops / seconds / 1e9,
            100.0 * flops / seconds / fma[precision],
            bytes / seconds / 1e9,
            100.0 * bytes / seconds / (1e9 * cache),
        );
    };
    for (name, precision, time, sources, targets) in [
        (
            "far sums, single: 9464 sources, 16 targets",
            0,
            sums::<f32>(repetitions, 9464, 16),
            9464,
            16,
        ),
        (
            "far sums, double: 9464 sources, 16 targets",
            1,
            sums::<f64>(repetitions, 9464, 16),
            9464,
            16,
        ),
        (
            "near sums, double: 16 sources, 16 targets",
            1,
            sums::<f64>(repetitions, 16, 16),
            16,
            16,
        ),
        (
            "singular sums, double: 80 sources, 1 target",
            1,
            sums::<f64>(repetitions, 80, 1),
            80,
            1,
        ),
    ] {
        let bytes = (6 * sources * [4, 8][precision]) as f64;
        row(
            name,
            precision,
            (sources * targets) as f64 * PAIR[precision],
            bytes,
            time,
        );
    }
    let rule = PatchRule::new(&TriangleRule::sixteen());
    let slots = rule.slots() as f64;
    row(
        "points on an element, double: 16",
        1,
        slots * INTERPOLATION,
        slots * 6.0 * 8.0,
        interpolation(repetitions, &rule),
    );
    for (name, precision, size) in [
        ("walls' matrix, single: 1152 x 1152", Precision::Mixed, 4),
        ("walls' matrix, double: 1152 x 1152", Precision::Double, 8),
    ] {
        let entries = (MATRIX * MATRIX) as f64;
        row(
            name,
            1,
            2.0 * entries,
            entries * f64::from(size),
            product(repetitions, precision),
        );
    }
}

/// Unknowns of the walls in each parity, in the production setting.
const MATRIX: usize = 1152;

fn sums<S: StokesletSums>(repetitions: usize, sources: usize, targets: usize) -> f64 {
    let noise = |i: usize| (i as f64 * 0.618_033_988_749_894_8).fract();
    let mut list = Sources::<S>::with_capacity(sources);
    for j in 0..sources {
        list.push(
            [noise(j), noise(3 * j), noise(7 * j)],
            [noise(11 * j), noise(13 * j), noise(17 * j)],
        );
    }
    let targets: Vec<_> = (0..targets)
        .map(|i| [2.0 + noise(i), noise(5 * i), noise(9 * i)])
        .collect();
    let mut out = vec![[0.0; 3]; targets.len()];
    let passes = (200_000 / (sources * targets.len())).max(1);
    least_time(repetitions, passes, || {
        add_sums(list.all(), black_box(&targets), &mut out)
    })
}

fn interpolation(repetitions: usize, rule: &PatchRule) -> f64 {
    let nodes = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.2, 0.9, 0.2],
        [0.5, -0.1, 0.2],
        [0.7, 0.6, 0.3],
        [0.0, 0.4, 0.1],
    ];
    let patch = Patch::new(&[0, 1, 2, 3, 4, 5], &nodes, &nodes);
    let mut sources = Sources::default();
    least_time(repetitions, 1000, || {
        sources.clear();
        black_box(&patch).add_sources(rule, &mut sources);
    })
}

fn product(repetitions: usize, precision: Precision) -> f64 {
    let matrix = Mat::from_fn(MATRIX, MATRIX, |i, j| ((i + 3 * j) as f64).sin());
    let matrix = Dense::new(&matrix, precision);
    let vector = vec![1.0; MATRIX];
    least_time(repetitions, 1, || {
        black_box(matrix.multiply(black_box(&vector)));
    })
}
