//! Small models of families with exact answers.
//!
//! The shape lies in the span of a few modes that have the square's symmetry. Each coefficient follows
//! alpha(t) = target + (start - target) exp(-rate t), with a target that is a combination of 1, a/l, (a/l)^2 and Ca:
//! both interpolations reproduce those, and d alpha/dt = rate (target - alpha) is affine in alpha, as a manifold is.
#![allow(dead_code)]

use capsule_core::model::encode;
use capsule_core::model::wire::*;
use std::collections::HashMap;
use std::ops::Range;

/// Scales of the kernel's coordinates.
const KERNEL_SCALES: [f64; 4] = [2.25, 1.0, 1.0, 1.0];
/// Number of modes of the shape; the state has one coefficient more, the translation.
pub const SHAPE_MODES: usize = 4;
/// Number of parameter functions: 1, a/l, (a/l)^2, Ca.
pub const FUNCTIONS: usize = 4;

/// Mesh of the unit sphere with its square symmetry.
pub struct Sphere {
    pub nodes: Vec<[f64; 3]>,
    pub elements: Vec<[u16; 6]>,
    pub sector_nodes: Vec<u16>,
    pub representative: Vec<u16>,
    pub operation: Vec<u8>,
    pub midplane: Vec<u16>,
    pub diagonal: Vec<u16>,
}

