//! The membrane with its shape in spherical harmonics of the reference sphere.
//!
//! The shape `x = sum c_k B_k` is smooth, so the load is found without the kinks of finite elements: the weak form
//! `int w . q dS = int eps(w) : T dS` is tested with the basis fields `B_k` themselves, and solved for the load per
//! reference area, `q J_s = sum r_k B_k`, which the orthonormal basis makes explicit. The mesh only carries nodes:
//! positions and velocities are projected from its nodes to the harmonics by least squares.
//!
//! A membrane that is compressed buckles at the shortest wavelength there is, and no discretisation converges. A
//! small resistance to bending gives the wavelength: the displacement from the sphere has the energy
//! `(B / 2 a²) sum (l-1) l (l+1) (l+2) c_k²`, `B/2 int |Laplacian u|² dA` for short waves; linear maps, and so
//! rotations, are free.

use crate::harmonics::{Grid, Harmonics, Tangents};
use crate::surface::Patch;
use crate::vectors::{metric, norm};
use crate::{EvaluationError, FomError, MembraneLaw, Mesh, Symmetry};
use faer::linalg::solvers::SolveCore;
use faer::{Mat, Side};
use nalgebra::Vector3;

/// The membrane of the unit sphere, in harmonics.
#[derive(Debug, Clone)]
pub struct HarmonicMembrane {
    space: Harmonics,
    grid: Grid,
    law: MembraneLaw,
    /// Bending stiffness over `G_s a²`.
    bending: f64,
    /// At the sector's nodes: values, derivatives along θ and along φ of the basis.
    nodal: [NodalBasis; 3],
    projections: Vec<Projection>,
    /// Reference area of each node of the sector, `int phi_i dA`.
    areas: Vec<f64>,
}

/// Basis fields at the sector's nodes; for each component the columns that serve it, one after the other.
#[derive(Debug, Clone)]
struct NodalBasis([Vec<f64>; 3]);

/// Least squares from nodal values to the coefficients of one set, node by node: for each of its components the
/// influence of every node.
#[derive(Debug, Clone)]
struct Projection {
    components: Vec<usize>,
    columns: std::ops::Range<usize>,
    /// For each component and node, a row over the columns.
    influence: Vec<Vec<f64>>,
}

/// The workspace of an evaluation, and its results.
#[derive(Debug, Clone, Default)]
pub struct HarmonicState {
    /// Coefficients of the shape.
    shape: Vec<f64>,
    /// Coefficients of the load per reference area (of the unit sphere), `r_k`.
    load: Vec<f64>,
    tangents: Tangents,
    flux: Tangents,
    nodal: [Vec<[f64; 3]>; 2],
    /// Unit outward normals at the sector's nodes.
    pub normals: Vec<[f64; 3]>,
}

/// Surface elements below this area ratio are treated as collapsed.
const MIN_AREA_RATIO: f64 = 1e-3;

impl HarmonicMembrane {
    /// Harmonics up to `degree` on the sector of `mesh`, for a membrane of `law` with bending stiffness `bending` (over
    /// `G_s a²`).
    ///
    /// # Errors
    /// [`FomError::Degree`] if the mesh's nodes cannot tell the harmonics apart.
    pub fn new(
        mesh: &Mesh,
        symmetry: &Symmetry,
        patch: &Patch,
        degree: usize,
        (law, bending): (MembraneLaw, f64),
    ) -> Result<Self, FomError> {
        let symmetric = symmetry.order > 1;
        let space = Harmonics::new(degree, symmetric);
        let points: Vec<[f64; 3]> = symmetry.sector.iter().map(|&node| mesh.nodes[node as usize]).collect();
        let nodal = NodalBasis::all(&space, &points);
        let projections = space
            .sets
            .iter()
            .map(|(components, columns)| {
                let basis = |component: usize| &nodal[0].0[component];
                Projection::new(components, columns.clone(), &patch.multiplicities, basis)
            })
            .collect::<Option<_>>()
            .ok_or(FomError::Degree { degree })?;
        let mut areas = vec![[0.0; 3]; points.len()];
        patch.assemble(&mesh.nodes, &mut areas, |_, x| {
            let mut sum = [Vector3::zeros(); 6];
            for point in patch.points() {
                let area = point.weight * point.area(x);
                for i in 0..6 {
                    sum[i].x += area * point.value[i];
                }
            }
            sum
        });
        Ok(Self {
            grid: Grid::new(&space, symmetric),
            law,
            bending,
            nodal,
            projections,
            areas: areas.into_iter().map(|[area, _, _]| area).collect(),
            space,
        })
    }

