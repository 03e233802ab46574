//! Spherical harmonics as a space for vector fields on the reference sphere.
//!
//! With the channel's axis as polar axis, `r = (cos θ, sin θ cos φ, sin θ sin φ)`, each Cartesian component of a field
//! is a sum of `P_lm(cos θ) cos mφ` and `P_lm(cos θ) sin mφ` up to a degree. A field with the symmetry of the square
//! has m = 0, 4, 8 ... cosines in x, and odd m with one set of coefficients for y (cosines) and z (sines). The basis
//! fields are orthonormal in the scalar product of the sphere.

use std::f64::consts::PI;
use std::ops::Range;

/// One coefficient for each degree `l = order ..= degree`.
#[derive(Debug, Clone)]
pub struct Block {
    /// The order m.
    pub order: usize,
    /// Where its coefficients are.
    pub columns: Range<usize>,
    /// The components that they serve.
    pub terms: Vec<Term>,
}

/// The contribution of a [`Block`] to one component: `factor P_lm(cos θ)` times `cos mφ` or `sin mφ`.
#[derive(Debug, Clone, Copy)]
pub struct Term {
    /// x, y or z as 0, 1, 2.
    pub component: usize,
    /// Sine of `mφ` instead of cosine.
    pub sine: bool,
    /// Normalisation and sign.
    pub factor: f64,
}

impl Term {
    /// The azimuthal function and its derivative over m at angle `phi`.
    fn azimuthal(&self, order: usize, phi: f64) -> [f64; 2] {
        let (sine, cosine) = (order as f64 * phi).sin_cos();
        if self.sine {
            [self.factor * sine, self.factor * cosine]
        } else {
            [self.factor * cosine, -self.factor * sine]
        }
    }
}

/// The fields of components up to a degree, with or without the symmetry of the square.
#[derive(Debug, Clone)]
pub struct Harmonics {
    /// The greatest degree.
    pub degree: usize,
    /// The basis, by orders. The blocks of a [`Harmonics::sets`] entry stand together.
    pub blocks: Vec<Block>,
    /// Components with coefficients of their own: the components and the columns of their coefficients.
    pub sets: Vec<(Vec<usize>, Range<usize>)>,
}

impl Harmonics {
    /// All fields up to `degree`, or those with the symmetry of the square.
    pub fn new(degree: usize, symmetric: bool) -> Self {
        let mut space = Self {
            degree,
            blocks: Vec::new(),
            sets: Vec::new(),
        };
        let circle = |order: usize| if order == 0 { 2.0 * PI } else { PI };
        let term = |component, sine, factor| Term {
            component,
            sine,
            factor,
        };
        if symmetric {
            for order in (0..=degree).step_by(4) {
                space.push(order, vec![term(0, false, circle(order).sqrt().recip())]);
            }
            space.close(vec![0]);
            for order in (1..=degree).step_by(2) {
                // z is y with φ reflected at 45 degrees: cos m(π/2 - φ) = sin(mπ/2) sin mφ.
                let sign = if order % 4 == 1 { 1.0 } else { -1.0 };
                let factor = (2.0 * PI).sqrt().recip();
                space.push(order, vec![term(1, false, factor), term(2, true, sign * factor)]);
            }
            space.close(vec![1, 2]);
        } else {
            for component in 0..3 {
                for order in 0..=degree {
                    let factor = circle(order).sqrt().recip();
                    space.push(order, vec![term(component, false, factor)]);
                    if order > 0 {
                        space.push(order, vec![term(component, true, factor)]);
                    }
                }
                space.close(vec![component]);
            }
        }
        space
    }

    fn push(&mut self, order: usize, terms: Vec<Term>) {
        let start = self.len();
        let columns = start..start + self.degree + 1 - order;
        self.blocks.push(Block { order, columns, terms });
    }

    fn close(&mut self, components: Vec<usize>) {
        let start = self.sets.last().map_or(0, |(_, columns)| columns.end);
        self.sets.push((components, start..self.len()));
    }