impl Sphere {
    /// Octahedral P2 mesh of a frequency, by its integer lattice |i| + |j| + |k| = 2 frequency.
    pub fn new(frequency: i32) -> Self {
        let m = 2 * frequency;
        let mut lattice = Vec::new();
        for i in (-m..=m).rev() {
            for j in -m..=m {
                for k in -m..=m {
                    if i.abs() + j.abs() + k.abs() == m {
                        lattice.push([i, j, k]);
                    }
                }
            }
        }
        let number: HashMap<[i32; 3], u16> = lattice.iter().enumerate().map(|(n, &p)| (p, n as u16)).collect();
        let nodes = lattice.iter().map(|p| {
            let s = p.map(|i| (std::f64::consts::FRAC_PI_2 * f64::from(i) / f64::from(m)).sin());
            let r = s.iter().map(|s| s * s).sum::<f64>().sqrt();
            s.map(|s| s / r)
        });

        let mut elements = Vec::new();
        let mut element = |corners: [[i32; 3]; 3]| {
            let middle = |a: usize, b: usize| std::array::from_fn(|i| (corners[a][i] + corners[b][i]) / 2);
            let points = [
                corners[0],
                corners[1],
                corners[2],
                middle(0, 1),
                middle(1, 2),
                middle(2, 0),
            ];
            elements.push(points.map(|point| number[&point]));
        };
        for signs in 0..8 {
            let sign = [0, 1, 2].map(|bit| if signs >> bit & 1 == 0 { 2 } else { -2 });
            let outward = sign.iter().product::<i32>() > 0;
            let corner = |i: i32, j: i32| [sign[0] * i, sign[1] * j, sign[2] * (frequency - i - j)];
            for i in 0..frequency {
                for j in 0..frequency - i {
                    let mut triangles = vec![[corner(i, j), corner(i + 1, j), corner(i, j + 1)]];
                    if i + j + 2 <= frequency {
                        triangles.push([corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
                    }
                    for [a, b, c] in triangles {
                        element(if outward { [a, b, c] } else { [a, c, b] });
                    }
                }
            }
        }

        let outline = |on: fn(i32, i32) -> bool| {
            let mut nodes: Vec<u16> = (0..lattice.len() as u16)
                .filter(|&n| {
                    let [_, j, k] = lattice[usize::from(n)];
                    j >= 0 && on(j, k)
                })
                .collect();
            nodes.sort_by_key(|&n| -lattice[usize::from(n)][0]);
            nodes
        };
        let [midplane, diagonal] = [outline(|_, k| k == 0), outline(|j, k| j == k)];
        // The outlines first, as in a real model: their nodes share panels.
        let rest = (0..lattice.len() as u16).filter(|&n| {
            let [_, j, k] = lattice[usize::from(n)];
            0 <= k && k <= j
        });
        let mut sector: Vec<u16> = Vec::new();
        for node in midplane.iter().chain(&diagonal).copied().chain(rest) {
            if !sector.contains(&node) {
                sector.push(node);
            }
        }
        let place: HashMap<u16, u16> = sector.iter().enumerate().map(|(place, &n)| (n, place as u16)).collect();
        let origin = |&[i, j, k]: &[i32; 3]| {
            let (large, small) = (j.abs().max(k.abs()), j.abs().min(k.abs()));
            let swap = u8::from(k.abs() > j.abs()) << 2;
            (
                place[&number[&[i, large, small]]],
                swap | u8::from(j < 0) | u8::from(k < 0) << 1,
            )
        };
        Self {
            nodes: nodes.collect(),
            elements,
            representative: lattice.iter().map(|p| origin(p).0).collect(),
            operation: lattice.iter().map(|p| origin(p).1).collect(),
            sector_nodes: sector,
            midplane,
            diagonal,
        }
    }

    /// The place of each node in the table of images, by rows of operations.
    fn origins(&self) -> Vec<u16> {
        let row = self.sector_nodes.len() as u16;
        let images = self.representative.iter().zip(&self.operation);
        images
            .map(|(&place, &operation)| u16::from(operation) * row + place)
            .collect()
    }

    /// The node to which each of the eight operations takes each of the sector's, where no operation before it does.
    fn images(&self) -> Vec<u16> {
        let mut images = vec![u16::MAX; 8 * self.sector_nodes.len()];
        for (node, place) in (0..).zip(self.origins()) {
            images[usize::from(place)] = node;
        }
        images
    }
}

/// A family of motions on a mesh, sampled on a grid of parameters.
pub struct Family {
    pub sphere: Sphere,
    /// Shape modes at all nodes, orthonormal.
    pub modes: Vec<Vec<[f64; 3]>>,
    /// Relaxation rates of the shape's coefficients.
    pub rates: [f64; SHAPE_MODES],
    pub times: Vec<f32>,
    pub samples: Vec<[f64; 2]>,
}

/// Samples of a design like the paper's, coarser.
pub fn design(confinements: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let mut samples = Vec::new();
    for row in 0..10 {
        let confinement = 0.75 + 0.05 * f64::from(row);
        for column in 0..=14 {
            let capillary_number = if column == 0 { 0.005 } else { 0.01 * f64::from(column) };
            if confinements(confinement) {
                samples.push([capillary_number, confinement]);
            }
        }
    }
    samples
}

impl Family {
    pub fn new(frequency: i32) -> Self {
        let sphere = Sphere::new(frequency);
        let raw: [fn([f64; 3]) -> [f64; 3]; SHAPE_MODES] = [
            |[x, _, _]| [x, 0.0, 0.0],
            |[_, y, z]| [0.0, y, z],
            |[x, y, z]| [y * y + z * z, x * y, x * z],
            |[x, y, z]| [x * y * y * z * z, y * z * z, z * y * y],
        ];
        let mut modes: Vec<Vec<[f64; 3]>> = Vec::new();
        for field in raw {
            let mut mode: Vec<[f64; 3]> = sphere.nodes.iter().map(|&node| field(node)).collect();
            for earlier in &modes {
                let product = product(&mode, earlier);
                for (a, b) in mode.iter_mut().zip(earlier) {
                    (0..3).for_each(|axis| a[axis] -= product * b[axis]);
                }
            }
            let norm = product(&mode, &mode).sqrt();
            mode.iter_mut().for_each(|vector| *vector = vector.map(|x| x / norm));
            modes.push(mode);
        }
        let times = (0..=40).map(|i| 0.1 * i as f32).collect();
        Self {
            sphere,
            modes,
            rates: [1.0, 0.6, 1.7, 2.9],
            times,
            samples: design(|_| true),
        }
    }

    /// As few nodes, samples and instants as a family can have and still use every part of the format.
    pub fn small() -> Self {
        let samples = design(|_| true).into_iter().step_by(4).collect();
        let times = (0..=4).map(|i| i as f32).collect();
        Self {
            samples,
            times,
            ..Self::new(1)
        }
    }

    pub fn nodes(&self) -> usize {
        self.sphere.nodes.len()
    }

    /// Coefficients of coefficient `k` (0: the translation) in the parameter functions, at time t, and of its rate.
    fn coefficient(&self, k: usize, t: f64) -> [[f64; FUNCTIONS]; 2] {
        let root = (self.nodes() as f64).sqrt();
        if k == 0 {
            // X_c = U t - (U/5) (1 - exp(-2 t)) with U = 1.1 + 0.4 a/l + Ca.
            let (x, u) = (t - 0.2 * (1.0 - (-2.0 * t).exp()), 1.0 - 0.4 * (-2.0 * t).exp());
            return [x, u].map(|factor| [1.1, 0.4, 0.0, 1.0].map(|c| root * factor * c));
        }
        let target = [
            [0.3, 0.2, -0.1, 1.5],
            [-0.2, 0.0, 0.1, -1.0],
            [0.1, 0.0, 0.3, 0.5],
            [0.0, 0.1, 0.0, 0.3],
        ];
        let start = [[0.0; 4], [0.0; 4], [0.0; 4], [0.05, 0.0, 0.02, 0.0]];
        let rate = self.rates[k - 1];
        let decay = (-rate * t).exp();
        let scale = root * 0.2;
        let value = |l: usize| scale * (target[k - 1][l] + (start[k - 1][l] - target[k - 1][l]) * decay);
        let velocity = |l: usize| scale * rate * (target[k - 1][l] - start[k - 1][l]) * decay;
        [std::array::from_fn(value), std::array::from_fn(velocity)]
    }

    /// The state at a time and parameters: displacement coefficients and their rates, the translation first.
    pub fn state(&self, parameters: [f64; 2], t: f64) -> [[f64; SHAPE_MODES + 1]; 2] {
        let functions = functions(parameters);
        let at = |which: usize, k: usize| -> f64 {
            self.coefficient(k, t)[which]
                .iter()
                .zip(functions)
                .map(|(c, f)| c * f)
                .sum()
        };
        [0, 1].map(|which| std::array::from_fn(|k| at(which, k)))
    }

    /// Exact positions and velocities of all nodes in the laboratory frame.
    pub fn exact(&self, parameters: [f64; 2], t: f64) -> [Vec<[f64; 3]>; 2] {
        let [alpha, rate] = self.state(parameters, t);
        let root = (self.nodes() as f64).sqrt();
        let field = |coefficients: &[f64], scale: f64| -> Vec<[f64; 3]> {
            (0..self.nodes())
                .map(|node| {
                    let mut vector = self.sphere.nodes[node].map(|x| scale * x);
                    for (mode, c) in self.modes.iter().zip(&coefficients[1..]) {
                        (0..3).for_each(|axis| vector[axis] += c * mode[node][axis]);
                    }
                    vector[0] += coefficients[0] / root;
                    vector
                })
                .collect()
        };
        [field(&alpha, parameters[1]), field(&rate, 0.0)]
    }

    /// The model file.
    pub fn file(&self) -> Vec<u8> {
        let mut arena = Arena::default();
        let contents = self.contents(&mut arena);
        write(&contents)
    }

    /// The contents of the model file; `arena` keeps its arrays.
    pub fn contents<'a>(&self, arena: &'a mut Arena) -> Contents<'a> {
        let sphere = &self.sphere;
        let sector = sphere.sector_nodes.len();
        let clusters = [(0.75, 0.9), (0.9, 1.2)];
        arena.build(|a| {
            a.u16s(sphere.elements.iter().flatten().copied());
            a.f32s(sphere.sector_nodes.iter().flat_map(|&n| sphere.nodes[usize::from(n)]));
            a.bytes(&[0, 1, 2, 3, 4, 5, 6, 7]);
            a.u16s(sphere.images());
            a.u16s(sphere.origins());
            a.u16s(sphere.midplane.iter().copied());
            a.u16s(sphere.diagonal.iter().copied());
            a.f32s(self.times.iter().map(|&t| f64::from(t)));
            a.f32s([1.0, 2.0]);
            // The same everywhere: then Ca is a quadratic in the kernel's coordinates too.
            a.f32s([0.75, 0.14, 0.9, 0.14, 1.2, 0.14]);
            a.f32s([0.05, 0.9, 0.003]);
            a.f32s([]);
            for (min, max) in clusters {
                let samples = self.cluster_samples(min, max);
                a.f32s(samples.iter().copied().flatten());
                a.f32s(samples.iter().flat_map(|[ca, confinement]| {
                    let limit: f64 = 0.14_f32.into();
                    [
                        KERNEL_SCALES[0] * ca.sqrt() / limit.powf(0.125),
                        KERNEL_SCALES[1] * confinement,
                    ]
                }));
                a.f32s((0..3).flat_map(|axis| {
                    let entry =
                        move |node: Option<&u16>, mode: &[[f64; 3]]| node.map_or(0.0, |&n| mode[usize::from(n)][axis]);
                    let row = move |place| {
                        let node = sphere.sector_nodes.get(place);
                        self.modes.iter().map(move |mode| entry(node, mode))
                    };
                    (0..padded(sector)).flat_map(row)
                }));
                a.f32s(self.knots());
                for (number, controls) in self.spans().into_iter().enumerate() {
                    // Each span has the functions in another order.
                    let turned = move |mut row: [f64; FUNCTIONS]| {
                        row.rotate_left(number);
                        row
                    };
                    a.f32s(samples.iter().flat_map(|&sample| turned(functions(sample))));
                    a.u16s(controls.clone().map(|_| 1));
                    a.f32s(
                        controls.flat_map(|b| (1..=padded(SHAPE_MODES)).flat_map(move |k| turned(self.control(k, b)))),
                    );
                }
                a.f32s((0..self.controls()).flat_map(|b| self.control(0, b)));
                a.f32s(samples.iter().flat_map(|&sample| functions(sample)));
                for _ in 0..2 {
                    a.f32s(samples.iter().flat_map(|_| [0.001, 0.002]));
                    a.f32s(samples.iter().map(|_| 0.01));
                    a.f32s([2.0, 3.0]);
                    a.f32s([0.5, 0.7]);
                }
                a.f32s(samples.iter().flat_map(|_| self.times[1..].iter().map(|_| 0.0)));
                a.f32s(self.times[1..].iter().map(|_| 1.5));
            }
        });
        let mut next = arena.arrays();
        let mut blob = || Blob::new(next.next().unwrap());
        let f32 = |rows: usize, columns: usize, blob: Blob<'a>| Matrix::f32(rows as u32, columns as u32, blob.data);
        let mesh = Mesh {
            nodes: self.nodes() as u32,
            element_nodes: 6,
            elements: blob(),
            reference: Reference::Sphere,
            sector_reference: f32(sector, 3, blob()),
            operations: blob(),
            images: blob(),
            origins: blob(),
            node_sets: [("midplane", blob()), ("diagonal", blob())]
                .into_iter()
                .map(|(name, nodes)| NodeSet { name, nodes })
                .collect(),
        };
        let (times, error_times) = (f32(self.times.len(), 1, blob()), f32(2, 1, blob()));
        let steady_limit = f32(3, 2, blob());
        let (bending_effect, border) = (f32(1, 3, blob()), f32(0, 2, blob()));
        let clusters = clusters.into_iter().map(|(min, max)| {
            let count = self.cluster_samples(min, max).len();
            let samples = Samples {
                parameters: f32(count, 2, blob()),
                places: f32(count, 2, blob()),
            };
            let controls = self.controls();
            let field = Field {
                modes: f32(3 * padded(sector), SHAPE_MODES, blob()),
                knots: f32(controls + 4, 1, blob()),
                spans: self
                    .spans()
                    .into_iter()
                    .map(|span| Span {
                        parameter_modes: f32(count, FUNCTIONS, blob()),
                        slices: blob(),
                        core: f32(span.len() * padded(SHAPE_MODES), FUNCTIONS, blob()),
                    })
                    .collect(),
                axial_controls: f32(controls, FUNCTIONS, blob()),
                axial_modes: f32(count, FUNCTIONS, blob()),
            };
            let mut errors = || Errors {
                left_out: f32(count, 2, blob()),
                deviation: f32(count, 1, blob()),
                bound_factors: f32(2, 1, blob()),
                changes: f32(2, 1, blob()),
                floor: 1e-5,
            };
            let (direct_errors, paper_errors) = (errors(), errors());
            let interval_errors = f32(count, self.times.len() - 1, blob());
            let interval_bound_factors = f32(self.times.len() - 1, 1, blob());
            Cluster {
                min,
                max,
                samples,
                field,
                direct_errors,
                paper_errors,
                interval_errors,
                interval_bound_factors,
            }
        });
        let clusters = clusters.collect();
        Contents {
            metadata: Metadata {
                title: "test family",
                units: Units {
                    length: "l",
                    velocity: "V",
                    time: "l/V",
                },
                membrane_law: "neo-Hookean",
                bending_stiffness: Some(1e-4),
                parameters: [("capillary_number", 0.005, 0.2), ("confinement", 0.75, 1.2)]
                    .into_iter()
                    .map(|(name, min, max)| Parameter {
                        name,
                        min,
                        max,
                        origin: 0.0,
                        scale: 1.0,
                    })
                    .collect(),
                database_digest: "",
                offline_settings: "{}",
                created_unix_s: 0,
            },
            mesh,
            times,
            error_times,
            steady_limit,
            bending_effect,
            border,
            default_method: Method::Direct,
            kernel: Kernel {
                neighbours: 24,
                scales: KERNEL_SCALES,
            },
            paper: Paper {
                neighbours: 12,
                scales: [1.9, 1.0, 1.0, 1.0],
                radius: 1.2,
                displacement_rank: 10,
                velocity_rank: 10,
                window: 2.0,
            },
            split: 1,
            clusters,
        }
    }

