//! Integrals over the current six-node surface: volume and its gradient, first moment, nodal normals.
//!
//! All are assembled at the sector's nodes alone, from the elements that touch the sector.

use nalgebra::{Matrix3, Vector3};

use crate::shape_functions::{Point, nodes_of, quadrature};
use crate::vectors::norm;
use crate::{Mesh, Symmetry};

/// The elements that touch the sector, and where their nodal values go.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Node indices (into the full mesh) of the elements.
    pub elements: Vec<[u32; 6]>,
    /// For each of those nodes its index in the sector, or [`Patch::OUTSIDE`].
    rows: Vec<[u32; 6]>,
    /// Number of mesh nodes that each sector node represents.
    pub multiplicities: Vec<f64>,
    points: [Point; 12],
    nodal_points: [Point; 6],
}

/// Geometry at each sector node for the volume constraint and the moving frame.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// Derivative of the enclosed volume with respect to the node's position, `dV/dx_i`.
    pub volume_gradient: Vec<[f64; 3]>,
    /// `int x phi_i n dS`: its product with the nodal velocities is the rate of the volume's axial first moment.
    pub moment_gradient: Vec<[f64; 3]>,
    /// Unit outward normals, averaged over the adjacent elements.
    pub normals: Vec<[f64; 3]>,
    /// The enclosed volume, exact for the six-node surface.
    pub volume: f64,
}

impl Patch {
    const OUTSIDE: u32 = u32::MAX;

    /// The elements of `mesh` that touch the sector of `symmetry`.
    pub fn new(mesh: &Mesh, symmetry: &Symmetry) -> Self {
        let mut row_of = vec![Self::OUTSIDE; mesh.nodes.len()];
        for (row, &node) in (0..).zip(&symmetry.sector) {
            row_of[node as usize] = row;
        }
        let (elements, rows) = mesh
            .elements
            .iter()
            .map(|&element| (element, element.map(|node| row_of[node as usize])))
            .filter(|(_, rows)| rows.iter().any(|&row| row != Self::OUTSIDE))
            .unzip();
        Self {
            elements,
            rows,
            multiplicities: symmetry.multiplicities(),
            points: quadrature(),
            nodal_points: Point::at_nodes(),
        }
    }

    /// The quadrature points of every element integral.
    pub fn points(&self) -> &[Point; 12] {
        &self.points
    }

    /// Sums the elements' nodal vectors `local(element of the patch, its nodes)` at the sector's nodes.
    ///
    /// `nodes` has one position for each node of the full mesh, `out` one vector for each node of the sector.
    pub fn assemble(
        &self,
        nodes: &[[f64; 3]],
        out: &mut [[f64; 3]],
        mut local: impl FnMut(usize, &[Vector3<f64>; 6]) -> [Vector3<f64>; 6],
    ) {
        out.fill([0.0; 3]);
        for (index, (element, rows)) in self.elements.iter().zip(&self.rows).enumerate() {
            let contribution = local(index, &nodes_of(element, nodes));
            for (row, vector) in rows.iter().zip(contribution) {
                // `OUTSIDE` is no index of the sector.
                if let Some(sum) = out.get_mut(*row as usize) {
                    *sum = (Vector3::from(*sum) + vector).into();
                }
            }
        }
    }

    /// The inner product over the full mesh of two fields of the sector.
    pub fn dot(&self, a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
        self.multiplicities
            .iter()
            .zip(a)
            .zip(b)
            .map(|((m, a), b)| m * Vector3::from(*a).dot(&Vector3::from(*b)))
            .sum()
    }

    /// Volume, volume gradient, first-moment gradient and normals of the surface through `nodes` (full mesh).
    pub fn geometry(&self, nodes: &[[f64; 3]], sector: &[u32], geometry: &mut Geometry) {
        let size = self.multiplicities.len();
        geometry.volume_gradient.resize(size, [0.0; 3]);
        geometry.moment_gradient.resize(size, [0.0; 3]);
        geometry.normals.resize(size, [0.0; 3]);
        self.assemble(nodes, &mut geometry.volume_gradient, |_, x| self.integrate(x, |_| 1.0));
        self.assemble(nodes, &mut geometry.moment_gradient, |_, x| {
            self.integrate(x, |position| position[0])
        });
        self.assemble(nodes, &mut geometry.normals, |_, x| {
            self.nodal_points.map(|point| point.normal(x))
        });
        for normal in &mut geometry.normals {
            let vector = Vector3::from(*normal);
            *normal = (vector / norm(vector)).into();
        }
        // The volume is homogeneous of degree three in the positions (Euler).
        geometry.volume = self
            .multiplicities
            .iter()
            .zip(sector)
            .zip(&geometry.volume_gradient)
            .map(|((m, &node), gradient)| m * Vector3::from(nodes[node as usize]).dot(&Vector3::from(*gradient)) / 3.0)
            .sum();
    }

    /// `int weight(x) phi_i n dS` over one element, for its six nodes.
    fn integrate(&self, nodes: &[Vector3<f64>; 6], weight: impl Fn(Vector3<f64>) -> f64) -> [Vector3<f64>; 6] {
        let mut sum = [Vector3::zeros(); 6];
        for point in &self.points {
            let normal = point.weight * weight(point.interpolate(nodes)) * point.normal(nodes);
            for (sum, value) in sum.iter_mut().zip(point.value) {
                *sum += value * normal;
            }
        }
        sum
    }
}

/// Moments of the enclosed volume up to the second, for a whole closed surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Enclosed volume, exact for six-node elements.
    pub volume: f64,
    /// Volume centroid, exact for six-node elements.
    pub centroid: Vector3<f64>,
    /// `int x_i x_j dV / volume` about the centroid.
    pub second: Matrix3<f64>,
}

