//! The samples: configurations of a database as states over the sector's nodes.

use capsule_database::{Collection, Database, Entry, Mesh, Symmetry, Trajectory};
use faer::Mat;
use rayon::prelude::*;
use std::cmp::Ordering;

use crate::limit::SteadyLimit;
use crate::settings::{Design, Split};
use crate::tolerances::{SAME_ROW, SYMMETRIC};
use crate::{OfflineError, Progress, Settings};

/// One field of one sample at all instants.
pub(crate) struct State {
    /// `sqrt(N_x)` times the centroid's axial position or velocity, `[N_t]`.
    pub(crate) translation: Vec<f64>,
    /// The shape at the sector's nodes, each component times the square root of its orbit's size, so that the Euclidean
    /// product of two shapes is that over the full mesh; `[3 N_s, N_t]`.
    pub(crate) shape: Mat<f64>,
}

/// One configuration.
pub(crate) struct Sample {
    /// (Ca, a/l), or those of other people's data, as they were given.
    pub(crate) given: Vec<f64>,
    /// In the working units.
    pub(crate) parameters: Vec<f64>,
    pub(crate) steady: bool,
    pub(crate) dent: Dent,
    pub(crate) displacement: State,
    pub(crate) velocity: State,
    /// Full-order solution that predictions are compared with.
    pub(crate) truth: Vec<Truth>,
    /// Full-order solution at instants that the model was not built from.
    pub(crate) held_out: Vec<Truth>,
}

/// The dent of the rear: how far the rear pole lies before the rearmost point.
#[derive(Clone, Copy, Default)]
pub(crate) struct Dent {
    /// At the end, over a.
    pub(crate) depth: f64,
    /// When a tenth of that was reached, in l/V.
    pub(crate) start: f64,
}

/// The full-order solution at an instant.
pub(crate) struct Truth {
    pub(crate) time: f64,
    /// Laboratory frame, `[N_x]`.
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) centroid: f64,
}

/// Reads the configurations of a database that take part; a steady one is extended by rigid translation to the end
/// time. The truth is kept at `truth_times`.
///
/// # Errors
/// [`OfflineError::NotSymmetric`], or the database's errors.
pub(crate) fn read(
    database: &Database,
    entries: &[Entry],
    limits: &[SteadyLimit],
    settings: &Settings,
    truth_times: &[f64],
    progress: Progress,
) -> Result<Vec<Sample>, OfflineError> {
    let entries: Vec<_> = entries
        .iter()
        .filter(|entry| takes_part(entry, database.times().len(), limits, settings))
        .collect();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let samples = entries.par_iter().map(|entry| {
        let sample = sample(
            database,
            &database.read(&entry.parameters)?,
            settings.spacing,
            truth_times,
        )?;
        progress(
            "read snapshots",
            1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed),
            entries.len(),
        );
        Ok(sample)
    });
    samples.collect()
}

/// Whether a configuration is a sample: steady and of the design, or unsteady within reach of the limit with all its
/// snapshots.
fn takes_part(entry: &Entry, instants: usize, limits: &[SteadyLimit], settings: &Settings) -> bool {
    let [capillary_number, confinement] = [entry.parameters[0], entry.parameters[1]];
    let chosen = match settings.design {
        Design::All => true,
        Design::Paper => {
            let multiple = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
            let grid = multiple(capillary_number, 0.01) || (capillary_number - 0.005).abs() < 1e-9;
            let [(low, high), (narrow, wide)] = [(0.005, 0.20), (0.75, 1.20)];
            let inside = |value: f64, low, high| value > low - 1e-9 && value < high + 1e-9;
            grid && multiple(confinement, 0.05)
                && inside(capillary_number, low, high)
                && inside(confinement, narrow, wide)
                && entry.status.is_steady()
        }
    };
    let row = limits.iter().find(|l| (l.confinement - confinement).abs() <= SAME_ROW);
    let complete = if entry.status.is_steady() {
        entry.snapshots > 0
    } else {
        let reach = row.and_then(|row| row.largest_steady_ca).unwrap_or(0.0) + settings.beyond;
        entry.snapshots == instants && capillary_number <= reach
    };
    chosen && complete
}

/// Those of increasing instants that a model keeps ([`Settings::spacing`]): the first, the last and what lies far
/// enough from the one kept before.
pub(crate) fn instants(times: &[f64], spacing: f64) -> Vec<f64> {
    let mut kept: Vec<f64> = Vec::new();
    for (i, time) in times.iter().enumerate() {
        let far = kept
            .last()
            .is_none_or(|last| time - last > spacing * time * (1.0 - 1e-9));
        if far || i + 1 == times.len() {
            kept.push(*time);
        }
    }
    kept
}

