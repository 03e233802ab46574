//! The directory: description, mesh, one file a configuration.

use std::path::{Path, PathBuf};

use ndarray::{Array1, Array2, Array4, ArrayD, Ix2, Ix4};

use crate::compact::{self, Snapshots};
use crate::error::{finite, length};
use crate::npz::{Reader, Writer};
use crate::{DatabaseError, Description, Mesh, Status, Symmetry, Trajectory, mesh_file};

/// A field counts as symmetric when it deviates from the expansion of its sector by no more than this (l or V), a small
/// part of the fixed-point step.
const SYMMETRIC: f64 = 0.01 * compact::POSITION_STEP;

/// One configuration of a database, without its snapshots.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// How its simulation ended.
    pub status: Status,
    /// Number of stored snapshots; 0 when only the status was recorded.
    pub snapshots: usize,
    /// The file's name in the directory.
    pub file: String,
}

/// A database on disk. Several threads may read and write it; each file appears atomically.
#[derive(Debug, Clone)]
pub struct Database {
    directory: PathBuf,
    description: Description,
    mesh: Mesh,
    symmetry: Symmetry,
}

impl Database {
    /// Creates a database in `directory`, or opens the one that is there with the same description and mesh, so that an
    /// interrupted sweep can be resumed.
    ///
    /// # Errors
    /// [`DatabaseError::Different`] when another database is there; [`DatabaseError::BadMesh`];
    /// [`DatabaseError::Io`] when the directory cannot be written.
    pub fn create(directory: &Path, description: Description, mesh: Mesh) -> Result<Self, DatabaseError> {
        mesh.validate()?;
        if directory.join("database.json").exists() {
            let there = Database::open(directory)?;
            let wanted = Database {
                directory: directory.to_path_buf(),
                description,
                symmetry: Symmetry::detect(&mesh.nodes),
                mesh,
            };
            return match there.difference(&wanted) {
                None => Ok(there),
                Some(difference) => Err(DatabaseError::Different {
                    path: directory.to_path_buf(),
                    difference,
                }),
            };
        }
        std::fs::create_dir_all(directory).map_err(DatabaseError::io("create", directory))?;
        let symmetry = Symmetry::detect(&mesh.nodes);
        mesh_file::write(&directory.join("mesh.npz"), &mesh, &symmetry)?;
        // Last, because this file makes the directory a database.
        description.write(directory)?;
        Ok(Database {
            directory: directory.to_path_buf(),
            description,
            mesh,
            symmetry,
        })
    }

    /// Opens the database in `directory`.
    ///
    /// # Errors
    /// [`DatabaseError::NotADatabase`], [`DatabaseError::WrongVersion`], or an error of `database.json` or `mesh.npz`.
    pub fn open(directory: &Path) -> Result<Self, DatabaseError> {
        let description = Description::read(directory)?;
        let (mesh, symmetry) = mesh_file::read(&directory.join("mesh.npz"))?;
        Ok(Database {
            directory: directory.to_path_buf(),
            description,
            mesh,
            symmetry,
        })
    }

    /// The first setting, or the mesh, in which two databases differ, so that their configurations cannot be merged.
    #[must_use]
    pub(crate) fn difference(&self, other: &Self) -> Option<String> {
        if let Some(difference) = self.description.difference(&other.description) {
            Some(difference.to_string())
        } else {
            (self.mesh != other.mesh).then(|| "mesh".to_owned())
        }
    }

    /// The directory.
    #[must_use]
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// The description that all configurations share.
    #[must_use]
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The symmetry of the mesh.
    #[must_use]
    pub fn symmetry(&self) -> &Symmetry {
        &self.symmetry
    }