    fn cluster_samples(&self, min: f64, max: f64) -> Vec<[f64; 2]> {
        let inside = |sample: &&[f64; 2]| min - 1e-9 <= sample[1] && sample[1] <= max + 1e-9;
        let mut samples: Vec<[f64; 2]> = self.samples.iter().filter(inside).copied().collect();
        samples.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
        samples
    }

    /// The controls of two spans of time.
    fn spans(&self) -> [Range<usize>; 2] {
        let (middle, end) = (self.controls() / 3, self.controls());
        [0..middle, middle..end]
    }

    /// Controls of the splines: two a stored instant.
    pub fn controls(&self) -> usize {
        2 * self.times.len()
    }

    /// Each stored instant twice, the first and the last four times.
    fn knots(&self) -> Vec<f64> {
        let times = self.times.iter().map(|&t| f64::from(t));
        let last = self.times.len() - 1;
        times
            .enumerate()
            .flat_map(|(i, t)| std::iter::repeat_n(t, if i == 0 || i == last { 4 } else { 2 }))
            .collect()
    }

    /// Control `b` of coefficient `k` in the parameter functions: a third of an interval beside its stored instant
    /// along the tangent, so that the spline is the cubic with the values and rates at both ends. Zeros beyond the
    /// coefficients.
    fn control(&self, k: usize, b: usize) -> [f64; FUNCTIONS] {
        if k > SHAPE_MODES {
            return [0.0; FUNCTIONS];
        }
        let instant = |i: usize| f64::from(self.times[i]);
        let t = instant(b / 2);
        let [value, rate] = self.coefficient(k, t);
        let ahead = if b.is_multiple_of(2) {
            (b / 2).checked_sub(1).map_or(0.0, |before| instant(before) - t)
        } else {
            self.times.get(b / 2 + 1).map_or(0.0, |&after| f64::from(after) - t)
        };
        std::array::from_fn(|l| value[l] + ahead / 3.0 * rate[l])
    }
}

