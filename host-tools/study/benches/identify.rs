//! Times of identifications with the shipped model, by criterion: `cargo bench --package capsule-study --bench
//! identify`.

use std::f64::consts::TAU;
use std::hint::black_box;

use capsule_core::Model;
use capsule_identify::{
    Contour, Curve, Direction, Flow, Grid, HALF_WIDTH, LENGTH, Lengths, Measured, Measurement, Memory, Observable,
    Point, Priors, REAR_DEPTH, Sequence, Setup, Shapes, Store, identify, identify_sequence,
};
use criterion::Criterion;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/capsule.crom");
const HALF_WIDTH_UM: f64 = 25.0;
const TRUTH: [f64; 2] = [0.08, 0.97];

const SETUP: Setup = Setup {
    half_width_um: HALF_WIDTH_UM,
    flow: Flow::MeanVelocity(5e-3),
    viscosity_pa_s: 0.8,
};

fn measured(contour: Option<Contour<'_>>, lengths: Lengths) -> Measurement<'_> {
    Measurement {
        setup: SETUP,
        contour,
        dent_line_um: &[],
        lengths,
        priors: Priors::of_pixel(0.25),
    }
}

fn along(points_um: &[[f64; 2]]) -> Contour<'_> {
    Contour {
        points_um,
        direction: Direction::Right,
        noise_um: None,
    }
}

/// A closed contour along a curve, with a ripple of a tenth of a pixel of l / 100.
fn contour(curve: &Curve, count: usize) -> Vec<[f64; 2]> {
    let point = |i: usize| {
        let way = 2.0 * i as f64 / count as f64;
        let [x, y] = curve.position(if way <= 1.0 { way } else { 2.0 - way });
        let out = 1.0 + 1e-3 * (29.3 * TAU * way).sin();
        [x * out, if way <= 1.0 { y * out } else { -y * out }].map(|x| HALF_WIDTH_UM * x)
    };
    (0..count).map(point).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::fs::read(MODEL)?;
    let model = Model::open(&file)?;
    let mut workspace = Box::new(Store::new());
    let memory = Memory {
        workspace: &mut workspace,
        positions: &mut [],
        normals: &mut [],
    };
    let mut shapes = Shapes::new(&model, memory, Observable::Midplane, model.end_time());
    let grid = Grid::new(&mut shapes)?;
    let mut points = vec![Point::default(); 600];
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    let theta = [TRUTH[0].ln(), TRUTH[1]];
    let steady = shapes.at(theta)?;
    for count in [64, 600] {
        let drawn = contour(&steady.curve, count);
        let measurement = measured(Some(along(&drawn)), Lengths::default());
        criterion.bench_function(&format!("outline of {count} points"), |bencher| {
            bencher.iter(|| black_box(identify(&mut shapes, &grid, black_box(&measurement), &mut points)))
        });
    }
    let [length, half_width, rear_depth] = [LENGTH, HALF_WIDTH, REAR_DEPTH].map(|i| {
        Some(Measured {
            value: HALF_WIDTH_UM * steady.scalars[i],
            deviation: 0.1,
        })
    });
    let lengths = Lengths {
        axial_length_um: length,
        half_width_um: half_width,
        rear_depth_um: rear_depth,
        ..Lengths::default()
    };
    let measurement = measured(None, lengths);
    criterion.bench_function("three lengths", |bencher| {
        bencher.iter(|| black_box(identify(&mut shapes, &grid, black_box(&measurement), &mut [])))
    });
    let end = shapes.instant();
    let mut frames = Vec::new();
    for t in [0.4, 0.9, 1.8] {
        shapes.set_instant(t);
        frames.push(contour(&shapes.at(theta)?.curve, 600));
    }
    shapes.set_instant(end);
    let contours: Vec<Contour<'_>> = frames.iter().map(|points| along(points)).collect();
    let sequence = Sequence {
        setup: SETUP,
        contours: &contours,
        priors: Priors::of_pixel(0.25),
        steady: false,
    };
    criterion.bench_function("transient of three frames", |bencher| {
        bencher.iter(|| black_box(identify_sequence(&mut shapes, &grid, black_box(&sequence), &mut points)))
    });
    criterion.final_summary();
    Ok(())
}
