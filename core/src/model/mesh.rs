//! The surface mesh and the symmetry of the square duct.

use super::indices::Indices;
use super::wire;
use crate::linalg::LANES;

/// Of which components of the sector node's vector the y and the z of a node are, and whether with the opposite sign:
/// swap y and z (bit 2), then y -> -y (bit 0) and z -> -z (bit 1).
pub(crate) fn components(operation: u8) -> [(usize, bool); 2] {
    let [y, z] = if operation & 4 == 0 { [1, 2] } else { [2, 1] };
    [(y, operation & 1 != 0), (z, operation & 2 != 0)]
}

/// Carries a vector from its sector node to a node.
pub(crate) fn apply<T: Copy + core::ops::Neg<Output = T>>(operation: u8, [x, y, z]: [T; 3]) -> [T; 3] {
    let (y, z) = if operation & 4 == 0 { (y, z) } else { (z, y) };
    [
        x,
        if operation & 1 == 0 { y } else { -y },
        if operation & 2 == 0 { z } else { -z },
    ]
}

/// Corners of the four flat triangles of a P2 element.
const PARTS: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];

/// The mesh of a validated model.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    nodes: usize,
    element_nodes: usize,
    elements: Indices<'a>,
    sector_reference: &'a [[[u8; 4]; 3]],
    sector: usize,
    operations: &'a [u8],
    images: Indices<'a>,
    origins: Indices<'a>,
}

impl<'a> Mesh<'a> {
    pub(super) fn new(mesh: &wire::Mesh<'a>) -> Self {
        Self {
            nodes: mesh.nodes as usize,
            element_nodes: mesh.element_nodes.into(),
            elements: Indices::new(&mesh.elements),
            sector_reference: mesh.sector_reference.blob.data.as_chunks().0.as_chunks().0,
            sector: mesh.sector_reference.rows as usize,
            operations: mesh.operations.data,
            images: Indices::new(&mesh.images),
            origins: Indices::new(&mesh.origins),
        }
    }

    /// Number of nodes N_x.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Nodes of an element: 6, or 3 where the triangles are flat.
    pub fn element_nodes(&self) -> usize {
        self.element_nodes.clamp(3, 6)
    }

    /// The triangles: corners 0 1 2, mid-edges (0,1) (1,2) (2,0), counter-clockwise from outside. Flat ones have no
    /// mid-edges, and name their corners again in their place.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = [u16; 6]> + Clone + use<'a> {
        let (elements, own) = (self.elements, self.element_nodes());
        (0..elements.len() / own).map(move |element| {
            core::array::from_fn(|i| {
                let i = if i < own { i } else { i - 3 };
                elements.get(element * own + i).unwrap_or_default() as u16
            })
        })
    }

    /// The flat triangles that make up an element, by the places of their corners in it.
    pub(crate) fn flat_parts(&self) -> &'static [[usize; 3]] {
        if self.element_nodes == 3 { &[[0, 1, 2]] } else { &PARTS }
    }

    /// Full indices of the sector's nodes.
    pub fn sector_nodes(&self) -> Indices<'a> {
        self.row(0)
    }

    /// Sector node and operation of a full node, if there is such a node.
    pub fn origin(&self, node: usize) -> Option<(usize, u8)> {
        let place = self.origins.get(node)?;
        let row = place.checked_div(self.sector)?;
        Some((place - row * self.sector, *self.operations.get(row)?))
    }

    /// The operations, the identity first, and the full indices of the nodes to which each takes the sector's; no
    /// node's index where an operation before it takes one there.
    pub(crate) fn images(&self) -> impl Iterator<Item = (u8, Indices<'a>)> + use<'a> {
        let mesh = *self;
        let operations = self.operations.iter().enumerate();
        operations.map(move |(row, operation)| (*operation, mesh.row(row)))
    }

    fn row(&self, row: usize) -> Indices<'a> {
        self.images.slice_or_empty(row * self.sector..(row + 1) * self.sector)
    }

    /// Panels of eight that the sector's nodes fill.
    pub(crate) fn panels(&self) -> usize {
        self.sector.div_ceil(LANES)
    }

    /// Reference position of a sector node, see [`wire::Reference`]; 0 where there is none.
    pub fn sector_reference(&self, sector_node: usize) -> [f32; 3] {
        let node = self.sector_reference.get(sector_node);
        node.map_or([0.0; 3], |node| node.map(f32::from_le_bytes))
    }

    /// Reference position of a sector node, as it is stored.
    pub(crate) fn sector_node(&self, sector_node: usize) -> [[u8; 4]; 3] {
        self.sector_reference.get(sector_node).copied().unwrap_or_default()
    }

    /// Reference positions of the sector nodes of a panel, as they are stored.
    pub(crate) fn sector_panel(&self, panel: usize) -> &'a [[[u8; 4]; 3]] {
        self.sector_reference.chunks(LANES).nth(panel).unwrap_or_default()
    }

    /// Reference position of a full node, if there is such a node.
    pub fn reference(&self, node: usize) -> Option<[f32; 3]> {
        let (sector_node, operation) = self.origin(node)?;
        Some(apply(operation, self.sector_reference(sector_node)))
    }
}
