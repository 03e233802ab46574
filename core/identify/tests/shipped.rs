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
            positions: vec![[0.0; 3]; NODES_ROOM * model.mesh().nodes()],
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

const CHANNEL_UM: f64 = 25.0;

/// A closed contour in um along a shape, in image coordinates, and with noise from a generator.
fn contour(shape: &Shape, count: usize, noise: f64, mut normal: impl FnMut() -> f64) -> Vec<[f64; 2]> {
    let fine: Vec<[f64; 2]> = (0..=4000)
        .map(|i| shape.curve.position(f64::from(i) / 4000.0))
        .collect();
    let closed: Vec<[f64; 2]> = fine
        .iter()
        .copied()
        .chain(fine.iter().rev().skip(1).map(|[x, y]| [*x, -y]))
        .collect();
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
                100.0 + CHANNEL_UM * (p[0] + share * tx + out * ty / length),
                40.0 + CHANNEL_UM * (p[1] + share * ty - out * tx / length),
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
            half_width_um: CHANNEL_UM,
            flow: Flow::MeanVelocity(5e-3),
            viscosity_pa_s: 0.8,
        },
        contour: Some(Contour {
            points_um: points,
            direction: Direction::Right,
            noise_um: None,
        }),
        dent_line_um: &[],
        lengths: Lengths::default(),
        priors: Priors::of_pixel(0.25),
    }
}

/// Off a/l = 0.9, where the model's clusters meet: its outlines jump there by 1e-4 l, and a fit to points without noise
/// may end on either side.
const TRUTHS: [[f64; 2]; 6] = [
    [0.1, 0.92],
    [0.03, 1.1],
    [0.02, 0.78],
    [0.008, 0.95],
    [0.15, 0.8],
    [0.05, 1.15],
];

/// Identifies outlines of the model with some noise, in l, and hands over what was found.
fn each(
    observable: Observable,
    noise: f64,
    change: impl Fn(&mut Measurement<'_>),
    mut check: impl FnMut([f64; 2], Identification),
) {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, observable);
    let grid = Grid::new(&mut shapes).unwrap();
    let mut random = normals(1);
    for truth in TRUTHS {
        let shape = shapes.at([f64::ln(truth[0]), truth[1]]).unwrap();
        let points = contour(&shape, 600, noise, &mut random);
        let mut room = vec![Point::default(); points.len()];
        let mut measurement = measurement(&points);
        measurement.priors.model = 0.0;
        change(&mut measurement);
        check(truth, identify(&mut shapes, &grid, &measurement, &mut room).unwrap());
    }
}

#[test]
fn an_outline_of_the_model_gives_its_parameters() {
    for (observable, ca, radius) in [(Observable::Midplane, 1e-3, 1e-4), (Observable::Silhouette, 4e-3, 4e-4)] {
        each(
            observable,
            0.0,
            |_| {},
            |truth, found| {
                let errors = [
                    (found.capillary_number.value / truth[0] - 1.0).abs(),
                    (found.confinement.value / truth[1] - 1.0).abs(),
                ];
                assert!(
                    errors[0] < ca && errors[1] < radius,
                    "{observable:?} {truth:?}: {errors:?}"
                );
                assert!((found.radius_um.value - CHANNEL_UM * found.confinement.value).abs() < 1e-9);
                // G_s = mu V / Ca.
                let modulus = 0.8 * 5e-3 / found.capillary_number.value;
                assert!((found.shear_modulus_n_per_m.value / modulus - 1.0).abs() < 1e-12);
            },
        );
    }
}