impl Moments {
    /// By the divergence theorem over the surface.
    pub fn of(elements: &[[u32; 6]], nodes: &[[f64; 3]]) -> Self {
        let points = quadrature();
        let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for element in elements {
            let nodes = nodes_of(element, nodes);
            for point in &points {
                let x = point.interpolate(&nodes);
                // div x = 3, div (x_i x) = 4 x_i, div (x_i x_j x) = 5 x_i x_j.
                let flux = point.weight * x.dot(&point.normal(&nodes));
                volume += flux / 3.0;
                first += flux * x / 4.0;
                second += flux * x * x.transpose() / 5.0;
            }
        }
        let centroid = first / volume;
        Self {
            volume,
            centroid,
            second: second / volume - centroid * centroid.transpose(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// A smooth, asymmetric deformation of the sphere.
    fn deformed(mesh: &Mesh) -> Vec<[f64; 3]> {
        mesh.nodes
            .iter()
            .map(|&[x, y, z]| {
                [
                    1.3 * x + 0.1 * y * z + 0.2,
                    0.9 * y + 0.1 * x * x,
                    0.8 * z - 0.2 * x * y,
                ]
            })
            .collect()
    }

    #[test]
    fn volume_and_centroid_of_an_ellipsoid_converge() {
        let mut errors = Vec::new();
        for n in [3, 6, 12] {
            let mesh = Mesh::octahedral(n).unwrap();
            let nodes: Vec<_> = mesh
                .nodes
                .iter()
                .map(|&[x, y, z]| [2.0 * x + 0.3, 0.7 * y - 0.1, 0.5 * z + 0.2])
                .collect();
            let moments = Moments::of(&mesh.elements, &nodes);
            let exact = 4.0 / 3.0 * PI * 0.7;
            for (c, e) in moments.centroid.iter().zip([0.3, -0.1, 0.2]) {
                assert!((c - e).abs() < 1e-12);
            }
            for (d, semi_axis) in [2.0, 0.7, 0.5_f64].into_iter().enumerate() {
                assert!((moments.second[(d, d)] / (semi_axis * semi_axis / 5.0) - 1.0).abs() < 0.1 / (n * n) as f64);
            }
            errors.push((moments.volume / exact - 1.0).abs());
        }
        // P2 interpolation of a sphere: fourth order in the element size.
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((3.5..4.5).contains(&order), "{order}");
        }
    }

    #[test]
    fn volume_gradient_is_the_derivative() {
        let mesh = Mesh::octahedral(3).unwrap();
        let symmetry = Symmetry::unreduced(&mesh);
        let patch = Patch::new(&mesh, &symmetry);
        let mut nodes = deformed(&mesh);
        let mut geometry = Geometry::default();
        patch.geometry(&nodes, &symmetry.sector, &mut geometry);
        assert!((geometry.volume - Moments::of(&mesh.elements, &nodes).volume).abs() < 1e-13);
        let axial_moment = |nodes: &[[f64; 3]]| {
            let moments = Moments::of(&mesh.elements, nodes);
            moments.volume * moments.centroid[0]
        };
        let step = 1e-5;
        for node in [0, 7, 50, 99] {
            for d in 0..3 {
                let original = nodes[node][d];
                nodes[node][d] = original + step;
                let (volume_up, moment_up) = (Moments::of(&mesh.elements, &nodes).volume, axial_moment(&nodes));
                nodes[node][d] = original - step;
                let (volume_down, moment_down) = (Moments::of(&mesh.elements, &nodes).volume, axial_moment(&nodes));
                nodes[node][d] = original;
                let volume_rate = (volume_up - volume_down) / (2.0 * step);
                let moment_rate = (moment_up - moment_down) / (2.0 * step);
                assert!((geometry.volume_gradient[node][d] - volume_rate).abs() < 1e-9);
                assert!((geometry.moment_gradient[node][d] - moment_rate).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_sector_gives_the_full_mesh_values() {
        let mesh = Mesh::octahedral(5).unwrap();
        let symmetry = Symmetry::reduced(&mesh).unwrap();
        let full = Symmetry::unreduced(&mesh);
        let nodes: Vec<_> = mesh
            .nodes
            .iter()
            .map(|&[x, y, z]| {
                [
                    1.2 * x + 0.1 * (y * y + z * z),
                    y * (1.0 - 0.2 * z * z),
                    z * (1.0 - 0.2 * y * y),
                ]
            })
            .collect();
        let (mut reduced_geometry, mut full_geometry) = (Geometry::default(), Geometry::default());
        Patch::new(&mesh, &symmetry).geometry(&nodes, &symmetry.sector, &mut reduced_geometry);
        Patch::new(&mesh, &full).geometry(&nodes, &full.sector, &mut full_geometry);
        assert!((reduced_geometry.volume - full_geometry.volume).abs() < 1e-13);
        for (row, &node) in symmetry.sector.iter().enumerate() {
            for d in 0..3 {
                for (reduced, full) in [
                    (&reduced_geometry.volume_gradient, &full_geometry.volume_gradient),
                    (&reduced_geometry.moment_gradient, &full_geometry.moment_gradient),
                    (&reduced_geometry.normals, &full_geometry.normals),
                ] {
                    assert!((reduced[row][d] - full[node as usize][d]).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn normals_of_the_sphere_are_radial() {
        let mesh = Mesh::octahedral(8).unwrap();
        let symmetry = Symmetry::unreduced(&mesh);
        let mut geometry = Geometry::default();
        Patch::new(&mesh, &symmetry).geometry(&mesh.nodes, &symmetry.sector, &mut geometry);
        for (normal, point) in geometry.normals.iter().zip(&mesh.nodes) {
            assert!(Vector3::from(*normal).dot(&Vector3::from(*point)) > 0.9999);
        }
    }
}