fn sample(database: &Database, stored: &Trajectory, spacing: f64, truth_times: &[f64]) -> Result<Sample, OfflineError> {
    let (mesh, symmetry) = (database.mesh(), database.symmetry());
    for field in stored.positions.iter().chain(&stored.velocities) {
        let deviation = symmetry.deviation(field)?;
        if deviation > SYMMETRIC {
            let parameters = stored.parameters.clone();
            return Err(OfflineError::NotSymmetric {
                parameters,
                deviation,
                limit: SYMMETRIC,
            });
        }
    }
    let times = instants(database.times(), spacing);
    let times = &times[..];
    let end = stored.times.last().copied().unwrap_or(0.0);
    let trajectory = stored.extended(mesh, times)?;
    let confinement = stored.parameters[1];

    let mut speeds: Vec<f64> = Vec::with_capacity(times.len());
    for i in 0..times.len() {
        // Beyond the stored end the capsule translates rigidly.
        let speed = match speeds.last() {
            Some(last) if times[i] > end && times[i - 1] > end => *last,
            _ => mesh.centroid_velocity(&trajectory.positions[i], &trajectory.velocities[i])?,
        };
        speeds.push(speed);
    }
    let [displacement, velocity] = states(mesh, symmetry, confinement, &trajectory, &speeds);
    Ok(Sample {
        given: stored.parameters.clone(),
        parameters: stored.parameters.clone(),
        steady: stored.status.is_steady(),
        dent: dent(database.mesh(), stored),
        displacement,
        velocity,
        truth: truths(stored.extended(mesh, truth_times)?),
        held_out: Vec::new(),
    })
}

/// The states of a trajectory: displacement from the reference nodes times `scale`, and velocity; `speeds` are the
/// centroid's.
fn states(mesh: &Mesh, symmetry: &Symmetry, scale: f64, trajectory: &Trajectory, speeds: &[f64]) -> [State; 2] {
    let instants = trajectory.times.len();
    let weights: Vec<f64> = symmetry.orbit_sizes().iter().map(|w| f64::from(*w).sqrt()).collect();
    let sector = &symmetry.sector;
    let root = (mesh.nodes.len() as f64).sqrt();
    let displacement = State {
        translation: trajectory.centroid.iter().map(|x| root * x).collect(),
        shape: Mat::from_fn(3 * sector.len(), instants, |row, i| {
            let (s, d) = (row / 3, row % 3);
            let node = sector[s] as usize;
            let origin = if d == 0 { trajectory.centroid[i] } else { 0.0 };
            weights[s] * (trajectory.positions[i][node][d] - origin - scale * mesh.nodes[node][d])
        }),
    };
    let velocity = State {
        translation: speeds.iter().map(|u| root * u).collect(),
        shape: Mat::from_fn(3 * sector.len(), instants, |row, i| {
            let (s, d) = (row / 3, row % 3);
            let mean = if d == 0 { speeds[i] } else { 0.0 };
            weights[s] * (trajectory.velocities[i][sector[s] as usize][d] - mean)
        }),
    };
    [displacement, velocity]
}

impl Truth {
    /// A configuration of a database at some instants.
    pub(crate) fn read(database: &Database, parameters: &[f64], times: &[f64]) -> Result<Vec<Self>, OfflineError> {
        let stored = database.read(parameters)?;
        Ok(truths(stored.extended(database.mesh(), times)?))
    }
}

/// A trajectory as what predictions are compared with.
fn truths(trajectory: Trajectory) -> Vec<Truth> {
    let instants = trajectory
        .positions
        .into_iter()
        .zip(trajectory.times)
        .zip(trajectory.centroid);
    let truth = |((positions, time), centroid)| Truth {
        time,
        positions,
        centroid,
    };
    instants.map(truth).collect()
}

/// The configurations of other people's data in the working units, on their reference mesh; `given` are their
/// parameters in the data's units.
///
/// # Errors
/// The database's errors.
pub(crate) fn of_collection(
    collection: &Collection,
    mesh: &Mesh,
    symmetry: &Symmetry,
    truth_times: &[f64],
    given: &[Vec<f64>],
    progress: Progress,
) -> Result<Vec<Sample>, OfflineError> {
    let count = collection.parameters.len();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let sample = |configuration: usize| {
        let trajectory = collection.trajectory(configuration, mesh)?;
        let moving = trajectory.positions.iter().zip(&trajectory.velocities);
        let speeds = moving.map(|(positions, velocities)| mesh.centroid_velocity(positions, velocities));
        let speeds: Vec<f64> = speeds.collect::<Result<_, _>>()?;
        let [displacement, velocity] = states(mesh, symmetry, 1.0, &trajectory, &speeds);
        let mut truth = truths(trajectory);
        truth.retain(|truth| truth_times.contains(&truth.time));
        progress(
            "reduce snapshots",
            1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed),
            count,
        );
        Ok(Sample {
            given: given[configuration].clone(),
            parameters: collection.parameters[configuration].clone(),
            // A capsule that still changes may go on changing: nothing is extended.
            steady: true,
            dent: Dent::default(),
            displacement,
            velocity,
            truth,
            held_out: Vec::new(),
        })
    };
    (0..count).into_par_iter().map(sample).collect()
}