#[test]
fn noise_is_found_and_intervals_hold() {
    let (mut held, mut asked) = (0, 0);
    each(
        Observable::Midplane,
        1e-3,
        |_| {},
        |truth, found| {
            assert!((found.noise_um / CHANNEL_UM - 1e-3).abs() < 1e-4, "{}", found.noise_um);
            for (estimate, truth) in [(found.capillary_number, truth[0]), (found.confinement, truth[1])] {
                held += usize::from(estimate.interval_95.contains(truth));
                asked += 1;
                let [narrow, wide] = [estimate.interval_68, estimate.interval_95];
                assert!(wide.low <= narrow.low && narrow.low <= estimate.value);
                assert!(estimate.value <= narrow.high && narrow.high <= wide.high);
            }
            assert_eq!(found.verdict, Verdict::Identified, "{truth:?}");
        },
    );
    assert!(held + 2 >= asked, "{held} of {asked}");
}

/// One by one they scatter, because the model's outlines are rounded to 1e-5 l.
#[test]
fn intervals_near_the_best_value_are_those_of_the_curvature() {
    let mut ratios = Vec::new();
    for noise in [2e-4, 4e-4, 6e-4] {
        each(
            Observable::Midplane,
            noise,
            |m| m.contour.as_mut().unwrap().noise_um = Some(noise * CHANNEL_UM),
            |_, found| {
                let Interval { low, high, .. } = found.capillary_number.interval_95;
                ratios.push(0.5 * (high / low).ln() / (1.96 * found.deviations[0]));
            },
        );
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((mean - 1.0).abs() < 0.03, "{mean} {ratios:?}");
    assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.2), "{ratios:?}");
}

/// The line at which the dent of a section is seen, in the coordinates of `contour`: from the rearmost place on one
/// side over the axis to the other, `depth` too deep, in l.
fn dent_line(section: &Shape, depth: f64, noise: f64, mut normal: impl FnMut() -> f64) -> Vec<[f64; 2]> {
    let half: Vec<[f64; 2]> = (0..=2000)
        .map(|i| section.curve.position(f64::from(i) / 2000.0))
        .collect();
    let rear = (0..half.len())
        .min_by(|a, b| half[*a][0].total_cmp(&half[*b][0]))
        .unwrap();
    let line = half[rear..].iter().step_by(8);
    let sides = line.clone().copied().chain(line.rev().skip(1).map(|[x, y]| [*x, -y]));
    sides
        .map(|[x, y]| {
            let x = x + depth + noise * normal();
            [100.0 + CHANNEL_UM * x, 40.0 + CHANNEL_UM * y]
        })
        .collect()
}

#[test]
fn the_dent_line_makes_a_silhouette_tell_more() {
    let model = Model::open(FILE).unwrap();
    let (mut bench, mut other) = (Bench::new(&model), Bench::new(&model));
    let mut shapes = bench.shapes(&model, Observable::Silhouette);
    let mut sections = other.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let mut random = normals(31);
    let mut squares = [0.0; 2];
    let truths = [
        [0.05, 0.8],
        [0.05, 0.95],
        [0.05, 1.05],
        [0.1, 0.8],
        [0.1, 0.95],
        [0.14, 0.86],
    ];
    for truth in truths {
        let theta = [f64::ln(truth[0]), truth[1]];
        let points = contour(&shapes.at(theta).unwrap(), 500, 4e-3, &mut random);
        let section = sections.at(theta).unwrap();
        let mut room = vec![Point::default(); 1000];
        let mut find = |line: &[[f64; 2]]| {
            let measurement = Measurement {
                dent_line_um: line,
                ..measurement(&points)
            };
            identify(&mut shapes, &grid, &measurement, &mut room).unwrap()
        };
        let without = find(&[]);
        let with = find(&dent_line(&section, 0.0, 4e-3, &mut random));
        assert_eq!(
            (with.verdict, without.dent_line_residual_um),
            (Verdict::Identified, None),
            "{truth:?}"
        );
        assert!(
            with.deviations[0] < 0.8 * without.deviations[0] && with.deviations[1] < 0.85 * without.deviations[1],
            "{truth:?}: {:?} {:?}",
            with.deviations,
            without.deviations
        );
        let residual = with.dent_line_residual_um.unwrap() / CHANNEL_UM;
        assert!((3e-3..5e-3).contains(&residual), "{truth:?}: {residual}");
        let errors = [
            (with.capillary_number.value / truth[0]).ln() / with.deviations[0],
            (with.confinement.value - truth[1]) / with.deviations[1],
        ];
        (0..2).for_each(|d| squares[d] += errors[d] * errors[d]);
        assert!(errors.iter().all(|error| error.abs() < 3.5), "{truth:?}: {errors:?}");
        // A dent that is deeper by 0.06 l is that of no capsule with this outline.
        let deeper = find(&dent_line(&section, 0.06, 4e-3, &mut random));
        assert_ne!(deeper.verdict, Verdict::Identified, "{truth:?}");
    }
    // The mean of six squares of normal numbers is below 2.8 in 99 of 100 cases.
    assert!(squares.iter().all(|sum| sum / 6.0 < 2.8), "{squares:?}");
}