    /// The load at the sector's nodes of the shape through `nodes` (sector), the stress-free state being the sphere of
    /// `radius`: the traction jump `q` over `G_s`, and the nodal forces that stand for it in integrals over the
    /// reference mesh.
    ///
    /// # Errors
    /// [`EvaluationError::Collapsed`] where the area vanishes or is not finite.
    pub fn load(
        &self,
        nodes: &[[f64; 3]],
        radius: f64,
        state: &mut HarmonicState,
        traction: &mut [[f64; 3]],
        force: &mut [[f64; 3]],
    ) -> Result<(), EvaluationError> {
        state.shape.resize(self.space.len(), 0.0);
        state.load.resize(self.space.len(), 0.0);
        self.project(nodes, &mut state.shape);
        self.grid.tangents(&state.shape, &mut state.tangents);
        self.stress(radius, &state.tangents, &mut state.flux)?;
        self.grid.moments(&state.flux, &mut state.load);
        for ((load, shape), l) in state.load.iter_mut().zip(&state.shape).zip(self.space.degrees()) {
            let l = l as f64;
            *load += self.bending * (l - 1.0) * l * (l + 1.0) * (l + 2.0) * shape;
        }

        self.nodal[0].values(&self.space, &state.load, traction);
        for (kind, values) in state.nodal.iter_mut().enumerate() {
            values.resize(nodes.len(), [0.0; 3]);
            self.nodal[kind + 1].values(&self.space, &state.shape, values);
        }
        state.normals.clear();
        let [along_theta, along_phi] = &state.nodal;
        for (i, (t1, t2)) in along_theta.iter().zip(along_phi).enumerate() {
            let normal = Vector3::from(*t1).cross(&Vector3::from(*t2));
            let area = norm(normal);
            state.normals.push((normal / area).into());
            force[i] = traction[i].map(|c| c * self.areas[i]);
            traction[i] = traction[i].map(|c| c / area);
        }
        Ok(())
    }

    /// `S^ab x_,b` at the grid's points, times their solid angles.
    fn stress(&self, radius: f64, tangents: &Tangents, flux: &mut Tangents) -> Result<(), EvaluationError> {
        for values in flux.as_flattened_mut() {
            values.resize(self.grid.len(), 0.0);
        }
        let mut least = f64::INFINITY;
        let [[x1, y1, z1], [x2, y2, z2]] = tangents;
        for point in 0..self.grid.len() {
            let t1 = Vector3::new(x1[point], y1[point], z1[point]);
            let t2 = Vector3::new(x2[point], y2[point], z2[point]);
            let ([m11, m22, m12], determinant) = metric([t1, t2]);
            // J_s², the metric of the stress-free state being radius² times the identity.
            let ratio = determinant / radius.powi(4);
            least = if ratio >= least { least } else { ratio };
            let weight = self.grid.weight(point);
            let trace = (m11 + m22) / (radius * radius);
            let [push, pull] = self.law.factors(trace, ratio, radius * radius, determinant);
            let s11 = weight * (push - pull * m22);
            let s22 = weight * (push - pull * m11);
            let s12 = weight * pull * m12;
            for d in 0..3 {
                flux[0][d][point] = s11 * t1[d] + s12 * t2[d];
                flux[1][d][point] = s12 * t1[d] + s22 * t2[d];
            }
        }
        if least > MIN_AREA_RATIO * MIN_AREA_RATIO && least.is_finite() {
            Ok(())
        } else {
            Err(EvaluationError::Collapsed {
                area_ratio: least.sqrt(),
            })
        }
    }

    /// The coefficients of a field given at the sector's nodes.
    fn project(&self, field: &[[f64; 3]], coefficients: &mut [f64]) {
        coefficients.fill(0.0);
        for projection in &self.projections {
            let out = &mut coefficients[projection.columns.clone()];
            for (component, influence) in projection.components.iter().zip(&projection.influence) {
                for (value, row) in field.iter().zip(influence.chunks_exact(out.len())) {
                    add_scaled(out, value[*component], row);
                }
            }
        }
    }

    /// Replaces a field at the sector's nodes by its projection on the harmonics.
    pub fn filter(&self, state: &mut HarmonicState, field: &mut [[f64; 3]]) {
        self.project(field, &mut state.load);
        self.nodal[0].values(&self.space, &state.load, field);
    }
}

