//! NPZ archives: arrays by name, with errors that name the array and its shape.

use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::{Path, PathBuf};

use ndarray::{Array1, Array2, Array3, ArrayD};
use ndarray_npy::{NpzReader, NpzWriter, ReadNpyError, ReadNpzError, ReadableElement, WriteNpyExt};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;

use crate::error::length;
use crate::{DatabaseError, Mesh, Trajectory, atomic};

/// Options of an entry that is deflated at this level. The date is fixed: equal contents give equal bytes.
pub(crate) fn options(level: i64) -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated)
        .compression_level(Some(level))
        .last_modified_time(zip::DateTime::default())
}

/// Arrays on their way into an archive, which is made in memory and appears on the disk whole.
pub(crate) struct Writer {
    path: PathBuf,
    archive: NpzWriter<Cursor<Vec<u8>>>,
}

impl Writer {
    pub(crate) fn new(path: &Path) -> Self {
        let archive = NpzWriter::new_with_options(Cursor::new(Vec::new()), options(9));
        Writer {
            path: path.to_path_buf(),
            archive,
        }
    }

    pub(crate) fn add<A: WriteNpyExt>(&mut self, name: &str, array: &A) -> Result<(), DatabaseError> {
        self.archive.add_array(name, array).map_err(|e| self.failed(e))
    }

    pub(crate) fn finish(self) -> Result<(), DatabaseError> {
        let bytes = match self.archive.finish() {
            Ok(cursor) => cursor.into_inner(),
            Err(e) => return Err(DatabaseError::io("write", &self.path)(std::io::Error::other(e))),
        };
        atomic::write(&self.path, &bytes)
    }

    fn failed(&self, error: ndarray_npy::WriteNpzError) -> DatabaseError {
        DatabaseError::io("write", &self.path)(std::io::Error::other(error))
    }
}

/// An archive on the disk.
pub(crate) struct Reader {
    path: PathBuf,
    archive: NpzReader<BufReader<File>>,
}

impl Reader {
    pub(crate) fn open(path: &Path) -> Result<Self, DatabaseError> {
        let file = File::open(path).map_err(DatabaseError::io("read", path))?;
        let archive = NpzReader::new(BufReader::new(file)).map_err(|e| DatabaseError::Corrupt {
            path: path.to_path_buf(),
            reason: e.to_string(),
        })?;
        Ok(Reader {
            path: path.to_path_buf(),
            archive,
        })
    }

    /// The array `name`, whose shape must be `expected` (`None`: any length).
    pub(crate) fn array<T: ReadableElement>(
        &mut self,
        name: &str,
        expected: &[Option<usize>],
    ) -> Result<ArrayD<T>, DatabaseError> {
        let shape = || shape(expected);
        let array = self.archive.by_name(name).map_err(|error| {
            let (path, name) = (self.path.clone(), name.to_owned());
            match error {
                ReadNpzError::Zip(ZipError::FileNotFound) => DatabaseError::MissingArray {
                    path,
                    name,
                    expected: shape(),
                },
                ReadNpzError::Npy(ReadNpyError::WrongDescriptor(found)) => DatabaseError::WrongType {
                    path,
                    name,
                    expected: std::any::type_name::<T>(),
                    found: found.to_string(),
                },
                other => DatabaseError::Corrupt {
                    path,
                    reason: format!("array `{name}`: {other}"),
                },
            }
        })?;
        self.expect_shape(name, array, expected)
    }

    /// Passes on an array whose shape is `expected` (`None`: any length).
    pub(crate) fn expect_shape<T>(
        &self,
        name: &str,
        array: ArrayD<T>,
        expected: &[Option<usize>],
    ) -> Result<ArrayD<T>, DatabaseError> {
        let fits = array.ndim() == expected.len()
            && expected
                .iter()
                .zip(array.shape())
                .all(|(e, found)| e.is_none_or(|e| e == *found));
        if fits {
            Ok(array)
        } else {
            let (path, name, found) = (self.path.clone(), name.to_owned(), array.shape().to_vec());
            Err(DatabaseError::WrongShape {
                path,
                name,
                expected: shape(expected),
                found,
            })
        }
    }

    /// The names of all arrays.
    pub(crate) fn names(&mut self) -> Result<Vec<String>, DatabaseError> {
        let path = self.path.clone();
        self.archive.names().map_err(|error| match error {
            ReadNpzError::Zip(ZipError::UnsupportedArchive(reason)) => DatabaseError::Malformed {
                path,
                reason: format!("{reason}; expected a file of numpy.savez or numpy.savez_compressed"),
            },
            other => DatabaseError::Corrupt {
                path,
                reason: other.to_string(),
            },
        })
    }