#[test]
fn dent_lines_that_cannot_be_are_refused() {
    let model = Model::open(FILE).unwrap();
    let (mut bench, mut other) = (Bench::new(&model), Bench::new(&model));
    let mut shapes = bench.shapes(&model, Observable::Silhouette);
    let mut sections = other.shapes(&model, Observable::Midplane);
    let theta = [f64::ln(0.06), 0.95];
    let points = contour(&shapes.at(theta).unwrap(), 300, 1e-3, normals(1));
    let section = sections.at(theta).unwrap();
    let line = dent_line(&section, 0.0, 1e-3, normals(2));
    let mut room = vec![Point::default(); 600];
    let mut fault = |shapes: &mut Shapes<'_, '_>, line: &[[f64; 2]], contour: bool| {
        let grid = Grid::new(shapes).unwrap();
        let mut measurement = measurement(&points);
        measurement.dent_line_um = line;
        if !contour {
            measurement.contour = None;
            let measured = Some(Measured {
                value: 20.0,
                deviation: 0.2,
            });
            (measurement.lengths.radius_um, measurement.lengths.half_width_um) = (measured, measured);
        }
        match identify(shapes, &grid, &measurement, &mut room) {
            Err(IdentifyError::DentLine(error)) => Some(error),
            _ => None,
        }
    };
    assert_eq!(fault(&mut shapes, &line, true), None);
    assert_eq!(fault(&mut shapes, &line, false), Some(DentLineError::NoSilhouette));
    assert_eq!(fault(&mut sections, &line, true), Some(DentLineError::NoSilhouette));
    assert_eq!(
        fault(&mut shapes, &line[..4], true),
        Some(DentLineError::TooFewPoints { found: 4 })
    );
    let mut far = line.clone();
    far[7] = [far[7][0] - 20.0, far[7][1]];
    assert_eq!(
        fault(&mut shapes, &far, true),
        Some(DentLineError::Outside { index: 7 })
    );
    far[7] = [f64::NAN, 0.0];
    assert_eq!(
        fault(&mut shapes, &far, true),
        Some(DentLineError::Outside { index: 7 })
    );
}

/// A turn of a picture.
type Turn = fn([f64; 2]) -> [f64; 2];