impl NodalBasis {
    fn all(space: &Harmonics, points: &[[f64; 3]]) -> [Self; 3] {
        let mut bases = [(); 3]
            .map(|()| Self([0, 1, 2].map(|component| vec![0.0; points.len() * space.columns_of(component).len()])));
        for (node, &point) in points.iter().enumerate() {
            for component in 0..3 {
                let start = space.columns_of(component).start;
                space.at(point, component, |column, entry| {
                    for (basis, value) in bases.iter_mut().zip(entry) {
                        basis.0[component][(column - start) * points.len() + node] = value;
                    }
                });
            }
        }
        bases
    }

    fn values(&self, space: &Harmonics, coefficients: &[f64], out: &mut [[f64; 3]]) {
        let mut values = vec![0.0; out.len()];
        for component in 0..3 {
            values.fill(0.0);
            let columns = self.0[component].chunks_exact(out.len());
            for (column, &coefficient) in columns.zip(&coefficients[space.columns_of(component)]) {
                add_scaled(&mut values, coefficient, column);
            }
            for (out, value) in out.iter_mut().zip(&values) {
                out[component] = *value;
            }
        }
    }
}

impl Projection {
    /// Solves the normal equations, weighted by the nodes' multiplicities; none if they are singular.
    fn new<'a>(
        components: &[usize],
        columns: std::ops::Range<usize>,
        weights: &[f64],
        basis: impl Fn(usize) -> &'a Vec<f64>,
    ) -> Option<Self> {
        let (nodes, size) = (weights.len(), columns.len());
        let matrices: Vec<Mat<f64>> = components
            .iter()
            .map(|&component| Mat::from_fn(nodes, size, |i, k| basis(component)[k * nodes + i] * weights[i].sqrt()))
            .collect();
        let mut gram = Mat::<f64>::zeros(size, size);
        for matrix in &matrices {
            gram += matrix.transpose() * matrix;
        }
        // The basis is orthonormal: with nodes enough the Gram matrix is nearly a multiple of the identity.
        let (least, greatest) = gram.self_adjoint_eigenvalues(Side::Lower).ok().map(extremes)?;
        if least.is_nan() || least < 1e-2 * greatest {
            return None;
        }
        let cholesky = gram.llt(Side::Lower).ok()?;
        let influence = matrices
            .iter()
            .map(|matrix| {
                let mut rows = Mat::from_fn(size, nodes, |k, i| matrix[(i, k)] * weights[i].sqrt());
                cholesky.solve_in_place_with_conj(faer::Conj::No, rows.as_mut());
                (0..nodes)
                    .flat_map(|i| (0..size).map(move |k| (k, i)))
                    .map(|index| rows[index])
                    .collect()
            })
            .collect();
        Some(Self {
            components: components.to_vec(),
            columns,
            influence,
        })
    }
}

fn extremes(values: Vec<f64>) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, 0.0), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

fn add_scaled(out: &mut [f64], factor: f64, row: &[f64]) {
    for (out, entry) in out.iter_mut().zip(row) {
        *out += factor * entry;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::tests::{LAWS, exact_pressure};

    /// Traction of the shape through `nodes` of the whole mesh, the stress-free radius being 0.9.
    fn traction(mesh: &Mesh, law: MembraneLaw, nodes: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let symmetry = Symmetry::unreduced(mesh);
        let patch = Patch::new(mesh, &symmetry);
        let membrane = HarmonicMembrane::new(mesh, &symmetry, &patch, 12, (law, 0.0)).unwrap();
        let mut traction = vec![[0.0; 3]; nodes.len()];
        let mut force = traction.clone();
        let mut state = HarmonicState::default();
        membrane
            .load(nodes, 0.9, &mut state, &mut traction, &mut force)
            .unwrap();
        traction
    }

    #[test]
    fn inflated_sphere_has_the_exact_pressure() {
        let mesh = Mesh::octahedral(4).unwrap();
        for law in LAWS {
            for stretch in [0.9, 1.1, 1.5] {
                let nodes: Vec<_> = mesh.nodes.iter().map(|n| n.map(|x| 0.9 * stretch * x)).collect();
                let exact = exact_pressure(law, stretch) / 0.9;
                let tractions = traction(&mesh, law, &nodes);
                for (traction, normal) in tractions.iter().zip(&mesh.nodes) {
                    let error = norm(Vector3::from(*traction) / exact - Vector3::from(*normal));
                    assert!(error < 1e-10, "{law}: {error}");
                }
            }
        }
    }
}
