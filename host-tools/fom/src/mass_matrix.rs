//! The consistent mass matrix `M_ij = int phi_i phi_j dS` of the current surface, and the nodal load `q = M^-1 r`
//! (Walter, Salsac, Barthès-Biesel, Le Tallec, Int. J. Numer. Methods Eng. 83, 2010).

use nalgebra::Vector3;

use crate::surface::Patch;
use crate::{EvaluationError, Symmetry};

/// Work space of the solution, by conjugate gradients on the sector.
///
/// The sector's equations are those of the full mesh with a symmetric right-hand side; in the full mesh's inner
/// product ([`Patch::dot`]) the reduced operator stays symmetric.
#[derive(Debug, Clone)]
pub struct MassMatrix {
    /// Element matrices of the patch.
    local: Vec<[[f64; 6]; 6]>,
    inverse_diagonal: Vec<[f64; 3]>,
    full: Vec<[f64; 3]>,
    residual: Vec<[f64; 3]>,
    direction: Vec<[f64; 3]>,
    product: Vec<[f64; 3]>,
}

/// The residual is reduced by this factor: to round-off, so that the load is a function of the positions alone.
const REDUCTION: f64 = 1e-13;
/// A quadratic mass matrix scaled by its diagonal needs 20 to 50 iterations, whatever the mesh.
const ITERATION_LIMIT: usize = 400;

impl MassMatrix {
    /// Work space for `patch`.
    pub fn new(patch: &Patch) -> Self {
        let sector = vec![[0.0; 3]; patch.multiplicities.len()];
        Self {
            local: vec![[[0.0; 6]; 6]; patch.elements.len()],
            inverse_diagonal: sector.clone(),
            full: Vec::new(),
            residual: sector.clone(),
            direction: sector.clone(),
            product: sector,
        }
    }

    /// Solves `M q = r` for `load = r` and `traction = q` on the sector, with `M` of the surface through `nodes`
    /// (full mesh).
    ///
    /// # Errors
    /// [`EvaluationError::MassMatrix`] if the iteration does not converge.
    pub fn solve(
        &mut self,
        patch: &Patch,
        symmetry: &Symmetry,
        nodes: &[[f64; 3]],
        load: &[[f64; 3]],
        traction: &mut [[f64; 3]],
    ) -> Result<(), EvaluationError> {
        self.assemble(patch, nodes);
        self.full.resize(nodes.len(), [0.0; 3]);
        traction.fill([0.0; 3]);
        self.residual.copy_from_slice(load);
        let target = REDUCTION * REDUCTION * patch.dot(load, load);
        let mut energy = 0.0;
        for iteration in 0..ITERATION_LIMIT {
            let residual = patch.dot(&self.residual, &self.residual);
            if residual <= target {
                return Ok(());
            }
            // The preconditioned residual is kept in `product` until the product itself is formed.
            for ((p, r), d) in self.product.iter_mut().zip(&self.residual).zip(&self.inverse_diagonal) {
                *p = [0, 1, 2].map(|c| r[c] * d[c]);
            }
            let previous = std::mem::replace(&mut energy, patch.dot(&self.residual, &self.product));
            let momentum = if iteration == 0 { 0.0 } else { energy / previous };
            for (d, p) in self.direction.iter_mut().zip(&self.product) {
                *d = [0, 1, 2].map(|c| p[c] + momentum * d[c]);
            }
            self.multiply(patch, symmetry);
            let step = energy / patch.dot(&self.direction, &self.product);
            if !step.is_finite() {
                break;
            }
            for (i, (q, r)) in traction.iter_mut().zip(&mut self.residual).enumerate() {
                for c in 0..3 {
                    q[c] += step * self.direction[i][c];
                    r[c] -= step * self.product[i][c];
                }
            }
        }
        Err(EvaluationError::MassMatrix {
            iterations: ITERATION_LIMIT,
        })
    }

    fn assemble(&mut self, patch: &Patch, nodes: &[[f64; 3]]) {
        let local = &mut self.local;
        patch.assemble(nodes, &mut self.inverse_diagonal, |element, x| {
            let mut matrix = [[0.0; 6]; 6];
            for point in patch.points() {
                let area = point.weight * point.area(x);
                for i in 0..6 {
                    let scaled = area * point.value[i];
                    for j in 0..6 {
                        matrix[i][j] += scaled * point.value[j];
                    }
                }
            }
            local[element] = matrix;
            [0, 1, 2, 3, 4, 5].map(|i| Vector3::repeat(matrix[i][i]))
        });
        for d in &mut self.inverse_diagonal {
            *d = d.map(f64::recip);
        }
    }

    /// `product = M direction`, on the sector.
    fn multiply(&mut self, patch: &Patch, symmetry: &Symmetry) {
        symmetry.expand(&self.direction, &mut self.full);
        let local = &self.local;
        patch.assemble(&self.full, &mut self.product, |element, x| {
            let mut sum = [Vector3::zeros(); 6];
            for (sum, row) in sum.iter_mut().zip(&local[element]) {
                for (entry, x) in row.iter().zip(x) {
                    *sum += *entry * x;
                }
            }
            sum
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mesh;

    #[test]
    fn recovers_a_field_from_its_load_on_sector_and_full_mesh() {
        let mesh = Mesh::octahedral(5).unwrap();
        let nodes: Vec<_> = mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| [1.5 * x, 0.8 * y, 0.8 * z])
            .collect();
        // A smooth field with the square's symmetry.
        let field = |[x, y, z]: [f64; 3]| [1.0 + x * x, y * (x + z * z), z * (x + y * y)];
        for symmetry in [Symmetry::unreduced(&mesh), Symmetry::reduced(&mesh).unwrap()] {
            let patch = Patch::new(&mesh, &symmetry);
            let mut matrix = MassMatrix::new(&patch);
            matrix.assemble(&patch, &nodes);
            matrix.full.resize(nodes.len(), [0.0; 3]);
            matrix.direction = symmetry.sector.iter().map(|&i| field(nodes[i as usize])).collect();
            matrix.multiply(&patch, &symmetry);
            let load = matrix.product.clone();
            let mut solution = vec![[0.0; 3]; load.len()];
            matrix.solve(&patch, &symmetry, &nodes, &load, &mut solution).unwrap();
            for (q, &i) in solution.iter().zip(&symmetry.sector) {
                let exact = field(nodes[i as usize]);
                assert!((0..3).all(|d| (q[d] - exact[d]).abs() < 1e-11));
            }
        }
    }

    #[test]
    fn entries_sum_to_the_area() {
        let mesh = Mesh::octahedral(6).unwrap();
        let symmetry = Symmetry::reduced(&mesh).unwrap();
        let patch = Patch::new(&mesh, &symmetry);
        let mut matrix = MassMatrix::new(&patch);
        matrix.assemble(&patch, &mesh.nodes);
        matrix.full.resize(mesh.nodes.len(), [0.0; 3]);
        matrix.direction = vec![[1.0, 0.0, 0.0]; symmetry.sector.len()];
        matrix.multiply(&patch, &symmetry);
        let area = patch.dot(&matrix.product, &matrix.direction);
        assert!((area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3, "{area}");
    }
}