/// The least value of a function that falls and then rises, by golden sections.
fn least([mut low, mut high]: [f64; 2], f: &mut dyn FnMut(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut value = f64::INFINITY;
    for _ in 0..14 {
        let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
        let [at_a, at_b] = [f(a), f(b)];
        value = value.min(at_a).min(at_b);
        (low, high) = if at_a < at_b { (low, b) } else { (a, high) };
    }
    value
}

#[test]
fn the_misfit_rises_at_the_ends_of_the_intervals_by_their_quantiles() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let mut random = normals(7);
    let mut checked = 0;
    for [ca, confinement] in TRUTHS {
        let shape = shapes.at([ca.ln(), confinement]).unwrap();
        let points = contour(&shape, 600, 3e-3, &mut random);
        let mut measurement = measurement(&points);
        if let Some(contour) = &mut measurement.contour {
            contour.noise_um = Some(3e-3 * CHANNEL_UM);
        }
        let mut room = vec![Point::default(); points.len()];
        let (found, misfit) = identify_with_misfit(&mut shapes, &grid, &measurement, &mut room).unwrap();
        assert!((misfit.level(0.95) - 5.991).abs() < 1e-3 && (misfit.level(0.6827) - 2.296).abs() < 1e-3);
        let best = [found.capillary_number.value.ln(), found.confinement.value];
        let at_best = misfit.rise(&mut shapes, best).unwrap().unwrap();
        assert!(at_best.abs() < 0.1, "{at_best}");
        let ends = |estimate: Estimate| [(1.0, estimate.interval_68), (1.96, estimate.interval_95)];
        for (d, estimate) in [(0, found.capillary_number), (1, found.confinement)] {
            for (quantile, interval) in ends(estimate) {
                for (end, open) in [interval.low, interval.high].into_iter().zip(interval.open) {
                    if open {
                        continue;
                    }
                    let end = if d == 0 { end.ln() } else { end };
                    let other = 1 - d;
                    let way = 4.0 * found.deviations[other];
                    let rise = least([best[other] - way, best[other] + way], &mut |value| {
                        let mut theta = [end; 2];
                        theta[other] = value;
                        misfit.rise(&mut shapes, theta).unwrap().unwrap_or(f64::INFINITY)
                    });
                    let root = rise.max(0.0).sqrt();
                    assert!(
                        (root - quantile).abs() < 0.1 * quantile,
                        "Ca {ca}, a/l {confinement}: {root} for {quantile}, parameter {d}"
                    );
                    checked += 1;
                }
            }
            // Farther off, where no polynomial stands for the model.
            let [way, other] = [found.deviations[d], found.deviations[1 - d]].map(|deviation| 4.0 * deviation);
            for end in [best[d] - way, best[d] + way] {
                let rise = least([best[1 - d] - 1.5 * other, best[1 - d] + 1.5 * other], &mut |value| {
                    let mut theta = [end; 2];
                    theta[1 - d] = value;
                    misfit.rise(&mut shapes, theta).unwrap().unwrap_or(f64::INFINITY)
                });
                let root = rise.sqrt();
                assert!(
                    (root - 4.0).abs() < 0.4,
                    "Ca {ca}, a/l {confinement}: {root}, parameter {d}"
                );
            }
        }
    }
    assert!(checked > 30, "{checked}");
    assert!(misfit_outside_is_none(&mut shapes, &grid));
}

/// Whether there is no misfit where there is no capsule.
fn misfit_outside_is_none(shapes: &mut Shapes<'_, '_>, grid: &Grid) -> bool {
    let shape = shapes.at([0.1_f64.ln(), 0.9]).unwrap();
    let points = contour(&shape, 100, 0.0, || 0.0);
    let mut room = vec![Point::default(); points.len()];
    let (_, misfit) = identify_with_misfit(shapes, grid, &measurement(&points), &mut room).unwrap();
    // Fisher's F with 2 and few degrees of freedom is greater than its limit.
    assert!(misfit.level(0.95) > 5.992);
    [[0.1_f64.ln(), 0.3], [3.0_f64.ln(), 0.9]]
        .iter()
        .all(|theta| misfit.rise(shapes, *theta).unwrap().is_none())
}

#[test]
fn the_direction_of_the_flow_is_found() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let shape = shapes.at([f64::ln(0.06), 0.95]).unwrap();
    let drawn = contour(&shape, 300, 1e-3, normals(2));
    let turns: [(Turn, Direction); 4] = [
        (|p| p, Direction::Right),
        (|[x, y]| [-x, y], Direction::Left),
        (|[x, y]| [y, x], Direction::Up),
        (|[x, y]| [y, -x], Direction::Down),
    ];
    for (turn, direction) in turns {
        let mut points: Vec<[f64; 2]> = drawn.iter().map(|point| turn(*point)).collect();
        // In either order.
        points.reverse();
        let mut measurement = measurement(&points);
        measurement.contour.as_mut().unwrap().direction = Direction::Found;
        let mut room = vec![Point::default(); points.len()];
        let found = identify(&mut shapes, &grid, &measurement, &mut room).unwrap();
        assert_eq!(found.direction, direction);
        assert!((found.capillary_number.value / 0.06 - 1.0).abs() < 0.02);
        // The model's outline lies on the contour.
        for share in [0.0, 0.3, 0.8] {
            let [x, y] = found.frame.place_um(shape.curve.position(share));
            let nearest = points
                .iter()
                .map(|p| (p[0] - x).hypot(p[1] - y))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 0.3, "{direction:?} {share}: {nearest}");
        }
    }
}