    /// The columns that serve a component.
    pub fn columns_of(&self, component: usize) -> Range<usize> {
        self.sets
            .iter()
            .find(|(components, _)| components.contains(&component))
            .map_or(0..0, |(_, columns)| columns.clone())
    }

    /// The number of coefficients.
    pub fn len(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.columns.end)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The degree of each coefficient.
    pub fn degrees(&self) -> impl Iterator<Item = usize> {
        self.blocks.iter().flat_map(|block| block.order..=self.degree)
    }

    /// Value, derivative along θ, and derivative along φ over `sin θ`, of each basis field's `component` at a point of
    /// the unit sphere: for `function(column, [value, along θ, along φ])`.
    pub fn at(&self, point: [f64; 3], component: usize, mut function: impl FnMut(usize, [f64; 3])) {
        let [x, y, z] = point;
        let sine = y.hypot(z);
        let phi = if sine > 0.0 { z.atan2(y) } else { 0.0 };
        let legendre = Legendre::new(self.degree, x, sine);
        for block in &self.blocks {
            for term in block.terms.iter().filter(|term| term.component == component) {
                let [azimuthal, slope] = term.azimuthal(block.order, phi);
                for (column, [value, derivative, over_sine]) in block.columns.clone().zip(legendre.order(block.order)) {
                    function(column, [value * azimuthal, derivative * azimuthal, over_sine * slope]);
                }
            }
        }
    }
}

/// Associated Legendre functions at one angle, normalised: `int P_lm² d cos θ = 1`.
struct Legendre {
    degree: usize,
    /// By order, then degree: `P`, `dP/dθ`, `m P / sin θ`.
    entries: Vec<[f64; 3]>,
}

impl Legendre {
    fn new(degree: usize, cosine: f64, sine: f64) -> Self {
        // P_lm / sin θ for m >= 1, from which all follows without a division; P_l0 for m = 0.
        let mut reduced = vec![vec![0.0; degree + 1]; degree + 2];
        let mut diagonal = 0.5_f64.sqrt();
        for m in 0..=degree {
            if m > 0 {
                diagonal *= ((2 * m + 1) as f64 / (2 * m) as f64).sqrt() * if m > 1 { sine } else { 1.0 };
            }
            reduced[m][m] = diagonal;
            for l in m + 1..=degree {
                let (lf, mf) = (l as f64, m as f64);
                let a = ((4.0 * lf * lf - 1.0) / (lf * lf - mf * mf)).sqrt();
                let below = if l > m + 1 {
                    let p = lf - 1.0;
                    ((p * p - mf * mf) / (4.0 * p * p - 1.0)).sqrt() * reduced[m][l - 2]
                } else {
                    0.0
                };
                reduced[m][l] = a * (cosine * reduced[m][l - 1] - below);
            }
        }
        let value = |m: usize, l: usize| if m == 0 { reduced[0][l] } else { sine * reduced[m][l] };
        let mut entries = Vec::new();
        for m in 0..=degree {
            for l in m..=degree {
                let over_sine = if m == 0 { 0.0 } else { m as f64 * reduced[m][l] };
                // dP_l^m/dθ = m cot θ P_l^m - P_l^(m+1), without the Condon-Shortley sign.
                let next = if l > m { value(m + 1, l) } else { 0.0 };
                let derivative = cosine * over_sine - (((l - m) * (l + m + 1)) as f64).sqrt() * next;
                entries.push([value(m, l), derivative, over_sine]);
            }
        }
        Self { degree, entries }
    }

    /// The entries of order `m`, by rising degree.
    fn order(&self, m: usize) -> impl Iterator<Item = [f64; 3]> {
        let start = m * (2 * self.degree + 3 - m) / 2;
        self.entries[start..start + self.degree + 1 - m].iter().copied()
    }
}

/// A product rule on the sphere: Gauss-Legendre in `cos θ`, equal angles φ; an eighth of them if symmetric.
#[derive(Debug, Clone)]
pub struct Grid {
    /// For each polar angle its weight, symmetry included: solid angle a point stands for.
    weights: Vec<f64>,
    azimuths: usize,
    tables: Vec<Table>,
}