/// So many rows in whole panels of eight.
fn padded(rows: usize) -> usize {
    rows.next_multiple_of(8)
}

/// 1, a/l, (a/l)^2, Ca.
pub fn functions([capillary_number, confinement]: [f64; 2]) -> [f64; FUNCTIONS] {
    [1.0, confinement, confinement * confinement, capillary_number]
}

/// Scalar product of two fields.
pub fn product(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

/// Greatest distance between two sets of points.
pub fn distance<T: capsule_core::Real>(found: &[[T; 3]], exact: &[[f64; 3]]) -> f64 {
    assert_eq!(found.len(), exact.len());
    let one = |(a, b): (&[T; 3], &[f64; 3])| (0..3).map(|i| (a[i].to_f64() - b[i]).powi(2)).sum::<f64>().sqrt();
    found.iter().zip(exact).map(one).fold(0.0, f64::max)
}

/// The model file of some contents.
pub fn write(contents: &Contents<'_>) -> Vec<u8> {
    let mut buffer = vec![0; 16 << 20];
    let length = encode(contents, &mut buffer).unwrap();
    buffer.truncate(length);
    buffer
}

/// Keeps the arrays of a model's contents.
#[derive(Default)]
pub struct Arena {
    bytes: Vec<Vec<u8>>,
}

impl Arena {
    fn build(&mut self, fill: impl FnOnce(&mut Self)) {
        fill(self);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.bytes.push(bytes.to_vec());
    }

    fn u16s(&mut self, values: impl IntoIterator<Item = u16>) {
        self.bytes.push(values.into_iter().flat_map(u16::to_le_bytes).collect());
    }

    fn f32s(&mut self, values: impl IntoIterator<Item = f64>) {
        self.bytes.push(
            values
                .into_iter()
                .flat_map(|value| (value as f32).to_le_bytes())
                .collect(),
        );
    }

    fn arrays(&self) -> impl Iterator<Item = &[u8]> {
        self.bytes.iter().map(Vec::as_slice)
    }
}