#[test]
fn an_edge_that_is_drawn_too_far_out_does_not_move_the_answer_much() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let shape = shapes.at([f64::ln(0.08), 0.95]).unwrap();
    // A quarter of a pixel of l / 100.
    let out = 2.5e-3;
    let points = contour(&shape, 600, out, || 1.0);
    let mut room = vec![Point::default(); points.len()];
    let mut found = |edge: f64| {
        let mut measurement = measurement(&points);
        measurement.priors.edge_um = edge;
        measurement.priors.scale = 0.0;
        identify(&mut shapes, &grid, &measurement, &mut room).unwrap()
    };
    let (fitted, ignored) = (found(0.0625), found(0.0));
    let error = |found: &Identification| (found.capillary_number.value / 0.08 - 1.0).abs();
    assert!(
        error(&fitted) < 2e-3 && error(&ignored) > 4e-3,
        "{} {}",
        error(&fitted),
        error(&ignored)
    );
    assert!((fitted.edge_um - out * CHANNEL_UM).abs() < 0.01, "{}", fitted.edge_um);
}

#[test]
fn three_lengths_are_enough() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let shape = shapes.at([f64::ln(0.1), 0.9]).unwrap();
    let length = |i: usize| {
        Some(Measured {
            value: CHANNEL_UM * shape.scalars[i],
            deviation: 0.05,
        })
    };
    let mut measurement = measurement(&[]);
    measurement.contour = None;
    measurement.lengths = Lengths {
        axial_length_um: length(LENGTH),
        half_width_um: length(HALF_WIDTH),
        rear_depth_um: length(REAR_DEPTH),
        ..Lengths::default()
    };
    let found = identify(&mut shapes, &grid, &measurement, &mut []).unwrap();
    assert!((found.capillary_number.value / 0.1 - 1.0).abs() < 2e-3, "{found:?}");
    assert!((found.confinement.value / 0.9 - 1.0).abs() < 5e-4);
    assert_eq!(found.verdict, Verdict::Identified);
    measurement.lengths = Lengths {
        axial_length_um: length(LENGTH),
        ..Lengths::default()
    };
    let few = identify(&mut shapes, &grid, &measurement, &mut []);
    assert!(matches!(few, Err(IdentifyError::TooFewLengths { found: 1 })));
}

#[test]
fn the_capsule_s_velocity_tells_that_of_the_flow() {
    each(
        Observable::Midplane,
        1e-3,
        |m| m.setup.flow = Flow::CapsuleVelocity(7e-3),
        |truth, found| {
            let model = Model::open(FILE).unwrap();
            let mut bench = Bench::new(&model);
            let mut shapes = bench.shapes(&model, Observable::Midplane);
            let ratio = shapes.at([truth[0].ln(), truth[1]]).unwrap().scalars[VELOCITY];
            assert!((found.mean_velocity_m_s * ratio / 7e-3 - 1.0).abs() < 2e-3);
            let modulus = 0.8 * 7e-3 / ratio / truth[0];
            let Interval { low, high, .. } = found.shear_modulus_n_per_m.interval_95;
            let margin = 0.5 * (high - low);
            assert!(
                low - margin < modulus && modulus < high + margin,
                "{low} {modulus} {high}"
            );
        },
    );
}

