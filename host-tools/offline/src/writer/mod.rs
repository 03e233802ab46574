//! From reduced clusters to the bytes of a model file, a file for each section of the format.

mod cluster;
mod errors;
mod field;
mod matrix;
mod mesh;

use capsule_core::interpolate::Coordinates;
use capsule_core::model::wire::{self, Contents, Metadata, Parameter};
use capsule_core::model::{Curve, encode};

use crate::scaling::Scaling;
use crate::{OfflineError, Settings};

pub(crate) use cluster::OwnedCluster;
pub(crate) use errors::OwnedErrors;
pub(crate) use matrix::StoredMatrix;
pub(crate) use mesh::OwnedMesh;

/// Bytes of a file besides arrays and texts: header, lengths, pads, numbers, names of units.
const FRAME: usize = 8192;

/// Indices as a blob of u16.
fn indices<'a>(values: impl IntoIterator<Item = &'a u32>) -> Vec<u8> {
    // OwnedMesh::new has checked the number of nodes, so every index fits.
    values.into_iter().flat_map(|v| (*v as u16).to_le_bytes()).collect()
}

/// Names of the units.
#[derive(Clone)]
pub(crate) struct Units {
    length: String,
    velocity: String,
    time: String,
}

impl Units {
    /// Those of the channel.
    pub(crate) fn channel() -> Self {
        Units {
            length: "l".to_owned(),
            velocity: "V".to_owned(),
            time: "l/V".to_owned(),
        }
    }

    /// Those of other people's data, as far as they are known.
    pub(crate) fn new(length: Option<&str>, time: Option<&str>) -> Self {
        let (length, time) = (length.unwrap_or("length unit"), time.unwrap_or("time unit"));
        Units {
            length: length.to_owned(),
            velocity: format!("{length}/{time}"),
            time: time.to_owned(),
        }
    }
}

/// The domain and the origin of the data.
pub(crate) struct Domain {
    /// The parameters' names.
    pub(crate) names: Vec<String>,
    pub(crate) units: Units,
    /// Least and greatest value of each parameter, in the working units.
    pub(crate) ranges: Vec<[f64; 2]>,
    /// (a/l, Ca)
    pub(crate) steady_limit: Vec<[f64; 2]>,
    /// In G_s a^2, if it is known.
    pub(crate) bending_stiffness: Option<f64>,
    /// (Ca, a/l, effect of the bending stiffness as a fraction of a)
    pub(crate) bending_effect: Vec<[f64; 3]>,
    /// (a/l, Ca)
    pub(crate) border: Vec<[f64; 2]>,
    pub(crate) times: Vec<f64>,
    /// The instants of the leave-one-out errors.
    pub(crate) error_times: Vec<f64>,
    pub(crate) database_digest: String,
}

/// Writes a model file in the units that `scaling` leads to. The settings are told as they were given, and used in the
/// working units.
///
/// # Errors
/// [`OfflineError::Encode`].
pub(crate) fn write(
    [given, settings]: [&Settings; 2],
    domain: &Domain,
    mesh: &OwnedMesh,
    clusters: &[&OwnedCluster],
    scaling: &Scaling,
) -> Result<Vec<u8>, OfflineError> {
    // The creation time is not a setting of the mathematics, and has its own place.
    let text = serde_json::to_string(&Settings {
        created_unix_s: 0,
        ..given.clone()
    })
    .unwrap_or_default();
    let [times, error_times] =
        [&domain.times, &domain.error_times].map(|t| StoredMatrix::column(t).times(scaling.time));
    let limit = StoredMatrix::new(domain.steady_limit.len(), 2, |i, d| domain.steady_limit[i][d]);
    let border = StoredMatrix::new(domain.border.len(), 2, |i, d| domain.border[i][d]);
    let effect = StoredMatrix::new(domain.bending_effect.len(), 3, |i, d| domain.bending_effect[i][d]);
    let parameters = domain.names.iter().zip(&scaling.parameters);
    let parameters = parameters.map(|(name, parameter)| Parameter {
        name,
        min: parameter.range[0],
        max: parameter.range[1],
        origin: parameter.origin,
        scale: parameter.scale,
    });
    let [limit_matrix, border_matrix] = [&limit, &border].map(StoredMatrix::matrix);
    let mesh = mesh.scaled(scaling);
    let clusters: Vec<OwnedCluster> = clusters.iter().map(|cluster| cluster.scaled(scaling)).collect();
    let coordinates = Coordinates {
        scales: settings.kernel.scales,
        limit: (limit.rows > 0).then_some(Curve::new(&limit_matrix)),
        jump_curve: Curve::new(&border_matrix),
    };
    let places: Vec<StoredMatrix> = clusters.iter().map(|cluster| cluster.places(&coordinates)).collect();
    let contents = Contents {
        metadata: Metadata {
            title: &settings.title,
            units: wire::Units {
                length: &domain.units.length,
                velocity: &domain.units.velocity,
                time: &domain.units.time,
            },
            membrane_law: &settings.membrane_law,
            bending_stiffness: domain.bending_stiffness,
            parameters: parameters.collect(),
            database_digest: &domain.database_digest,
            offline_settings: &text,
            created_unix_s: settings.created_unix_s,
        },
        mesh: mesh.wire(),
        times: times.matrix(),
        error_times: error_times.matrix(),
        steady_limit: limit_matrix,
        bending_effect: effect.matrix(),
        border: border_matrix,
        default_method: settings.default_method,
        kernel: settings.kernel,
        paper: settings.paper,
        split: settings.split.map_or(0, |split| split.parameter) as u8,
        clusters: clusters.iter().zip(&places).map(|(c, places)| c.wire(places)).collect(),
    };
    let texts = text.len() + settings.title.len() + settings.membrane_law.len();
    let names: usize = domain.names.iter().map(String::len).sum();
    let tables = [&times, &error_times, &limit, &effect, &border].map(StoredMatrix::byte_len);
    let arrays: usize = tables.iter().chain(&[mesh.byte_len()]).sum();
    let arrays = arrays + clusters.iter().map(OwnedCluster::byte_len).sum::<usize>();
    let mut buffer = vec![0; FRAME + texts + names + arrays];
    let length = encode(&contents, &mut buffer).map_err(OfflineError::Encode)?;
    buffer.truncate(length);
    Ok(buffer)
}
