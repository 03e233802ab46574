//! Other people's data: trajectories of any capsules on one mesh, over one to four parameters of any meaning.
//!
//! [`Collection::read`] takes an NPZ or HDF5 file with these arrays, or a folder of VTU series with a table of their
//! parameters, see [`series`]:
//!
//! | array | shape | |
//! |---|---|---|
//! | `parameters` | (Nc, P) | P from 1 to 4; a row for each configuration, all different |
//! | `times` | (Nt,) | rising from 0, the same for all configurations |
//! | `positions` | (Nc, Nt, Nx, 3) | nodes in the laboratory frame, x along the channel |
//! | `elements` | (Ne, 3) or (Ne, 6) | nodes of each triangle, counter-clockwise from outside; 6: mid-edges (0,1) (1,2) (2,0) last |
//! | `velocities` | as `positions` | optional; else the derivative of a spline through the positions |
//! | `parameter_names` | (P,) | optional texts |
//! | `length_unit`, `time_unit` | () | optional texts |

mod arrays;
mod hdf5;
mod npz;
pub mod series;
mod spline;
#[cfg(test)]
mod tests;

use std::path::Path;

use crate::error::{finite, length};
use crate::{DatabaseError, Mesh, Status, Trajectory};

/// The most parameters.
pub const MAX_PARAMETERS: usize = 4;

/// Trajectories on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Collection {
    /// The parameters' names, `[P]`.
    pub parameter_names: Vec<String>,
    /// The unit of lengths, if it is known.
    pub length_unit: Option<String>,
    /// The unit of times, if it is known.
    pub time_unit: Option<String>,
    /// `[N_c][P]`
    pub parameters: Vec<Vec<f64>>,
    /// The instants, rising from 0.
    pub times: Vec<f64>,
    /// Triangles as in [`Mesh`].
    pub elements: Vec<[u32; 6]>,
    /// `[N_c][N_t][N_x]`, laboratory frame.
    pub positions: Vec<Vec<Vec<[f64; 3]>>>,
    /// Like the positions.
    pub velocities: Vec<Vec<Vec<[f64; 3]>>>,
}

impl Collection {
    /// Reads a `.npz`, `.h5` or `.hdf5` file, or a folder of VTU series; with warnings, of what was taken otherwise than
    /// it stands in the files.
    ///
    /// # Errors
    /// What is missing, misshapen or not finite, by the array's name and with the shape that was expected.
    pub fn read(path: &Path) -> Result<(Self, Vec<String>), DatabaseError> {
        if path.is_dir() {
            return series::read(path);
        }
        let collection = match path.extension().and_then(|extension| extension.to_str()) {
            Some("npz") => arrays::collection(&mut npz::Archive::open(path)?),
            Some("h5" | "hdf5") => arrays::collection(&mut hdf5::Archive::open(path)?),
            _ => Err(DatabaseError::UnknownKind {
                path: path.to_path_buf(),
            }),
        };
        Ok((collection?, Vec::new()))
    }

    /// A collection of given parts; velocities that are not there (an empty list) are derived from the positions.
    ///
    /// # Errors
    /// What does not fit, by name.
    pub fn new(parts: Self) -> Result<Self, DatabaseError> {
        let mut collection = parts;
        check_times(&collection.times)?;
        length(
            "configurations in `positions`",
            collection.parameters.len(),
            collection.positions.len(),
        )?;
        if collection.positions.iter().flatten().next().is_none() {
            return Err(DatabaseError::WrongLength {
                what: "configurations in `positions`, at least".to_owned(),
                expected: 1,
                found: 0,
            });
        }
        if collection.velocities.is_empty() {
            let derivative = spline::Derivative::new(&collection.times);
            let all = collection.positions.iter();
            collection.velocities = all.map(|positions| derivative.of(positions)).collect();
        }
        collection.validate()?;
        Ok(collection)
    }

    fn validate(&self) -> Result<(), DatabaseError> {
        length(
            "`parameter_names`",
            self.parameters[0].len(),
            self.parameter_names.len(),
        )?;
        for (second, row) in self.parameters.iter().enumerate() {
            length(
                &format!("numbers in row {second} of `parameters`"),
                self.parameter_names.len(),
                row.len(),
            )?;
            if let Some(first) = self.parameters[..second].iter().position(|other| other == row) {
                return Err(DatabaseError::SameParameters { first, second });
            }
        }
        let mesh = Mesh {
            nodes: self.positions[0][0].clone(),
            elements: self.elements.clone(),
        };
        mesh.validate()?;
        for configuration in 0..self.parameters.len() {
            self.trajectory(configuration, &mesh)?.validate(mesh.nodes.len())?;
        }
        Ok(())
    }

