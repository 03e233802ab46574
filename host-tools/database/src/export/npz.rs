//! NPZ: an archive of `.npy` files, the large ones written as a stream.

use std::fs::File;
use std::io::{BufWriter, Error, Write};
use std::path::Path;

use ndarray::{Array1, Array2};
use ndarray_npy::npy::header::{Header, Layout};
use ndarray_npy::{WritableElement, WriteNpyExt};
use py_literal::Value;
use zip::ZipWriter;

use super::{Export, Progress, UNITS, flat};
use crate::DatabaseError;
use crate::npz::{options, triangles};

/// The level of deflate. Higher ones take several times as long and save a tenth of the bytes.
const LEVEL: i64 = 1;

pub(super) fn write(export: &Export, path: &Path, progress: Progress) -> Result<(), DatabaseError> {
    let failed = |error: Error| DatabaseError::io("write", path)(error);
    let file = File::create(path).map_err(failed)?;
    let mut archive = Archive(ZipWriter::new(BufWriter::new(file)));
    archive.small(export).map_err(failed)?;
    // Each array is one stream, so that the snapshots are read twice.
    let (count, mut done) = (export.entries.len(), 0);
    for name in ["positions", "velocities"] {
        archive.start_field(name, export).map_err(failed)?;
        export.each(
            |_, trajectory| {
                let field = match name {
                    "positions" => trajectory.positions,
                    _ => trajectory.velocities,
                };
                f64::write_slice(&flat(&field), &mut archive.0).map_err(|error| failed(Error::other(error)))
            },
            |_| {
                done += 1;
                progress(done, 2 * count)
            },
        )?;
    }
    let finished = archive.0.finish().map_err(Error::from);
    finished.and_then(|mut file| file.flush()).map_err(failed)
}

struct Archive(ZipWriter<BufWriter<File>>);

impl Archive {
    /// The arrays that fit into memory.
    fn small(&mut self, export: &Export) -> Result<(), Error> {
        let names = export.names();
        let shape = (export.entries.len(), names.len());
        let parameters = Array2::from_shape_fn(shape, |(j, d)| export.entries[j].parameters[d]);
        self.add("parameters", &parameters)?;
        self.texts("parameter_names", &names)?;
        for (name, unit) in UNITS {
            self.texts(name, &[unit])?;
        }
        self.add("times", &Array1::from(export.times.clone()))?;
        self.add("elements", &triangles(export.database.mesh()))
    }

    fn add(&mut self, name: &str, array: &impl WriteNpyExt) -> Result<(), Error> {
        self.start(name)?;
        array.write_npy(&mut self.0).map_err(Error::other)
    }

    /// An array of texts, as NumPy keeps them: all of the length of the longest, in UTF-32.
    fn texts(&mut self, name: &str, texts: &[&str]) -> Result<(), Error> {
        let length = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0);
        self.start(name)?;
        self.header(format!("<U{length}"), vec![texts.len()])?;
        for text in texts {
            let padding = std::iter::repeat_n('\0', length - text.chars().count());
            for character in text.chars().chain(padding) {
                self.0.write_all(&u32::from(character).to_le_bytes())?;
            }
        }
        Ok(())
    }

    /// Starts an array of a vector for each configuration, instant and node.
    fn start_field(&mut self, name: &str, export: &Export) -> Result<(), Error> {
        let [configurations, instants, nodes] = export.lengths();
        self.start(name)?;
        self.header("<f8".to_owned(), vec![configurations, instants, nodes, 3])
    }

    fn start(&mut self, name: &str) -> Result<(), Error> {
        // More than 4 GB may follow.
        let options = options(LEVEL).large_file(true);
        Ok(self.0.start_file(format!("{name}.npy"), options)?)
    }

    fn header(&mut self, kind: String, shape: Vec<usize>) -> Result<(), Error> {
        let header = Header {
            type_descriptor: Value::String(kind),
            layout: Layout::Standard,
            shape,
        };
        header.write(&mut self.0).map_err(Error::other)
    }
}