#[test]
fn what_is_no_such_capsule_is_said_to_be_none() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let mut found = |points: &[[f64; 2]]| {
        let mut room = vec![Point::default(); points.len()];
        identify(&mut shapes, &grid, &measurement(points), &mut room).unwrap()
    };
    // An ellipse, and a drop.
    for pointed in [0.0, 0.3] {
        let points: Vec<[f64; 2]> = (0..400)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / 400.0;
                [28.0 * angle.cos(), 20.0 * angle.sin() * (1.0 + pointed * angle.cos())]
            })
            .collect();
        let verdict = found(&points).verdict;
        assert_ne!(verdict, Verdict::Identified, "{pointed}");
        assert_ne!(verdict, Verdict::Bounded, "{pointed}");
    }
}

#[test]
fn bad_contours_are_named() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let mut error = |points: &[[f64; 2]]| {
        let mut room = vec![Point::default(); 100];
        let measurement = measurement(points);
        if let Err(error) = measurement.contour.unwrap().crossing() {
            return error;
        }
        match identify(&mut shapes, &grid, &measurement, &mut room) {
            Err(IdentifyError::Contour(error)) => error,
            other => panic!("{other:?}"),
        }
    };
    let circle = |count: usize, radius: f64, share: f64| -> Vec<[f64; 2]> {
        let angle = |i: usize| std::f64::consts::TAU * share * i as f64 / count as f64;
        (0..count)
            .map(|i| [radius * angle(i).cos(), radius * angle(i).sin()])
            .collect()
    };
    assert_eq!(error(&circle(11, 20.0, 1.0)), ContourError::TooFewPoints { found: 11 });
    assert!(matches!(
        error(&circle(101, 20.0, 1.0)),
        ContourError::TooManyPoints {
            found: 101,
            capacity: 100
        }
    ));
    assert!(matches!(
        error(&circle(90, 27.0, 1.0)),
        ContourError::WiderThanChannel { .. }
    ));
    assert!(matches!(error(&circle(90, 20.0, 0.5)), ContourError::Open { .. }));
    let mut points = circle(90, 20.0, 1.0);
    points[7][1] = f64::NAN;
    assert_eq!(error(&points), ContourError::NotFinite { index: 7 });
    let eight: Vec<[f64; 2]> = (0..80)
        .map(|i| {
            let angle = std::f64::consts::TAU * (f64::from(i) + 0.5) / 80.0;
            [20.0 * angle.sin(), 12.0 * (2.0 * angle).sin()]
        })
        .collect();
    assert!(matches!(error(&eight), ContourError::SelfCrossing { .. }));
    let line: Vec<[f64; 2]> = (0..40)
        .map(|i| [if i < 20 { f64::from(i) } else { f64::from(40 - i) }, 1e-4])
        .collect();
    assert_eq!(error(&line), ContourError::NoArea);
}

/// Contours of a capsule at instants, or steady ones, with noise.
fn frames(shapes: &mut Shapes<'_, '_>, truths: &[([f64; 2], f64)], noise: f64, seed: u64) -> Vec<Vec<[f64; 2]>> {
    let end = shapes.instant();
    let mut random = normals(seed);
    let mut drawn = Vec::new();
    for ([ca, confinement], t) in truths {
        shapes.set_instant(*t);
        let shape = shapes.at([ca.ln(), *confinement]).unwrap();
        drawn.push(contour(&shape, 500, noise, &mut random));
    }
    shapes.set_instant(end);
    drawn
}

fn of_frames(
    shapes: &mut Shapes<'_, '_>,
    grid: &Grid,
    drawn: &[Vec<[f64; 2]>],
    steady: bool,
) -> Result<SequenceIdentification, IdentifyError> {
    let contours: Vec<Contour<'_>> = drawn
        .iter()
        .map(|points| measurement(points).contour.unwrap())
        .collect();
    let mut room = vec![Point::default(); 500];
    let sequence = Sequence {
        setup: measurement(&[]).setup,
        contours: &contours,
        priors: Priors {
            model: 0.0,
            ..Priors::of_pixel(0.25)
        },
        steady,
    };
    identify_sequence(shapes, grid, &sequence, &mut room)
}

