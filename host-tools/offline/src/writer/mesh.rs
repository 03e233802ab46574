//! The mesh: sector, images, outlines.

use capsule_core::model::wire::{self, Blob, NodeSet, Reference};
use capsule_core::{DIAGONAL, MIDPLANE};
use capsule_database::{Mesh, Symmetry};

use super::indices;
use super::matrix::StoredMatrix;
use crate::OfflineError;
use crate::scaling::Scaling;
use crate::tolerances::ON_PLANE;

/// The mesh of a model file, with its bytes.
#[derive(Clone)]
pub(crate) struct OwnedMesh {
    nodes: usize,
    element_nodes: usize,
    elements: Vec<u8>,
    reference: Reference,
    sector_reference: StoredMatrix,
    operations: Vec<u8>,
    images: Vec<u8>,
    origins: Vec<u8>,
    outlines: Vec<(&'static str, Vec<u8>)>,
    pub(super) scales: Vec<f64>,
    /// The sector's nodes in the order of the file, by their places in the symmetry's.
    pub(super) order: Vec<usize>,
}

impl OwnedMesh {
    /// # Errors
    /// [`OfflineError::TooManyNodes`]; [`OfflineError::NoOutline`] for a sphere, while another shape may be without
    /// outlines.
    pub(crate) fn new(mesh: &Mesh, symmetry: &Symmetry, reference: Reference) -> Result<Self, OfflineError> {
        // 65535 says that there is none.
        let limit = usize::from(u16::MAX);
        let nodes = symmetry.order() * symmetry.sector.len();
        if nodes > limit {
            return Err(OfflineError::TooManyNodes { nodes, limit });
        }
        let outlines = match reference {
            Reference::Sphere => outlines(&mesh.nodes, 1.0)?,
            // Nodes stay in the planes of the outlines by symmetry alone.
            Reference::Shape { radius, .. } if symmetry.order() == 8 => {
                outlines(&mesh.nodes, radius).unwrap_or_default()
            }
            Reference::Shape { .. } => Vec::new(),
        };
        let order = order(symmetry, outlines.iter().flat_map(|(_, nodes)| nodes));
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, old)| place[*old] = new);
        let origins = origins(symmetry, &place);
        let mut images = vec![u16::MAX.into(); symmetry.order() * order.len()];
        (0..)
            .zip(&origins)
            .for_each(|(node, place)| images[*place as usize] = node);
        let sector: Vec<u32> = order.iter().map(|s| symmetry.sector[*s]).collect();
        let orbits = symmetry.orbit_sizes();
        let flat = mesh.elements.iter().all(Mesh::is_flat);
        let element_nodes = if flat { 3 } else { 6 };
        Ok(OwnedMesh {
            nodes: mesh.nodes.len(),
            element_nodes,
            elements: indices(mesh.elements.iter().flat_map(|element| &element[..element_nodes])),
            reference,
            sector_reference: StoredMatrix::new(sector.len(), 3, |s, d| mesh.nodes[sector[s] as usize][d]),
            operations: symmetry.operations.clone(),
            images: indices(&images),
            origins: indices(&origins),
            outlines: outlines
                .into_iter()
                .map(|(name, nodes)| (name, indices(&nodes)))
                .collect(),
            scales: orbits.iter().map(|w| f64::from(*w).sqrt()).collect(),
            order,
        })
    }

    /// The square root of the orbit's size of each sector node.
    pub(crate) fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// In the units of the data.
    pub(super) fn scaled(&self, scaling: &Scaling) -> Self {
        OwnedMesh {
            sector_reference: self.sector_reference.times(scaling.length),
            reference: match self.reference {
                Reference::Sphere => Reference::Sphere,
                Reference::Shape {
                    radius,
                    origin,
                    volumes,
                } => Reference::Shape {
                    radius: scaling.length * radius,
                    origin: scaling.origin + scaling.length * origin,
                    volumes,
                },
            },
            ..self.clone()
        }
    }

    /// Bytes of its arrays.
    pub(super) fn byte_len(&self) -> usize {
        let outlines = self.outlines.iter().map(|(_, nodes)| nodes.len());
        self.elements.len()
            + self.sector_reference.byte_len()
            + self.operations.len()
            + self.images.len()
            + self.origins.len()
            + outlines.sum::<usize>()
    }

    pub(super) fn wire(&self) -> wire::Mesh<'_> {
        wire::Mesh {
            nodes: self.nodes as u32,
            element_nodes: self.element_nodes as u8,
            elements: Blob::new(&self.elements),
            reference: self.reference,
            sector_reference: self.sector_reference.matrix(),
            operations: Blob::new(&self.operations),
            images: Blob::new(&self.images),
            origins: Blob::new(&self.origins),
            node_sets: self
                .outlines
                .iter()
                .map(|(name, nodes)| NodeSet {
                    name,
                    nodes: Blob::new(nodes),
                })
                .collect(),
        }
    }
}