/// The symmetry that the mean shape and all snapshots of other people's data have, of the operations of the square.
pub(crate) fn common_symmetry(collection: &Collection, mesh: &Mesh, radius: f64) -> Symmetry {
    let unit: Vec<[f64; 3]> = mesh.nodes.iter().map(|node| node.map(|x| x / radius)).collect();
    let keeps = |fields: &[Vec<Vec<[f64; 3]>>], operation: u8, image: &[u32], size: f64| {
        let field_keeps = |field: &Vec<[f64; 3]>| {
            let mut pairs = field.iter().zip(image);
            pairs.all(|(vector, image)| {
                let (expected, found) = (capsule_database::apply(operation, *vector), field[*image as usize]);
                (0..3).all(|d| (expected[d] - found[d]).abs() <= SYMMETRIC * size)
            })
        };
        fields.par_iter().flatten().all(field_keeps)
    };
    let speed = collection
        .velocities
        .iter()
        .flatten()
        .flatten()
        .flatten()
        .fold(0.0, |s: f64, v| s.max(v.abs()));
    Symmetry::detect_where(&unit, |operation, image| {
        keeps(&collection.positions, operation, image, radius)
            && keeps(&collection.velocities, operation, image, speed.max(f64::MIN_POSITIVE))
    })
}

/// The dent that the snapshots show.
fn dent(mesh: &Mesh, stored: &Trajectory) -> Dent {
    let axial = |node: &[f64; 3]| node[0];
    let reference = &mesh.nodes;
    let pole = (0..reference.len()).min_by(|i, j| axial(&reference[*i]).total_cmp(&axial(&reference[*j])));
    let rearmost = |nodes: &[[f64; 3]]| nodes.iter().map(axial).min_by(f64::total_cmp);
    let depth = |nodes: &Vec<[f64; 3]>| {
        pole.zip(rearmost(nodes))
            .map_or(0.0, |(pole, rear)| axial(&nodes[pole]) - rear)
    };
    let depths: Vec<f64> = stored.positions.iter().map(depth).collect();
    let end = depths.last().copied().unwrap_or(0.0);
    let start = depths.iter().position(|depth| *depth >= 0.1 * end).unwrap_or(0);
    Dent {
        depth: end / stored.parameters[1],
        start: stored.times.get(start).copied().unwrap_or(0.0),
    }
}

/// A part of the parameter domain and the samples in it.
#[derive(Clone)]
pub(crate) struct Part {
    /// Least and greatest value of the parameter along which the clusters follow each other.
    pub(crate) range: [f64; 2],
    /// Indices of the samples.
    pub(crate) members: Vec<usize>,
}

/// The fewest samples of a cluster: as many as a quadratic has coefficients, and one more that may be left out.
pub(crate) fn needed(parameters: usize) -> usize {
    (parameters + 1) * (parameters + 2) / 2 + 1
}

/// The clusters: samples up to the split, and from it on; the row at the split belongs to both. One cluster when all
/// samples lie on one side.
///
/// # Errors
/// [`OfflineError::TooFewSamples`] when a cluster has fewer samples than a quadratic has coefficients, and one more
/// that may be left out.
pub(crate) fn clusters(samples: &[Sample], split: Option<Split>, names: &[String]) -> Result<Vec<Part>, OfflineError> {
    let parameter = split.map_or(0, |split| split.parameter);
    let values = || samples.iter().map(|s| s.parameters[parameter]);
    let extremes = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values().fold(extremes, |(a, b), c| (f64::min(a, c), f64::max(b, c)));
    let ranges = match split {
        Some(Split { value, .. }) if low < value - SAME_ROW && high > value + SAME_ROW => {
            vec![[low, value], [value, high]]
        }
        _ => vec![[low, high]],
    };
    let mut clusters = Vec::new();
    for range in ranges {
        let inside = |c: f64| c >= range[0] - SAME_ROW && c <= range[1] + SAME_ROW;
        let mut members: Vec<usize> = (0..samples.len())
            .filter(|j| inside(samples[*j].parameters[parameter]))
            .collect();
        // The order of the file, in which a query finds its neighbours.
        let backwards = |j: &usize| samples[*j].parameters.iter().rev();
        members.sort_by(|a, b| backwards(a).partial_cmp(backwards(b)).unwrap_or(Ordering::Equal));
        let needed = needed(names.len());
        if members.len() < needed {
            return Err(OfflineError::TooFewSamples {
                parameter: names[parameter].clone(),
                range,
                found: members.len(),
                needed,
            });
        }
        clusters.push(Part { range, members });
    }
    Ok(clusters)
}
