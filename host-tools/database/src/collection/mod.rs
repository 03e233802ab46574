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
//! | `elements` | (Ne, 3) or (Ne, 6) | nodes, counter-clockwise from outside; mid-edges (0,1) (1,2) (2,0) last |
//! | `velocities` | as `positions` | optional; else the derivative of a spline through the positions |
//! | `parameter_names` | (P,) | optional texts |
//! | `length_unit`, `time_unit` | () | optional texts |
//!
//! [`Collection::from_arrays`] takes the same arrays in memory. [`Collection::new`] checks all kinds: they must be one
//! closed surface that moves.

#[cfg(test)]
mod array_tests;
mod arrays;
mod closed;
mod dtype;
mod hdf5;
mod memory;
mod motion;
mod npz;
mod parameters;
mod rates;
pub mod series;
mod spline;

use std::path::Path;

pub use memory::{Elements, NamedArray};

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
    /// Reads a `.npz`, `.h5` or `.hdf5` file, or a folder of VTU series; with warnings, of what was taken otherwise
    /// than it stands in the files.
    ///
    /// # Errors
    /// Arrays that are missing, misshapen, of another type or not finite, with file and expectation; collections that
    /// [`Collection::new`] refuses.
    pub fn read(path: &Path) -> Result<(Self, Vec<String>), DatabaseError> {
        if path.is_dir() {
            return series::read(path).map_err(|error| error.read_from(path));
        }
        let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
        let collection = match extension.as_ref().and_then(|extension| extension.to_str()) {
            Some("npz") => arrays::collection(&mut npz::Archive::open(path)?),
            Some("h5" | "hdf5") => arrays::collection(&mut hdf5::Archive::open(path)?),
            _ => Err(DatabaseError::UnknownKind {
                path: path.to_path_buf(),
            }),
        };
        Ok((collection.map_err(|error| error.read_from(path))?, Vec::new()))
    }

    /// A collection of arrays in memory, as [`Collection::read`] reads them from a file.
    ///
    /// # Errors
    /// Arrays that are missing, misshapen, of another type or not finite, by name; collections that
    /// [`Collection::new`] refuses.
    pub fn from_arrays(arrays: Vec<NamedArray>) -> Result<Self, DatabaseError> {
        arrays::collection(&mut memory::Memory::new(arrays))
    }

    /// A collection of given parts; velocities that are not there (an empty list) are derived from the positions. Names
    /// and units lose the blanks around them.
    ///
    /// # Errors
    /// [`DatabaseError::BadCollection`] for what does not fit, by name: names that are empty, alike or longer than 64
    /// bytes; parameters that do not vary, or rows alike; instants that do not rise from 0; fields of other shapes than
    /// `[N_c][N_t][N_x]` or with numbers that are not finite; elements that are not one closed surface; snapshots in
    /// which it has no plausible volume, or that are no continuous motion.
    pub fn new(parts: Self) -> Result<Self, DatabaseError> {
        let trimmed = |text: &String| text.trim().to_owned();
        let unit = |text: Option<String>| text.as_ref().map(trimmed).filter(|text| !text.is_empty());
        let mut collection = Self {
            parameter_names: parts.parameter_names.iter().map(trimmed).collect(),
            length_unit: unit(parts.length_unit),
            time_unit: unit(parts.time_unit),
            ..parts
        };
        collection.check_axes()?;
        collection.check_field("positions", &collection.positions)?;
        let derived = collection.velocities.is_empty();
        if derived {
            collection.velocities = collection.derived_velocities();
        }
        collection.check_field("velocities", &collection.velocities)?;
        let mesh = Mesh {
            nodes: collection.positions[0][0].clone(),
            elements: collection.elements.clone(),
        };
        mesh.validate()?;
        closed::check(&mesh).map_err(DatabaseError::collection)?;
        motion::check(&collection, &mesh)?;
        if !derived {
            rates::check(&collection)?;
        }
        Ok(collection)
    }

    /// Checks names, units, parameters and instants.
    fn check_axes(&self) -> Result<(), DatabaseError> {
        let units = [("`length_unit`", &self.length_unit), ("`time_unit`", &self.time_unit)];
        for (place, unit) in units {
            unit.iter().try_for_each(|unit| parameters::text(place, unit))?;
        }
        parameters::names(&self.parameter_names)?;
        parameters::values(&self.parameter_names, &self.parameters)?;
        check_times(&self.times)
    }

    /// Checks that a field has finite numbers for all configurations, instants and nodes, and at least one of each.
    fn check_field(&self, name: &str, field: &[Vec<Vec<[f64; 3]>>]) -> Result<(), DatabaseError> {
        let count = |what: &str, expected: usize, found: usize| match found {
            found if found == expected && found > 0 => Ok(()),
            _ => Err(DatabaseError::collection(format!(
                "`{name}` has {found} {what}, expected {}",
                expected.max(1)
            ))),
        };
        count("configurations", self.parameters.len(), field.len())?;
        for (j, snapshots) in field.iter().enumerate() {
            count(
                &format!("instants in {}", self.place(j)),
                self.times.len(),
                snapshots.len(),
            )?;
            for (i, nodes) in snapshots.iter().enumerate() {
                count(
                    &format!("nodes in snapshot {i} of {}", self.place(j)),
                    self.positions[0][0].len(),
                    nodes.len(),
                )?;
                if let Some(k) = nodes.as_flattened().iter().position(|x| !x.is_finite()) {
                    let (n, d) = (k / 3, k % 3);
                    return Err(DatabaseError::collection(format!(
                        "`{name}[{j}, {i}, {n}, {d}]` is {}, expected a finite number",
                        nodes[n][d]
                    )));
                }
            }
        }
        Ok(())
    }

    /// A configuration in words: `configuration 3 (flow = 0.4, size = 2)`.
    fn place(&self, j: usize) -> String {
        let parameters = parameters::listed(&self.parameter_names, &self.parameters[j]);
        format!("configuration {j} ({parameters})")
    }

    /// The mesh in the mean initial shape of all configurations, in the centroid's frame, and the radius of the sphere
    /// of the same volume.
    ///
    /// # Errors
    /// [`DatabaseError::BadCollection`] where the initial shapes differ so much that their mean encloses no volume.
    pub fn reference(&self) -> Result<(Mesh, f64), DatabaseError> {
        let mut mesh = Mesh {
            nodes: vec![[0.0; 3]; self.positions[0][0].len()],
            elements: self.elements.clone(),
        };
        let share = 1.0 / self.positions.len() as f64;
        for positions in &self.positions {
            let (_, centroid) = mesh.volume_and_centroid(&positions[0])?;
            for (node, position) in mesh.nodes.iter_mut().zip(&positions[0]) {
                for d in 0..3 {
                    node[d] += share * (position[d] - if d == 0 { centroid } else { 0.0 });
                }
            }
        }
        let (volume, _) = mesh.volume_and_centroid(&mesh.nodes)?;
        if volume.is_nan() || volume <= 0.0 {
            return Err(DatabaseError::collection(
                "`positions`: the mean of the first snapshots of all configurations encloses no volume; expected the \
                 same orientation of the mesh in all",
            ));
        }
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

    /// The derivative of the spline through the positions, as [`Collection::new`] computes it where no velocities are
    /// given; like the positions.
    #[must_use]
    pub fn derived_velocities(&self) -> Vec<Vec<Vec<[f64; 3]>>> {
        let derivative = spline::Derivative::new(&self.times);
        self.positions
            .iter()
            .map(|positions| derivative.of(positions))
            .collect()
    }

    /// Whether the velocities are those.
    #[must_use]
    pub fn velocities_are_derived(&self) -> bool {
        self.derived_velocities() == self.velocities
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

    /// A digest of the numbers and names: FNV-1a, 64 bits. It does not depend on the file format.
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

/// Checks instants: at least two, rising from 0, none closer than 1e-9 of the last.
pub(crate) fn check_times(times: &[f64]) -> Result<(), DatabaseError> {
    let fault = |reason: String| Err(DatabaseError::collection(reason));
    if let Some((i, time)) = times.iter().enumerate().find(|(_, time)| !time.is_finite()) {
        return fault(format!("`times[{i}]` is {time}, expected a finite number"));
    }
    let [start, .., end] = times else {
        let found = times.len();
        return fault(format!("`times` holds {found} instants, expected at least 2"));
    };
    if *start != 0.0 {
        return fault(format!(
            "`times` must rise from 0, but start at {start}: `times - times[0]` counts from the start"
        ));
    }
    for (i, pair) in times.windows(2).enumerate() {
        if pair[1] - pair[0] <= 1e-9 * end.abs() {
            let ([before, time], i) = ([pair[0], pair[1]], i + 1);
            return fault(format!(
                "`times` must rise from 0: `times[{i}]` is {time} after {before}, expected a later instant"
            ));
        }
    }
    Ok(())
}

/// Node indices from whole numbers, three or six an element.
pub(crate) fn elements(values: &[f64], per_element: usize, nodes: usize) -> Result<Vec<[u32; 6]>, DatabaseError> {
    for (index, value) in values.iter().enumerate() {
        if !(*value >= 0.0 && *value < nodes as f64 && value.fract() == 0.0) {
            let (e, k, last) = (index / per_element, index % per_element, nodes - 1);
            let from_one = values.iter().all(|value| (1.0..=nodes as f64).contains(value));
            let hint = if from_one { ": `elements - 1` counts from 0" } else { "" };
            return Err(DatabaseError::collection(format!(
                "`elements[{e}, {k}]` is {value}, expected the number of a node, from 0 to {last}{hint}"
            )));
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