    /// The array `name` as it is.
    pub(crate) fn by_name<T: ReadableElement>(&mut self, name: &str) -> Result<ArrayD<T>, ReadNpzError> {
        self.archive.by_name(name)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The elements of a one-dimensional array of any length, or of the given one.
    pub(crate) fn vector<T: ReadableElement + Clone>(
        &mut self,
        name: &str,
        expected: Option<usize>,
    ) -> Result<Vec<T>, DatabaseError> {
        Ok(self.array::<T>(name, &[expected])?.iter().cloned().collect())
    }
}

/// A shape in words, as NumPy writes it, with `N` for any length.
fn shape(expected: &[Option<usize>]) -> String {
    let lengths: Vec<String> = expected
        .iter()
        .map(|e| e.map_or("N".to_owned(), |n| n.to_string()))
        .collect();
    format!("({}{})", lengths.join(", "), if expected.len() == 1 { "," } else { "" })
}

/// Node indices and the like, as rows of an `(N, K)` array.
pub(crate) fn rows<T: Clone, const K: usize>(rows: &[[T; K]]) -> Array2<T> {
    Array2::from_shape_fn((rows.len(), K), |(i, k)| rows[i][k].clone())
}

/// The elements as other programs take them: without mid-edges, an `(N_e, 3)` array, when all are flat.
pub(crate) fn triangles(mesh: &Mesh) -> Array2<u32> {
    let nodes = if mesh.elements.iter().all(Mesh::is_flat) { 3 } else { 6 };
    Array2::from_shape_fn((mesh.elements.len(), nodes), |(e, k)| mesh.elements[e][k])
}

/// Writes a trajectory as plain arrays for NumPy: `positions` and `velocities` (N_t, N_x, 3), `times`, `centroid` and
/// `pressure_drop` (N_t,), `parameters`, `nodes` (N_x, 3) and `elements` (N_e, 6), or (N_e, 3) when all are flat.
///
/// # Errors
/// [`DatabaseError::WrongLength`] when the trajectory is not one of this mesh, [`DatabaseError::Io`] when the file
/// cannot be written.
pub fn export(path: &Path, mesh: &Mesh, trajectory: &Trajectory) -> Result<(), DatabaseError> {
    trajectory.validate(mesh.nodes.len())?;
    let (instants, nodes) = (trajectory.times.len(), mesh.nodes.len());
    let cube = |fields: &[Vec<[f64; 3]>]| Array3::from_shape_fn((instants, nodes, 3), |(i, n, d)| fields[i][n][d]);
    length("snapshots", instants, trajectory.positions.len())?;
    let mut writer = Writer::new(path);
    writer.add("positions", &cube(&trajectory.positions))?;
    writer.add("velocities", &cube(&trajectory.velocities))?;
    writer.add("times", &Array1::from(trajectory.times.clone()))?;
    writer.add("centroid", &Array1::from(trajectory.centroid.clone()))?;
    writer.add("pressure_drop", &Array1::from(trajectory.pressure_drop.clone()))?;
    writer.add("parameters", &Array1::from(trajectory.parameters.clone()))?;
    writer.add("nodes", &rows(&mesh.nodes))?;
    writer.add("elements", &triangles(mesh))?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;
    use crate::trajectory::tests::relaxing;

    #[test]
    fn an_export_holds_the_plain_arrays() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("export.npz");
        let mesh = octahedral(2);
        let trajectory = relaxing(&mesh, &[0.0, 0.2]);
        export(&path, &mesh, &trajectory).unwrap();
        let mut reader = Reader::open(&path).unwrap();
        let n = mesh.nodes.len();
        let positions = reader.array::<f64>("positions", &[Some(2), Some(n), Some(3)]).unwrap();
        assert_eq!(positions[[1, 5, 0]], trajectory.positions[1][5][0]);
        let elements = reader.array::<u32>("elements", &[None, Some(6)]).unwrap();
        assert_eq!(elements[[7, 4]], mesh.elements[7][4]);
    }

    #[test]
    fn triangles_have_mid_edges_where_one_element_has() {
        let mut mesh = octahedral(2);
        assert_eq!(triangles(&mesh).dim(), (32, 6));
        let flat = |[a, b, c, ..]: [u32; 6]| [a, b, c, a, b, c];
        mesh.elements[1..]
            .iter_mut()
            .for_each(|element| *element = flat(*element));
        assert_eq!(triangles(&mesh), rows(&mesh.elements));
        mesh.elements[0] = flat(mesh.elements[0]);
        assert_eq!(
            triangles(&mesh),
            rows(&mesh.elements.iter().map(|e| [e[0], e[1], e[2]]).collect::<Vec<_>>())
        );
    }

    #[test]
    fn errors_name_the_array_and_the_shape() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("some.npz");
        let mut writer = Writer::new(&path);
        writer.add("times", &Array1::from(vec![0.0f64, 1.0])).unwrap();
        writer.finish().unwrap();
        let mut reader = Reader::open(&path).unwrap();
        let error = reader
            .array::<f64>("positions", &[Some(2), None, Some(3)])
            .unwrap_err()
            .to_string();
        assert!(error.contains("`positions` of shape (2, N, 3) is missing"), "{error}");
        let error = reader.vector::<f64>("times", Some(3)).unwrap_err().to_string();
        assert!(error.contains("`times` has shape (2,), expected (3,)"), "{error}");
        let error = reader.vector::<u8>("times", None).unwrap_err().to_string();
        assert!(
            error.contains("`times` has elements of type") && error.contains("expected u8"),
            "{error}"
        );
    }

    #[test]
    fn a_truncated_archive_is_damaged() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("cut.npz");
        let mut writer = Writer::new(&path);
        writer.add("times", &Array1::from(vec![0.5f64; 1000])).unwrap();
        writer.finish().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        for length in [0, 10, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let result = Reader::open(&path).and_then(|mut r| r.vector::<f64>("times", None));
            assert!(
                matches!(result, Err(DatabaseError::Corrupt { .. })),
                "{length} bytes: {result:?}"
            );
        }
    }
}
