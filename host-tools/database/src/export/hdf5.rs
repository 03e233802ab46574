//! HDF5: datasets of the root group, a chunk for each snapshot.

use std::path::Path;

use rust_hdf5::{H5Dataset, H5File, Hdf5Error};

use super::{Export, Progress, UNITS, flat};
use crate::DatabaseError;
use crate::npz::triangles;

/// The level of deflate.
const LEVEL: u32 = 1;

pub(super) fn write(export: &Export, path: &Path, progress: Progress) -> Result<(), DatabaseError> {
    let failed = |error: Hdf5Error| DatabaseError::io("write", path)(std::io::Error::other(error));
    let file = H5File::create(path).map_err(failed)?;
    small(export, &file).map_err(failed)?;
    let [configurations, instants, nodes] = export.lengths();
    let field = |name| -> Result<H5Dataset, DatabaseError> {
        let field = file.new_dataset::<f64>().shape([configurations, instants, nodes, 3]);
        let chunked = field.chunk(&[1, 1, nodes, 3]).shuffle_deflate(LEVEL);
        chunked.create(name).map_err(failed)
    };
    let (positions, velocities) = (field("positions")?, field("velocities")?);
    export.each(
        |index, trajectory| {
            for (dataset, field) in [(&positions, trajectory.positions), (&velocities, trajectory.velocities)] {
                let (start, counts) = ([index, 0, 0, 0], [1, instants, nodes, 3]);
                dataset.write_slice(&start, &counts, &flat(&field)).map_err(failed)?;
            }
            Ok(())
        },
        |done| progress(done, configurations),
    )?;
    file.close().map_err(failed)
}

/// The arrays that fit into memory.
fn small(export: &Export, file: &H5File) -> Result<(), Hdf5Error> {
    let names = export.names();
    let parameters: Vec<f64> = export
        .entries
        .iter()
        .flat_map(|entry| entry.parameters.clone())
        .collect();
    let numbers = |shape: &[usize], name: &str, numbers: &[f64]| {
        let dataset = file.new_dataset::<f64>().shape(shape).create(name)?;
        dataset.write_raw(numbers)
    };
    numbers(&[export.entries.len(), names.len()], "parameters", &parameters)?;
    numbers(&[export.times.len()], "times", &export.times)?;
    file.write_vlen_strings("parameter_names", &names)?;
    for (name, unit) in UNITS {
        file.write_vlen_strings(name, &[unit])?;
    }
    let elements = triangles(export.database.mesh());
    let dataset = file.new_dataset::<u32>().shape(elements.shape()).create("elements")?;
    dataset.write_raw(&elements.iter().copied().collect::<Vec<_>>())
}