#[test]
fn a_transient_gives_the_capsule_and_the_instants() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    for (seed, truth) in [[0.1, 0.92], [0.04, 1.05], [0.12, 0.8]].into_iter().enumerate() {
        let instants = [0.4, 0.9, 1.8];
        let drawn = frames(&mut shapes, &instants.map(|t| (truth, t)), 1e-3, seed as u64 + 3);
        let found = of_frames(&mut shapes, &grid, &drawn, false).unwrap();
        let errors = [
            (found.capillary_number.value / truth[0]).ln() / found.deviations[0],
            (found.confinement.value - truth[1]) / found.deviations[1],
        ];
        assert!(
            errors.iter().all(|error| error.abs() < 3.5),
            "{truth:?}: {errors:?} {found:?}"
        );
        assert_eq!(found.verdict, Verdict::Identified, "{truth:?}");
        assert!(
            (found.capillary_number.value / truth[0] - 1.0).abs() < 0.05,
            "{truth:?}: {found:?}"
        );
        for (t, [value, deviation]) in instants.into_iter().zip(found.instants) {
            assert!(
                (value - t).abs() < 3.5 * deviation && deviation < 0.1,
                "{truth:?} {t}: {found:?}"
            );
        }
    }
}

#[test]
fn steady_frames_are_averaged_and_their_drift_is_seen() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let (truth, end) = ([0.07, 0.98], shapes.instant());
    let same = frames(&mut shapes, &[(truth, end); 6], 2e-3, 11);
    let all = of_frames(&mut shapes, &grid, &same, true).unwrap();
    let one = of_frames(&mut shapes, &grid, &same[..1], true).unwrap();
    // Noise falls with the root of the number; edge and scale are the same in all frames.
    assert!(
        all.deviations[0] < 0.7 * one.deviations[0],
        "{:?} {:?}",
        all.deviations,
        one.deviations
    );
    assert!((all.capillary_number.value / truth[0]).ln().abs() < 3.5 * all.deviations[0]);
    assert!(!all.drifts(), "{} of {}", all.drift, all.drift_freedom);
    assert_eq!(all.verdict, Verdict::Identified);
    let growing: Vec<_> = (0..6)
        .map(|i| ([0.07 * (1.0 + 0.02 * f64::from(i)), 0.98], end))
        .collect();
    let drawn = frames(&mut shapes, &growing, 2e-3, 12);
    let drifting = of_frames(&mut shapes, &grid, &drawn, true).unwrap();
    assert!(drifting.drifts(), "{} of {}", drifting.drift, drifting.drift_freedom);
    assert_eq!(drifting.verdict, Verdict::FramesDiffer);
    let none = of_frames(&mut shapes, &grid, &[], true);
    assert!(matches!(none, Err(IdentifyError::Frames { found: 0 })));
}

/// Beside the border the model's bound is greater and explains more, which must not make such a capsule the answer.
#[test]
fn frames_are_not_drawn_to_the_border_of_buckling() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Silhouette);
    let (grid, end) = (Grid::new(&mut shapes).unwrap(), shapes.instant());
    let truths = [
        [0.0293, 0.8998],
        [0.0166, 0.9525],
        [0.0403, 0.9349],
        [0.0205, 1.0277],
        [0.0294, 0.8334],
    ];
    for (seed, truth) in truths.into_iter().enumerate() {
        let drawn = frames(&mut shapes, &[(truth, end); 3], 1e-2, seed as u64 + 41);
        let contours: Vec<Contour<'_>> = drawn
            .iter()
            .map(|points| measurement(points).contour.unwrap())
            .collect();
        let sequence = Sequence {
            setup: measurement(&[]).setup,
            contours: &contours,
            priors: Priors::of_pixel(0.25),
            steady: true,
        };
        let found = identify_sequence(&mut shapes, &grid, &sequence, &mut [Point::default(); 500]).unwrap();
        let error = found.capillary_number.value / truth[0] - 1.0;
        assert!(error.abs() < 0.15, "{truth:?}: {error} {:?}", found.verdict);
    }
}