    /// The mesh in the mean initial shape of all configurations, in the centroid's frame, and the radius of the sphere of
    /// the same volume.
    ///
    /// # Errors
    /// [`DatabaseError::BadMesh`] for a surface that encloses no volume, or is inside out.
    pub fn reference(&self) -> Result<(Mesh, f64), DatabaseError> {
        let mut mesh = Mesh {
            nodes: vec![[0.0; 3]; self.positions[0][0].len()],
            elements: self.elements.clone(),
        };
        let share = 1.0 / self.positions.len() as f64;
        for (configuration, positions) in self.positions.iter().enumerate() {
            let (volume, centroid) = mesh.volume_and_centroid(&positions[0])?;
            let radius = positions[0].as_flattened().iter().fold(0.0, |r: f64, x| r.max(x.abs()));
            if volume.is_nan() || volume <= 1e-9 * radius.powi(3) {
                let reason = format!(
                    "`elements` enclose the volume {volume:e} in configuration {configuration}; expected a closed surface \
                     with the nodes of each triangle counter-clockwise from outside"
                );
                return Err(DatabaseError::BadMesh { reason });
            }
            for (node, position) in mesh.nodes.iter_mut().zip(&positions[0]) {
                for d in 0..3 {
                    node[d] += share * (position[d] - if d == 0 { centroid } else { 0.0 });
                }
            }
        }
        let (volume, _) = mesh.volume_and_centroid(&mesh.nodes)?;
        Ok((mesh, (0.75 * volume / std::f64::consts::PI).cbrt()))
    }

    /// One configuration; the mesh gives the centroid. Whether it became steady is not known.
    ///
    /// # Errors
    /// [`DatabaseError::WrongLength`] for another mesh.
    pub fn trajectory(&self, configuration: usize, mesh: &Mesh) -> Result<Trajectory, DatabaseError> {
        let positions = self.positions[configuration].clone();
        let centroid = positions.iter().map(|nodes| Ok(mesh.volume_and_centroid(nodes)?.1));
        Ok(Trajectory {
            parameters: self.parameters[configuration].clone(),
            status: Status::Unsteady,
            times: self.times.clone(),
            centroid: centroid.collect::<Result<_, DatabaseError>>()?,
            pressure_drop: vec![0.0; self.times.len()],
            velocities: self.velocities[configuration].clone(),
            positions,
        })
    }

    /// Whether the velocities are the derivative of the spline through the positions, as [`Collection::new`] computes it where none
    /// are given.
    #[must_use]
    pub fn velocities_are_derived(&self) -> bool {
        let derivative = spline::Derivative::new(&self.times);
        let mut runs = self.positions.iter().zip(&self.velocities);
        runs.all(|(positions, velocities)| derivative.of(positions) == *velocities)
    }

    /// Least and greatest value of each parameter.
    #[must_use]
    pub fn ranges(&self) -> Vec<[f64; 2]> {
        let range = |d: usize| {
            let values = self.parameters.iter().map(|row| row[d]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
        };
        (0..self.parameter_names.len()).map(range).collect()
    }

    /// A digest of the numbers and names: FNV-1a, 64 bits. The same whatever kind of file they were read from.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let mut digest = 0xcbf2_9ce4_8422_2325u64;
        let mut feed = |bytes: &[u8]| {
            for b in bytes {
                digest = (digest ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        let units = self.length_unit.iter().chain(&self.time_unit);
        self.parameter_names
            .iter()
            .chain(units)
            .for_each(|text| feed(text.as_bytes()));
        self.elements.as_flattened().iter().for_each(|n| feed(&n.to_le_bytes()));
        let fields = self.positions.iter().chain(&self.velocities).flatten();
        let numbers = self.parameters.iter().flatten().chain(&self.times);
        let numbers = numbers.chain(fields.flat_map(|field| field.as_flattened()));
        numbers.for_each(|x| feed(&x.to_le_bytes()));
        digest
    }
}

/// Checks instants: at least two, rising from 0.
pub(crate) fn check_times(times: &[f64]) -> Result<(), DatabaseError> {
    finite("`times`", times)?;
    if times.len() < 2 {
        return Err(DatabaseError::WrongLength {
            what: "instants in `times`, at least".to_owned(),
            expected: 2,
            found: times.len(),
        });
    }
    let mut previous = 0.0;
    for (index, &value) in times.iter().enumerate() {
        if (index == 0 && value != 0.0) || (index > 0 && value <= previous) {
            return Err(DatabaseError::TimesNotIncreasing { index, value, previous });
        }
        previous = value;
    }
    Ok(())
}

/// Node indices from whole numbers, three or six an element.
pub(crate) fn elements(values: &[f64], per_element: usize, nodes: usize) -> Result<Vec<[u32; 6]>, DatabaseError> {
    for (index, value) in values.iter().enumerate() {
        if !(*value >= 0.0 && *value < nodes as f64 && value.fract() == 0.0) {
            let reason = format!(
                "`elements`: value {index} is {value}, expected a node's index from 0 to {}",
                nodes - 1
            );
            return Err(DatabaseError::BadMesh { reason });
        }
    }
    let place = |k: usize| if k < per_element { k } else { k - 3 };
    let element = |nodes: &[f64]| std::array::from_fn(|k| nodes[place(k)] as u32);
    Ok(values.chunks_exact(per_element).map(element).collect())
}

/// `parameter_1`, `parameter_2`, ... for parameters without names.
pub(crate) fn numbered(parameters: usize) -> Vec<String> {
    (1..=parameters).map(|d| format!("parameter_{d}")).collect()
}
