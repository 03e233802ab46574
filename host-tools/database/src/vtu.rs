//! Files for ParaView: one VTU an instant, and the PVD that strings them in time.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use crate::error::{finite, length};
use crate::instant::{Instant, PointData};
use crate::{DatabaseError, Mesh, atomic};

/// VTK's cell type of a six-node triangle; its node order is that of [`Mesh::elements`].
pub(crate) const QUADRATIC_TRIANGLE: u8 = 22;
/// VTK's cell type of a flat triangle.
pub(crate) const TRIANGLE: u8 = 5;

/// Writes the mesh with its nodes at `positions` as an XML VTU file with binary (base64) arrays.
///
/// # Errors
/// [`DatabaseError::WrongLength`] or [`DatabaseError::NotFinite`] for data that do not fit the mesh,
/// [`DatabaseError::Io`] when the file cannot be written.
pub fn write(path: &Path, mesh: &Mesh, positions: &[[f64; 3]], data: &[PointData]) -> Result<(), DatabaseError> {
    let (nodes, elements) = (mesh.nodes.len(), mesh.elements.len());
    length("positions for the VTU file", nodes, positions.len())?;
    finite("positions for the VTU file", positions.as_flattened())?;
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    text += "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
    text += "<UnstructuredGrid>\n";
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{elements}\">");
    text += "<PointData>\n";
    for quantity in data {
        let (name, components, values) = quantity.parts();
        length(
            &format!("values of `{name}` for the VTU file"),
            nodes * components,
            values.len(),
        )?;
        finite(&format!("`{name}` for the VTU file"), values)?;
        array(
            &mut text,
            "Float64",
            name,
            components,
            values.iter().flat_map(|v| v.to_le_bytes()),
        );
    }
    text += "</PointData>\n<Points>\n";
    let coordinates = positions.as_flattened().iter().flat_map(|v| v.to_le_bytes());
    array(&mut text, "Float64", "positions", 3, coordinates);
    text += "</Points>\n<Cells>\n";
    let cells = || {
        let cell = |element: &[u32; 6]| {
            if Mesh::is_flat(element) {
                (3, TRIANGLE)
            } else {
                (6, QUADRATIC_TRIANGLE)
            }
        };
        mesh.elements.iter().map(move |element| (element, cell(element)))
    };
    let connectivity = cells().flat_map(|(element, (count, _))| &element[..count]);
    let connectivity = connectivity.flat_map(|n| i64::from(*n).to_le_bytes());
    array(&mut text, "Int64", "connectivity", 1, connectivity);
    let ends = cells().scan(0_i64, |end, (_, (count, _))| {
        *end += count as i64;
        Some(*end)
    });
    array(&mut text, "Int64", "offsets", 1, ends.flat_map(i64::to_le_bytes));
    array(&mut text, "UInt8", "types", 1, cells().map(|(_, (_, kind))| kind));
    text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    atomic::write(path, text.as_bytes())
}

/// Appends one array: its byte count, then its bytes, both in base64.
fn array(text: &mut String, kind: &str, name: &str, components: usize, bytes: impl Iterator<Item = u8>) {
    let bytes: Vec<u8> = bytes.collect();
    let count = (bytes.len() as u64).to_le_bytes();
    let content = [&count[..], &bytes].concat();
    let _ = writeln!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"binary\">{}</DataArray>",
        escaped(name),
        BASE64_STANDARD.encode(content)
    );
}

/// A time series: VTU files `NAME_0000.vtu`, `NAME_0001.vtu`, ... and `NAME.pvd`, which ParaView opens.
#[derive(Debug)]
pub struct Series {
    directory: PathBuf,
    name: String,
    times: Vec<f64>,
}

impl Series {
    /// Starts a series in `directory`, which is created when it is missing.
    ///
    /// # Errors
    /// [`DatabaseError::Io`] when it cannot be created.
    pub fn create(directory: &Path, name: &str) -> Result<Self, DatabaseError> {
        std::fs::create_dir_all(directory).map_err(DatabaseError::io("create", directory))?;
        Ok(Series {
            directory: directory.to_path_buf(),
            name: name.to_owned(),
            times: Vec::new(),
        })
    }

