//! Collections as folders of VTU series.
//!
//! The folder holds `parameters.csv`: a heading `series,NAME,...`, then a row for each configuration with the path of
//! its PVD file, relative to the folder, and its parameters. A PVD file lists VTU files by time; those of `capsule-rom
//! fom run --out` and `capsule-rom predict --vtu` are of this kind. All series are of one mesh, of flat or quadratic
//! triangles; of their instants those count that all have, and point data `velocity` where all have it.
//!
//! `table` reads the table, `pvd` the lists, `instants` finds the instants that count. `markup` opens an XML file of
//! VTK, `encoding` decodes its arrays, `vtu` takes the surface from them, and `weld` joins its pieces.

mod compressor;
mod encoding;
mod instants;
mod markup;
mod numbers;
mod pvd;
mod stream;
mod table;
#[cfg(test)]
mod tests;
mod vtu;
mod weld;

use std::path::{Path, PathBuf};

use super::Collection;
use crate::DatabaseError;
use pvd::{Frame, Series};
use table::Table;
use vtu::Snapshot;
use weld::Weld;

/// Instants are the same when they differ by at most this share of the last one: room for six digits of text.
const SAME_TIME: f64 = 1e-6;

/// Reads the series of a folder, with warnings of interpretations that differ from the text of the files.
///
/// # Errors
/// Missing, malformed and unsupported content, with its file, array, row or instant.
pub(crate) fn read(folder: &Path) -> Result<(Collection, Vec<String>), DatabaseError> {
    let mut notes = Vec::new();
    let path = folder.join("parameters.csv");
    let table = Table::read(&path)?;
    let mut series = Vec::new();
    for row in &table.rows {
        let place = format!("line {}, series `{}`", row.line, row.series);
        let pvd = folder.join(&row.series);
        let bytes = named_file(&pvd, &path, &place)?;
        series.push(Series::parse(&pvd, &bytes, &mut notes)?);
    }
    let times = instants::common(&mut series, &mut notes)?;
    let mut surface = None;
    let mut velocity = Velocity::default();
    let (mut positions, mut velocities) = (Vec::new(), Vec::new());
    for one in &series {
        let (mut places, mut rates) = (Vec::new(), Vec::new());
        for frame in &one.frames {
            let snapshot = read_frame(frame, &one.path)?;
            let file = &frame.files[0];
            let surface = surface.get_or_insert_with(|| Surface::of(file, &snapshot, &mut notes));
            let snapshot = surface.take(file, snapshot)?;
            velocity.count(file, snapshot.velocities.is_some());
            places.push(snapshot.positions);
            rates.extend(snapshot.velocities);
        }
        positions.push(places);
        velocities.push(rates);
    }
    if !velocity.everywhere(&mut notes) {
        velocities.clear();
    }
    let collection = Collection::new(Collection {
        parameter_names: table.names,
        length_unit: None,
        time_unit: None,
        parameters: table.rows.into_iter().map(|row| row.parameters).collect(),
        times,
        elements: surface.map(|surface| surface.welded).unwrap_or_default(),
        positions,
        velocities,
    })?;
    Ok((collection, notes))
}

fn malformed(path: &Path, reason: String) -> DatabaseError {
    let path = path.to_path_buf();
    DatabaseError::Malformed { path, reason }
}

/// The bytes of a file that another one names at a place.
fn named_file(path: &Path, named_in: &Path, place: &str) -> Result<Vec<u8>, DatabaseError> {
    std::fs::read(path)
        .map_err(|source| malformed(named_in, format!("{place}: cannot read {}: {source}", path.display())))
}

/// One instant of a series, of one file or of several parts.
fn read_frame(frame: &Frame, pvd: &Path) -> Result<Snapshot, DatabaseError> {
    let mut whole = Snapshot::default();
    for file in &frame.files {
        let bytes = named_file(file, pvd, &format!("timestep {}", frame.time))?;
        Snapshot::parse(&bytes)
            .and_then(|part| whole.append(part))
            .map_err(|reason| malformed(file, reason))?;
    }
    let empty = whole.positions.is_empty() || whole.triangles.is_empty();
    match empty {
        true => Err(malformed(
            &frame.files[0],
            "no triangle, expected a closed surface".to_owned(),
        )),
        false => Ok(whole),
    }
}

/// The surface of the first file, which all others must have.
struct Surface {
    source: PathBuf,
    weld: Weld,
    triangles: Vec<[u32; 6]>,
    welded: Vec<[u32; 6]>,
}

impl Surface {
    fn of(file: &Path, first: &Snapshot, notes: &mut Vec<String>) -> Self {
        if first.left_out > 0 {
            notes.push(format!(
                "{}: {} points and lines among the cells are left out",
                file.display(),
                first.left_out
            ));
        }
        let weld = Weld::of(first);
        Self {
            source: file.to_path_buf(),
            welded: weld.triangles(&first.triangles),
            triangles: first.triangles.clone(),
            weld,
        }
    }

    /// A snapshot with its pieces joined.
    fn take(&self, file: &Path, snapshot: Snapshot) -> Result<Snapshot, DatabaseError> {
        let other = |reason: String| malformed(file, format!("another mesh than {}: {reason}", self.source.display()));
        let counts = [&snapshot.triangles, &self.triangles].map(Vec::len);
        if snapshot.pieces != self.weld.pieces {
            let [found, expected] = [&snapshot.pieces, &self.weld.pieces].map(|pieces| {
                let nodes: Vec<String> = pieces.iter().map(usize::to_string).collect();
                nodes.join(" + ")
            });
            return Err(other(format!("{found} nodes, expected {expected}")));
        }
        if counts[0] != counts[1] {
            return Err(other(format!("{} triangles, expected {}", counts[0], counts[1])));
        }
        if let Some(k) = (0..counts[0]).find(|k| snapshot.triangles[*k] != self.triangles[*k]) {
            let [found, expected] = [&snapshot.triangles, &self.triangles].map(|all| words(&all[k]));
            return Err(other(format!(
                "triangle {k} has the nodes {found}, expected {expected}"
            )));
        }
        self.weld.join(snapshot).map_err(other)
    }
}

/// The nodes of a triangle.
fn words(triangle: &[u32; 6]) -> String {
    let count = if crate::Mesh::is_flat(triangle) { 3 } else { 6 };
    let nodes: Vec<String> = triangle[..count].iter().map(u32::to_string).collect();
    nodes.join(" ")
}

/// Which files have point data `velocity`.
#[derive(Default)]
struct Velocity {
    with: usize,
    without: usize,
    /// The first of those without.
    first: Option<PathBuf>,
}

impl Velocity {
    fn count(&mut self, file: &Path, there: bool) {
        if there {
            self.with += 1;
        } else {
            self.without += 1;
            self.first.get_or_insert_with(|| file.to_path_buf());
        }
    }

    /// Whether all have it; a warning if only some do.
    fn everywhere(&self, notes: &mut Vec<String>) -> bool {
        if let Some(first) = self.first.as_ref().filter(|_| self.with > 0) {
            notes.push(format!(
                "`velocity` is in {} of {} files and not in {}: the velocities are derived from the positions",
                self.with,
                self.with + self.without,
                first.display()
            ));
        }
        self.without == 0
    }
}
