//! Checks of the mesh: symmetry, indices, reference nodes, outlines.

use super::checks::Validator;
use crate::model::error::OpenError;
use crate::model::indices::Indices;
use crate::model::matrix::MatrixView;
use crate::model::wire::{DIAGONAL, MIDPLANE, Mesh, NodeSet, Reference};

/// The radius of such a model: its cube is a single-precision number.
const RADIUS: [f64; 2] = [1e-12, 1e12];
/// The largest mesh that u16 indices can number, and one is left that says that there is no node.
const MAX_NODES: usize = u16::MAX as usize;

impl Validator {
    pub(super) fn mesh(&mut self, mesh: &Mesh<'_>) {
        let nodes = mesh.nodes as usize;
        self.count("nodes", nodes.clamp(1, MAX_NODES), nodes);
        let sector = mesh.sector_reference.rows as usize;
        let what = "sector's reference nodes";
        let reference = self.matrix(what, &mesh.sector_reference, [sector, 3], self.length);
        self.singles(what, &mesh.sector_reference);
        match mesh.reference {
            Reference::Sphere => self.on_unit_sphere(what, &reference),
            Reference::Shape {
                radius,
                origin,
                volumes: [least, greatest],
            } => {
                self.setting("radius of the reference shape", radius, RADIUS[0], RADIUS[1]);
                let [near, far] = self.length.map(f64::from);
                self.setting("axial origin", origin, near, far);
                self.setting("least volume", least, 1e-6, 1e6);
                self.setting("greatest volume", greatest, least, 1e6);
            }
        }
        self.images(mesh, nodes, sector);
        let element_nodes = usize::from(mesh.element_nodes);
        if element_nodes != 3 {
            self.count("nodes of an element", 6, element_nodes);
        }
        let count = mesh.elements.data.len() / (2 * element_nodes.max(1)) * element_nodes;
        self.indices("elements", &mesh.elements, count, nodes);
        for set in &mesh.node_sets {
            self.indices("node sets", &set.nodes, set.nodes.data.len() / 2, nodes);
        }
        for name in [MIDPLANE, DIAGONAL] {
            let short = |set: &NodeSet<'_>| set.name == name && set.nodes.data.len() < 6;
            if mesh.node_sets.iter().any(short) {
                self.refuse(OpenError::ShortOutline { name });
            }
        }
    }

    /// Every node is an image of one sector node, by one operation; a sector node is its own by the identity.
    fn images(&mut self, mesh: &Mesh<'_>, nodes: usize, sector: usize) {
        let operations = mesh.operations.data;
        self.count("operations", operations.len().clamp(1, 8), operations.len());
        for (index, &operation) in operations.iter().enumerate() {
            self.index("operations", index, operation.into(), if index == 0 { 1 } else { 8 });
        }
        self.length("images", &mesh.images, 2 * operations.len() * sector);
        if self.found.is_err() {
            return;
        }
        let images = Indices::new(&mesh.images);
        for (index, node) in images.iter().take(sector).enumerate() {
            self.index("images", index, node, nodes);
        }
        let count = images.iter().filter(|node| *node < nodes).count();
        self.count("images that are nodes", nodes, count);
        let origins = self.indices("origins", &mesh.origins, nodes, images.len());
        for (node, place) in origins.iter().enumerate() {
            if images.get(place) != Some(node) {
                self.refuse(OpenError::NoImage { node });
            }
        }
    }

    fn on_unit_sphere(&mut self, what: &'static str, reference: &MatrixView<'_>) {
        for node in 0..reference.rows() {
            let [x, y, z] = [reference.get(node, 0), reference.get(node, 1), reference.get(node, 2)];
            let square = x * x + y * y + z * z;
            if (square - 1.0).abs() > 1e-3 {
                let expected = "a node on the unit sphere (this is its squared radius)";
                self.number(what, node, square, expected);
            }
        }
    }
}
