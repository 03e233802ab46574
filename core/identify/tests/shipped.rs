//! Outlines of the shipped model and of closed shapes, identified.

use capsule_core::Model;
use capsule_identify::*;

static FILE: &[u8] = include_bytes!("../../../models/capsule.crom");

struct Bench {
    workspace: Box<Store>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
}

impl Bench {
    fn new(model: &Model<'_>) -> Self {
        Self {
            workspace: Box::new(Store::new()),
            positions: vec![[0.0; 3]; model.mesh().nodes()],
            normals: vec![[0.0; 3]; model.mesh().sector_nodes().len()],
        }
    }

    fn shapes<'a, 'w>(&'w mut self, model: &'a Model<'a>, observable: Observable) -> Shapes<'a, 'w> {
        let memory = Memory {
            workspace: &mut self.workspace,
            positions: &mut self.positions,
            normals: &mut self.normals,
        };
        Shapes::new(model, memory, observable, model.end_time())
    }
}

const HALF_WIDTH: f64 = 25.0;

/// A closed contour in um along a shape, in image coordinates, and with noise from a generator.
fn contour(shape: &Shape, count: usize, noise: f64, mut normal: impl FnMut() -> f64) -> Vec<[f64; 2]> {
    let fine: Vec<[f64; 2]> = (0..=4000).map(|i| shape.curve.position(f64::from(i) / 4000.0)).collect();
    let closed: Vec<[f64; 2]> = fine.iter().copied().chain(fine.iter().rev().skip(1).map(|[x, y]| [*x, -y])).collect();
    let mut way = vec![0.0];
    for pair in closed.windows(2) {
        way.push(way[way.len() - 1] + (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
    }
    (0..count)
        .map(|k| {
            let s = way[way.len() - 1] * k as f64 / count as f64;
            let i = way.partition_point(|w| *w <= s).clamp(1, closed.len() - 1);
            let (p, q) = (closed[i - 1], closed[i]);
            let [tx, ty] = [q[0] - p[0], q[1] - p[1]];
            let length = tx.hypot(ty);
            let share = (s - way[i - 1]) / (way[i] - way[i - 1]);
            let out = noise * normal();
            [
                100.0 + HALF_WIDTH * (p[0] + share * tx + out * ty / length),
                40.0 + HALF_WIDTH * (p[1] + share * ty - out * tx / length),
            ]
        })
        .collect()
}

/// Normal numbers by sums of uniform ones.
fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        let mut sum = -6.0;
        for _ in 0..12 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            sum += (state >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }
}

fn measurement(points: &[[f64; 2]]) -> Measurement<'_> {
    Measurement {
        setup: Setup {
            half_width_um: HALF_WIDTH,
            flow: Flow::MeanVelocity(5e-3),
            viscosity_pa_s: 0.8,
        },
        contour: Some(Contour {
            points_um: points,
            direction: Direction::Right,
            noise_um: None,
        }),
        lengths: Lengths::default(),
        priors: Priors::of_pixel(0.25),
    }
}

#[test]
fn an_outline_of_the_model_gives_its_parameters() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    for observable in [Observable::Midplane, Observable::Silhouette] {
        let mut shapes = bench.shapes(&model, observable);
        let start = std::time::Instant::now();
        let grid = Grid::new(&mut shapes).unwrap();
        eprintln!("grid {:?}", start.elapsed());
        for truth in [[0.1, 0.9], [0.03, 1.1], [0.006, 0.8], [0.02, 0.78], [0.008, 0.95], [0.15, 0.8], [0.05, 1.19]] {
            let theta = [f64::ln(truth[0]), truth[1]];
            let shape = shapes.at(theta).unwrap();
            for noise in [0.0, 1e-3] {
                let points = contour(&shape, 600, noise, normals(1));
                let mut room = vec![Point::default(); 600];
                let mut measurement = measurement(&points);
                measurement.priors.model = 0.0;
                let start = std::time::Instant::now();
                let found = identify(&mut shapes, &grid, &measurement, &mut room).unwrap();
                let time = start.elapsed();
                eprintln!(
                    "{observable:?} {truth:?} {noise}: ca {:+.4} % a {:+.5} %  95: {:+.4} {:+.4} | {:+.5} {:+.5} {} edge {:.4} noise {:.2e} together {:.2} struct {:.1} evals {} {:?}",
                    100.0 * (found.capillary_number.value / truth[0] - 1.0),
                    100.0 * (found.confinement.value / truth[1] - 1.0),
                    100.0 * (found.capillary_number.interval_95.low / truth[0] - 1.0),
                    100.0 * (found.capillary_number.interval_95.high / truth[0] - 1.0),
                    100.0 * (found.confinement.interval_95.low / truth[1] - 1.0),
                    100.0 * (found.confinement.interval_95.high / truth[1] - 1.0),
                    found.verdict.name(), found.edge_um, found.noise_um / HALF_WIDTH, found.correlated_points, found.structure,
                    found.evaluations,
                    time
                );
            }
        }
    }
}
