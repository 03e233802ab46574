//! A ParaView series for each configuration, and the table of their parameters.

use std::path::Path;

use super::{Export, Progress};
use crate::{DatabaseError, PointData, atomic, table, vtu};

pub(super) fn write(export: &Export, folder: &Path, progress: Progress) -> Result<(), DatabaseError> {
    let mesh = export.database.mesh();
    let mut rows = Vec::new();
    export.each(
        |index, trajectory| {
            let entry = &export.entries[index];
            let name = entry.file.trim_end_matches(".npz");
            let mut series = vtu::Series::create(&folder.join(name), "capsule")?;
            let fields = trajectory.positions.iter().zip(&trajectory.velocities);
            for (time, (positions, velocities)) in trajectory.times.iter().zip(fields) {
                series.add(*time, mesh, positions, &[PointData::Vector("velocity", velocities)])?;
            }
            series.finish()?;
            let row = std::iter::once(format!("{name}/capsule.pvd"));
            rows.push(
                row.chain(entry.parameters.iter().map(f64::to_string))
                    .collect::<Vec<_>>(),
            );
            Ok(())
        },
        |done| progress(done, export.entries.len()),
    )?;
    let heading = std::iter::once("series").chain(export.names());
    atomic::write(&folder.join("parameters.csv"), &table::csv(None, heading, rows)?)
}