    /// Writes a whole series.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn write(directory: &Path, name: &str, mesh: &Mesh, instants: &[Instant]) -> Result<(), DatabaseError> {
        let mut series = Self::create(directory, name)?;
        for instant in instants {
            series.add(instant.time, mesh, instant.positions, &instant.data)?;
        }
        series.finish()?;
        Ok(())
    }

    /// Writes the state at the instant `time`.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn add(
        &mut self,
        time: f64,
        mesh: &Mesh,
        positions: &[[f64; 3]],
        data: &[PointData],
    ) -> Result<(), DatabaseError> {
        write(&self.directory.join(self.file(self.times.len())), mesh, positions, data)?;
        self.times.push(time);
        Ok(())
    }

    /// Writes the PVD file and returns its path.
    ///
    /// # Errors
    /// [`DatabaseError::Io`] when it cannot be written.
    pub fn finish(self) -> Result<PathBuf, DatabaseError> {
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
        for (i, time) in self.times.iter().enumerate() {
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>",
                escaped(&self.file(i))
            );
        }
        text += "</Collection>\n</VTKFile>\n";
        let path = self.directory.join(format!("{}.pvd", self.name));
        atomic::write(&path, text.as_bytes())?;
        Ok(path)
    }

    fn file(&self, index: usize) -> String {
        format!("{}_{index:04}.vtu", self.name)
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;

    /// The bytes of a named array, taken from the text as an XML reader would.
    fn content(text: &str, name: &str) -> Vec<u8> {
        let start = text.find(&format!("Name=\"{name}\"")).unwrap();
        let open = start + text[start..].find('>').unwrap() + 1;
        let close = open + text[open..].find('<').unwrap();
        let bytes = BASE64_STANDARD.decode(&text[open..close]).unwrap();
        assert_eq!(
            u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize,
            bytes.len() - 8
        );
        bytes[8..].to_vec()
    }

    #[test]
    fn a_file_holds_the_mesh_and_the_data() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("state.vtu");
        let mesh = octahedral(2);
        let radius: Vec<f64> = mesh.nodes.iter().map(|n| n[0].hypot(n[1])).collect();
        let data = [
            PointData::Scalar("radius", &radius),
            PointData::Vector("velocity", &mesh.nodes),
        ];
        write(&path, &mesh, &mesh.nodes, &data).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("NumberOfPoints=\"66\" NumberOfCells=\"32\""));
        let floats = |name: &str| -> Vec<f64> {
            content(&text, name)
                .chunks(8)
                .map(|c| f64::from_le_bytes(c.try_into().unwrap()))
                .collect()
        };
        assert_eq!(floats("radius"), radius);
        assert_eq!(floats("positions"), mesh.nodes.as_flattened());
        let connectivity: Vec<i64> = content(&text, "connectivity")
            .chunks(8)
            .map(|c| i64::from_le_bytes(c.try_into().unwrap()))
            .collect();
        assert_eq!(connectivity[6..12], mesh.elements[1].map(i64::from));
        assert_eq!(content(&text, "types"), vec![22; 32]);
        let element_ends = content(&text, "offsets");
        assert_eq!(element_ends[element_ends.len() - 8..], (6 * 32i64).to_le_bytes());
    }

    #[test]
    fn a_series_names_its_instants() {
        let directory = tempfile::tempdir().unwrap();
        let mesh = octahedral(2);
        let mut series = Series::create(&directory.path().join("out"), "capsule").unwrap();
        for time in [0.0, 0.2] {
            series.add(time, &mesh, &mesh.nodes, &[]).unwrap();
        }
        let pvd = series.finish().unwrap();
        let text = std::fs::read_to_string(&pvd).unwrap();
        assert!(
            text.contains("timestep=\"0.2\" part=\"0\" file=\"capsule_0001.vtu\""),
            "{text}"
        );
        assert!(pvd.with_file_name("capsule_0001.vtu").exists());
    }

    #[test]
    fn data_of_another_mesh_are_refused() {
        let mesh = octahedral(2);
        let path = Path::new("/nonexistent/state.vtu");
        let error = write(path, &mesh, &mesh.nodes, &[PointData::Scalar("radius", &[1.0])])
            .unwrap_err()
            .to_string();
        assert!(error.contains("`radius`") && error.contains("66"), "{error}");
        assert!(matches!(
            write(path, &mesh, &mesh.nodes, &[]),
            Err(DatabaseError::Io { .. })
        ));
    }
}