#[test]
fn frames_that_show_no_such_capsule_are_not_identified() {
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let mut random = normals(21);
    let mut drawn = |x: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64| -> Vec<Vec<[f64; 2]>> {
        let mut point = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / 500.0;
            [x(angle), y(angle)].map(|x| CHANNEL_UM * (x + 1e-3 * random()))
        };
        (0..3).map(|_| (0..500).map(&mut point).collect()).collect()
    };
    // A square with rounded corners; a long ellipse, thinner than any capsule of its length.
    let root = |x: f64| x.signum() * x.abs().sqrt();
    let squares = drawn(&|angle| 0.8 * root(angle.cos()), &|angle| 0.8 * root(angle.sin()));
    let ellipses = drawn(&|angle| 1.4 * angle.cos(), &|angle| 0.5 * angle.sin());
    for contours in [squares, ellipses] {
        for steady in [true, false] {
            let found = of_frames(&mut shapes, &grid, &contours, steady).unwrap();
            assert!(
                matches!(
                    found.verdict,
                    Verdict::NotSuchACapsule | Verdict::OutsideDomain | Verdict::FramesDiffer
                ),
                "{:?}",
                found.verdict
            );
        }
    }
    // A scale 4 % off, eight of its deviations, of a capsule that is almost a sphere: no other is larger and as round.
    let sphere = frames(&mut shapes, &[([0.01, 0.9], 20.0); 3], 1e-3, 22);
    let grown: Vec<Vec<_>> = sphere
        .iter()
        .map(|f| f.iter().map(|p| p.map(|x| 1.04 * x)).collect())
        .collect();
    let found = of_frames(&mut shapes, &grid, &grown, true).unwrap();
    assert_ne!(found.verdict, Verdict::Identified);
}

#[test]
fn transients_err_as_much_as_they_state() {
    const TRIALS: u64 = 30;
    let model = Model::open(FILE).unwrap();
    let mut bench = Bench::new(&model);
    let mut shapes = bench.shapes(&model, Observable::Midplane);
    let grid = Grid::new(&mut shapes).unwrap();
    let (mut squares, mut held) = ([0.0; 3], [0; 2]);
    for seed in 0..TRIALS {
        // Numbers between 0 and 1 that fill the square evenly.
        let [u, v] = [0.754_877_666, 0.569_840_291].map(|step| (0.5 + step * seed as f64).fract());
        let truth = [0.02 * f64::powf(6.0, u), 0.8 + 0.14 * v];
        let instants = [0.3 + 0.2 * v, 0.8 + 0.3 * u, 1.9];
        let drawn = frames(&mut shapes, &instants.map(|t| (truth, t)), 1e-3, seed + 100);
        let found = of_frames(&mut shapes, &grid, &drawn, false).unwrap();
        let errors = [
            (found.capillary_number.value / truth[0]).ln() / found.deviations[0],
            (found.confinement.value - truth[1]) / found.deviations[1],
            (found.instants[0][0] - instants[0]) / found.instants[0][1],
        ];
        println!("{truth:?} {errors:.2?} {:.4?}", found.deviations);
        squares
            .iter_mut()
            .zip(errors)
            .for_each(|(sum, error)| *sum += error * error);
        held[0] += i32::from(found.capillary_number.interval_95.contains(truth[0]));
        held[1] += i32::from(found.confinement.interval_95.contains(truth[1]));
    }
    let spread = squares.map(|sum| (sum / TRIALS as f64).sqrt());
    println!("spread {spread:.2?} held {held:?} of {TRIALS}");
    // The square of 30 errors, over 30, is 1 within 0.78: three standard deviations.
    assert!(spread.iter().all(|spread| (0.47..1.34).contains(spread)), "{spread:?}");
    assert!(held.iter().all(|held| *held >= 25), "{held:?} of {TRIALS}");
}
