//! The file `mesh.npz`: reference nodes, elements and the symmetry tables.

use std::path::Path;

use ndarray::{Array1, Array3};

use crate::npz::{Reader, Writer, rows};
use crate::{DatabaseError, Mesh, Symmetry, apply};

/// Writes mesh and symmetry tables.
pub(crate) fn write(path: &Path, mesh: &Mesh, symmetry: &Symmetry) -> Result<(), DatabaseError> {
    let unit = |d: usize| std::array::from_fn(|k| if k == d { 1.0 } else { 0.0 });
    let matrix = |(g, i, j): (usize, usize, usize)| apply(g as u8, unit(j))[i] as i8;
    let mut writer = Writer::new(path);
    writer.add("nodes", &rows(&mesh.nodes))?;
    writer.add("elements", &rows(&mesh.elements))?;
    writer.add("group", &Array1::from(symmetry.operations.clone()))?;
    writer.add("sector", &Array1::from(symmetry.sector.clone()))?;
    writer.add("representative", &Array1::from(symmetry.representative.clone()))?;
    writer.add("operation", &Array1::from(symmetry.operation.clone()))?;
    // For readers in other languages: the matrix of each of the eight operations.
    writer.add("operations", &Array3::from_shape_fn((8, 3, 3), matrix))?;
    writer.finish()
}

/// Reads and checks mesh and symmetry tables.
pub(crate) fn read(path: &Path) -> Result<(Mesh, Symmetry), DatabaseError> {
    let mut reader = Reader::open(path)?;
    let nodes = reader.array::<f64>("nodes", &[None, Some(3)])?;
    let elements = reader.array::<u32>("elements", &[None, Some(6)])?;
    let mesh = Mesh {
        nodes: nodes.rows().into_iter().map(|r| [r[0], r[1], r[2]]).collect(),
        elements: elements
            .rows()
            .into_iter()
            .map(|r| std::array::from_fn(|k| r[k]))
            .collect(),
    };
    mesh.validate()?;
    let n = Some(mesh.nodes.len());
    let symmetry = Symmetry {
        operations: reader.vector("group", None)?,
        sector: reader.vector("sector", None)?,
        representative: reader.vector("representative", n)?,
        operation: reader.vector("operation", n)?,
    };
    symmetry.validate(&mesh.nodes)?;
    Ok((mesh, symmetry))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;

    #[test]
    fn a_mesh_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.npz");
        let mesh = octahedral(3);
        let symmetry = Symmetry::detect(&mesh.nodes);
        write(&path, &mesh, &symmetry).unwrap();
        assert_eq!(read(&path).unwrap(), (mesh, symmetry));
    }

    #[test]
    fn tables_of_another_mesh_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.npz");
        let mut symmetry = Symmetry::detect(&octahedral(3).nodes);
        symmetry.representative.reverse();
        write(&path, &octahedral(3), &symmetry).unwrap();
        assert!(matches!(read(&path), Err(DatabaseError::BadMesh { .. })));
    }
}