/// A [`Block`] on the [`Grid`].
#[derive(Debug, Clone)]
struct Table {
    columns: Range<usize>,
    /// For each polar angle, `dP/dθ` and `m P / sin θ` of all degrees.
    polar: [Vec<f64>; 2],
    /// For each term its component and, for each azimuth, function and slope.
    terms: Vec<(usize, [Vec<f64>; 2])>,
}

/// The two tangential derivatives of a vector field at the grid's points, along θ and along φ: for each component the
/// values of all points, polar angle by polar angle.
pub type Tangents = [[Vec<f64>; 3]; 2];

impl Grid {
    /// Points enough for products of three fields of `space`.
    pub fn new(space: &Harmonics, symmetric: bool) -> Self {
        let polar = 3 * space.degree / 2 + 4;
        let eighths = (3 * space.degree).div_ceil(8) + 1;
        let (azimuths, images) = if symmetric { (eighths, 8) } else { (8 * eighths, 1) };
        let (cosines, weights) = crate::flow::quadrature::gauss_legendre(polar);
        let spacing = PI / (4 * eighths) as f64;
        let legendre: Vec<Legendre> = cosines
            .iter()
            .map(|&x| Legendre::new(space.degree, x, ((1.0 - x) * (1.0 + x)).sqrt()))
            .collect();
        let table = |block: &Block| Table {
            columns: block.columns.clone(),
            polar: [1, 2].map(|kind| {
                legendre
                    .iter()
                    .flat_map(|angle| angle.order(block.order).map(move |entry| entry[kind]))
                    .collect()
            }),
            terms: block
                .terms
                .iter()
                .map(|term| {
                    let at = |k: usize| term.azimuthal(block.order, (k as f64 + 0.5) * spacing);
                    (
                        term.component,
                        [0, 1].map(|kind| (0..azimuths).map(|k| at(k)[kind]).collect()),
                    )
                })
                .collect(),
        };
        Self {
            weights: weights.iter().map(|w| w * spacing * f64::from(images)).collect(),
            azimuths,
            tables: space.blocks.iter().map(table).collect(),
        }
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.weights.len() * self.azimuths
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The solid angle of a point.
    pub fn weight(&self, point: usize) -> f64 {
        self.weights[point / self.azimuths]
    }

    /// The tangential derivatives of the field with these coefficients.
    pub fn tangents(&self, coefficients: &[f64], out: &mut Tangents) {
        for values in out.as_flattened_mut() {
            values.clear();
            values.resize(self.len(), 0.0);
        }
        for table in &self.tables {
            let coefficients = &coefficients[table.columns.clone()];
            for polar in 0..self.weights.len() {
                let points = polar * self.azimuths..(polar + 1) * self.azimuths;
                for kind in 0..2 {
                    let amplitude = dot(table.row(kind, polar), coefficients);
                    for (component, azimuthal) in &table.terms {
                        let values = &mut out[kind][*component][points.clone()];
                        for (value, azimuthal) in values.iter_mut().zip(&azimuthal[kind]) {
                            *value += amplitude * azimuthal;
                        }
                    }
                }
            }
        }
    }

    /// The transpose of [`Grid::tangents`]: for each coefficient the sum over the points of `flux` times the
    /// derivatives of its basis field.
    pub fn moments(&self, flux: &Tangents, out: &mut [f64]) {
        out.fill(0.0);
        for table in &self.tables {
            let sums = &mut out[table.columns.clone()];
            for polar in 0..self.weights.len() {
                let points = polar * self.azimuths..(polar + 1) * self.azimuths;
                for kind in 0..2 {
                    let amplitude: f64 = table
                        .terms
                        .iter()
                        .map(|(component, azimuthal)| dot(&flux[kind][*component][points.clone()], &azimuthal[kind]))
                        .sum();
                    for (sum, entry) in sums.iter_mut().zip(table.row(kind, polar)) {
                        *sum += amplitude * entry;
                    }
                }
            }
        }
    }
}

impl Table {
    fn row(&self, kind: usize, polar: usize) -> &[f64] {
        let count = self.columns.len();
        &self.polar[kind][polar * count..(polar + 1) * count]
    }
}

/// Four sums side by side, which the compiler may turn into vector instructions.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<4>();
    let (b, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field with the symmetry of the square, of degree 3.
    fn field([x, y, z]: [f64; 3]) -> [f64; 3] {
        [1.0 + x * x * x, y * (x + z * z), z * (x + y * y)]
    }

    /// The coefficients of `field` by quadrature on the full grid, without the routines under test.
    fn coefficients(space: &Harmonics) -> Vec<f64> {
        let (cosines, weights) = crate::flow::quadrature::gauss_legendre(20);
        let mut out = vec![0.0; space.len()];
        for (x, w) in cosines.into_iter().zip(weights) {
            for k in 0..40 {
                let phi = PI * f64::from(k) / 20.0;
                let sine = (1.0 - x * x).sqrt();
                let point = [x, sine * phi.cos(), sine * phi.sin()];
                let value = field(point);
                for component in 0..3 {
                    space.at(point, component, |column, [basis, _, _]| {
                        out[column] += w * PI / 20.0 * basis * value[component];
                    });
                }
            }
        }
        out
    }

    #[test]
    fn a_polynomial_field_is_recovered_with_its_derivatives() {
        for symmetric in [true, false] {
            let space = Harmonics::new(6, symmetric);
            let coefficients = coefficients(&space);
            // The poles too.
            for point in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.6, 0.64, 0.48], [-0.28, 0.0, 0.96]] {
                let [x, y, z]: [f64; 3] = point;
                let sine = y.hypot(z);
                let (cosine_phi, sine_phi) = if sine > 0.0 { (y / sine, z / sine) } else { (1.0, 0.0) };
                let along_theta = [-sine, x * cosine_phi, x * sine_phi];
                let along_phi = [0.0, -sine_phi, cosine_phi];
                let slope = |direction: [f64; 3], component: usize| {
                    let step = 1e-5;
                    let at = |s: f64| field([0, 1, 2].map(|d| point[d] + s * direction[d]))[component];
                    (at(step) - at(-step)) / (2.0 * step)
                };
                for component in 0..3 {
                    let mut sums = [0.0; 3];
                    space.at(point, component, |column, basis| {
                        for k in 0..3 {
                            sums[k] += coefficients[column] * basis[k];
                        }
                    });
                    let exact = [
                        field(point)[component],
                        slope(along_theta, component),
                        slope(along_phi, component),
                    ];
                    for k in 0..3 {
                        assert!((sums[k] - exact[k]).abs() < 1e-8, "{point:?} {sums:?} {exact:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn an_eighth_of_the_grid_gives_the_moments_of_the_whole() {
        let space = Harmonics::new(7, true);
        let coefficients: Vec<f64> = (0..space.len()).map(|i| (i as f64).sin()).collect();
        let moments = [true, false].map(|eighth| {
            let grid = Grid::new(&space, eighth);
            let mut tangents = Tangents::default();
            grid.tangents(&coefficients, &mut tangents);
            for values in tangents.as_flattened_mut() {
                for (point, value) in values.iter_mut().enumerate() {
                    *value *= grid.weight(point);
                }
            }
            let mut out = vec![0.0; space.len()];
            grid.moments(&tangents, &mut out);
            out
        });
        // The Laplace-Beltrami operator: the harmonics are its eigenfunctions.
        for (((eighth, whole), c), l) in moments[0]
            .iter()
            .zip(&moments[1])
            .zip(&coefficients)
            .zip(space.degrees())
        {
            let exact = (l * (l + 1)) as f64 * c;
            assert!(
                (eighth - exact).abs() < 1e-11 && (whole - exact).abs() < 1e-11,
                "{eighth} {whole} {exact}"
            );
        }
    }
}