/// The place of each node in the table of images, a row for each operation and a column for each of the sector's nodes:
/// these at the places given.
fn origins(symmetry: &Symmetry, places: &[usize]) -> Vec<u32> {
    let mut rows = [0; 8];
    for (row, operation) in symmetry.operations.iter().enumerate() {
        rows[usize::from(*operation)] = row;
    }
    let images = symmetry.representative.iter().zip(&symmetry.operation);
    let place = |(s, operation): (&u32, &u8)| rows[usize::from(*operation)] * places.len() + places[*s as usize];
    images.map(|image| place(image) as u32).collect()
}

/// The sector's nodes, by their places in the symmetry's order: first those of the outlines, as these run, so that they
/// share panels and no others are computed with them.
fn order<'a>(symmetry: &Symmetry, outlines: impl Iterator<Item = &'a u32>) -> Vec<usize> {
    let of_outlines = outlines.map(|node| symmetry.representative[*node as usize] as usize);
    let mut taken = vec![false; symmetry.sector.len()];
    of_outlines
        .chain(0..symmetry.sector.len())
        .filter(|s| !std::mem::replace(&mut taken[*s], true))
        .collect()
}

/// The two outlines of a shape of a radius.
fn outlines(nodes: &[[f64; 3]], radius: f64) -> Result<Vec<(&'static str, Vec<u32>)>, OfflineError> {
    let on = ON_PLANE * radius;
    let midplane = outline(MIDPLANE, nodes, on, |[_, y, z]| z.abs() < on && y > -on)?;
    let diagonal = outline(DIAGONAL, nodes, on, |[_, y, z]| (y - z).abs() < on && y > -on)?;
    Ok(vec![(MIDPLANE, midplane), (DIAGONAL, diagonal)])
}

/// The nodes of a half plane through the axis, from the front pole to the rear pole: by the angle from the axis, around
/// the origin, which is the centroid.
fn outline(
    name: &'static str,
    nodes: &[[f64; 3]],
    on_axis: f64,
    lies_on: impl Fn([f64; 3]) -> bool,
) -> Result<Vec<u32>, OfflineError> {
    let mut outline: Vec<u32> = (0..nodes.len() as u32)
        .filter(|i| lies_on(nodes[*i as usize]))
        .collect();
    let radial = |i: &u32| nodes[*i as usize][1].hypot(nodes[*i as usize][2]);
    let angle = |i: &u32| radial(i).atan2(nodes[*i as usize][0]);
    outline.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    let pole = |i: Option<&u32>| i.is_some_and(|i| radial(i) < on_axis);
    if outline.len() < 3 || !pole(outline.first()) || !pole(outline.last()) {
        return Err(OfflineError::NoOutline {
            outline: name,
            found: outline.len(),
        });
    }
    Ok(outline)
}

#[cfg(test)]
mod tests {
    use crate::writer::tests::Fixture;
    use capsule_core::{DIAGONAL, MIDPLANE, Model};

    #[test]
    fn the_mesh_is_read_as_it_was_written() {
        let fixture = Fixture::new();
        let file = fixture.file(&[&fixture.cluster]);
        let model = Model::open(&file).unwrap();
        let mesh = model.mesh();
        assert_eq!(mesh.nodes(), fixture.mesh.nodes.len());
        for (node, exact) in fixture.mesh.nodes.iter().enumerate() {
            let found = mesh.reference(node).unwrap();
            assert!((0..3).all(|d| (f64::from(found[d]) - exact[d]).abs() < 1e-6), "{node}");
        }
        let elements = fixture.mesh.elements.iter();
        assert!(
            mesh.elements()
                .eq(elements.map(|element| element.map(|node| node as u16)))
        );
        for name in [MIDPLANE, DIAGONAL] {
            let outline = model.node_set(name).unwrap();
            let x: Vec<f64> = outline.iter().map(|node| fixture.mesh.nodes[node][0]).collect();
            assert_eq!((x[0], x[x.len() - 1]), (1.0, -1.0));
            assert!(x.is_sorted_by(|a, b| a > b), "{name}: {x:?}");
        }
    }
}