    /// The instants at which a complete trajectory has snapshots, from 0 to the end time.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.description.times
    }

    /// Whether the configuration has a file, with snapshots or its status alone. Parameters are compared to six
    /// decimals.
    #[must_use]
    pub fn contains(&self, parameters: &[f64]) -> bool {
        self.directory.join(self.file_name(parameters)).exists()
    }

    /// Writes one configuration, atomically; a file of the same parameters is replaced.
    ///
    /// The sector alone is kept when all snapshots have the mesh's symmetry, else all nodes. See [`compact`] for the
    /// encoding and its error.
    ///
    /// # Errors
    /// Those of [`Trajectory::validate`], or [`DatabaseError::Io`].
    pub fn write(&self, trajectory: &Trajectory) -> Result<(), DatabaseError> {
        length(
            "parameters",
            self.description.parameters.len(),
            trajectory.parameters.len(),
        )?;
        trajectory.validate(self.mesh.nodes.len())?;
        let mut symmetric = true;
        for field in trajectory.positions.iter().chain(&trajectory.velocities) {
            symmetric = symmetric && self.symmetry.deviation(field)? <= SYMMETRIC;
        }
        let kept = |fields: &Snapshots| -> Result<Snapshots, DatabaseError> {
            if symmetric {
                fields.iter().map(|f| self.symmetry.restrict(f)).collect()
            } else {
                Ok(fields.clone())
            }
        };
        let [positions, velocities] = compact::encode(&kept(&trajectory.positions)?, &kept(&trajectory.velocities)?)?;
        let path = self.directory.join(self.file_name(&trajectory.parameters));
        let status = serde_json::to_vec(&trajectory.status).map_err(DatabaseError::json(&path))?;
        let mut writer = Writer::new(&path);
        writer.add("parameters", &Array1::from(trajectory.parameters.clone()))?;
        writer.add("status", &Array1::from(status))?;
        writer.add("times", &Array1::from(trajectory.times.clone()))?;
        writer.add("centroid", &Array1::from(trajectory.centroid.clone()))?;
        writer.add("pressure_drop", &Array1::from(trajectory.pressure_drop.clone()))?;
        for (name, code) in [("positions", positions), ("velocities", velocities)] {
            writer.add(name, &code.planes)?;
            writer.add(&predictor(name), &code.predictor)?;
        }
        writer.finish()
    }

    /// All configurations, ascending in their parameters, without their snapshots.
    ///
    /// # Errors
    /// [`DatabaseError::Io`] when the directory cannot be read, or an error of a file.
    pub fn entries(&self) -> Result<Vec<Entry>, DatabaseError> {
        let mut entries = Vec::new();
        for file in self.files()? {
            if file == "mesh.npz" || !file.ends_with(".npz") {
                continue;
            }
            let mut reader = Reader::open(&self.directory.join(&file))?;
            let (parameters, status) = self.head(&mut reader)?;
            let snapshots = reader.vector::<f64>("times", None)?.len();
            entries.push(Entry {
                parameters,
                status,
                snapshots,
                file,
            });
        }
        entries.sort_by(|a, b| {
            let pairs = a.parameters.iter().zip(&b.parameters);
            pairs
                .map(|(x, y)| x.total_cmp(y))
                .find(|o| o.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        Ok(entries)
    }

    /// The snapshots of one configuration, at all nodes.
    ///
    /// # Errors
    /// [`DatabaseError::UnknownConfiguration`] when it has no snapshots here, or an error of its file.
    pub fn read(&self, parameters: &[f64]) -> Result<Trajectory, DatabaseError> {
        let unknown = || {
            let (path, parameters) = (self.directory.clone(), parameters.to_vec());
            DatabaseError::UnknownConfiguration { path, parameters }
        };
        let path = self.directory.join(self.file_name(parameters));
        if !path.exists() {
            return Err(unknown());
        }
        let mut reader = Reader::open(&path)?;
        let (parameters, status) = self.head(&mut reader)?;
        let times: Vec<f64> = reader.vector("times", None)?;
        if times.is_empty() {
            return Err(unknown());
        }
        let instants = Some(times.len());
        let centroid = reader.vector("centroid", instants)?;
        let pressure_drop = reader.vector("pressure_drop", instants)?;
        let planes: ArrayD<u8> = reader.array("velocities", &[None, instants, None, Some(3)])?;
        // The shape of the array tells whether the file holds the sector or all nodes.
        let (all, sector) = (self.mesh.nodes.len(), self.symmetry.sector.len());
        let kept = if planes.shape()[2] == sector { sector } else { all };
        let mut code = |name| -> Result<(Array4<u8>, Array2<i32>), DatabaseError> {
            let planes: ArrayD<u8> = reader.array(name, &[None, instants, Some(kept), Some(3)])?;
            let predictor = reader.array::<i32>(&predictor(name), &[instants, None])?;
            Ok((
                planes.into_dimensionality::<Ix4>().unwrap_or_default(),
                predictor.into_dimensionality::<Ix2>().unwrap_or_default(),
            ))
        };
        let (positions, velocities) = (code("positions")?, code("velocities")?);
        let [positions, velocities] = compact::decode(
            (positions.0.view(), positions.1.view()),
            (velocities.0.view(), velocities.1.view()),
        );
        let expanded = |fields: Snapshots| -> Result<Snapshots, DatabaseError> {
            if kept == all {
                Ok(fields)
            } else {
                fields.iter().map(|f| self.symmetry.expand(f)).collect()
            }
        };
        let (positions, velocities) = (expanded(positions)?, expanded(velocities)?);
        let trajectory = Trajectory {
            parameters,
            status,
            times,
            positions,
            velocities,
            centroid,
            pressure_drop,
        };
        trajectory.validate(all)?;
        Ok(trajectory)
    }

    /// The trajectories of all configurations that have snapshots, ascending in their parameters, read one by one.
    ///
    /// # Errors
    /// As [`Database::entries`], then as [`Database::read`] for each.
    pub fn trajectories(&self) -> Result<impl Iterator<Item = Result<Trajectory, DatabaseError>> + '_, DatabaseError> {
        let entries = self.entries()?.into_iter().filter(|e| e.snapshots > 0);
        Ok(entries.map(|e| self.read(&e.parameters)))
    }

    /// A digest of all files and their names: FNV-1a, 64 bits.
    ///
    /// # Errors
    /// [`DatabaseError::Io`] when a file cannot be read.
    pub fn digest(&self) -> Result<u64, DatabaseError> {
        let mut digest = 0xcbf2_9ce4_8422_2325u64;
        let mut feed = |bytes: &[u8]| {
            for b in bytes {
                digest = (digest ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        for file in self.files()? {
            let path = self.directory.join(&file);
            feed(file.as_bytes());
            feed(&std::fs::read(&path).map_err(DatabaseError::io("read", &path))?);
        }
        Ok(digest)
    }

    /// The names of the database's files, sorted; temporary and foreign files left out.
    fn files(&self) -> Result<Vec<String>, DatabaseError> {
        let failed = || DatabaseError::io("read", &self.directory);
        let mut names = Vec::new();
        for entry in std::fs::read_dir(&self.directory).map_err(failed())? {
            let name = entry.map_err(failed())?.file_name().to_string_lossy().into_owned();
            if !name.starts_with('.') && (name.ends_with(".npz") || name == "database.json") {
                names.push(name);
            }
        }
        names.sort();
        Ok(names)
    }

    fn head(&self, reader: &mut Reader) -> Result<(Vec<f64>, Status), DatabaseError> {
        let parameters: Vec<f64> = reader.vector("parameters", Some(self.description.parameters.len()))?;
        finite("parameters", &parameters)?;
        let status: Vec<u8> = reader.vector("status", None)?;
        Ok((
            parameters,
            serde_json::from_slice(&status).map_err(DatabaseError::json(reader.path()))?,
        ))
    }

    /// `ca0.1000_al0.9000.npz`: four to six decimals.
    fn file_name(&self, parameters: &[f64]) -> String {
        let text = |value: &f64| {
            let mut text = format!("{value:.6}");
            for _ in 0..2 {
                if text.ends_with('0') {
                    text.pop();
                }
            }
            text
        };
        let pairs = self.description.parameters.iter().zip(parameters);
        let parts: Vec<String> = pairs.map(|(p, v)| format!("{}{}", p.symbol, text(v))).collect();
        parts.join("_") + ".npz"
    }
}

/// The name of the array with the prediction's coefficients of a field.
fn predictor(field: &str) -> String {
    format!("{field}_predictor")
}

#[cfg(test)]
#[path = "database_tests.rs"]
mod tests;
