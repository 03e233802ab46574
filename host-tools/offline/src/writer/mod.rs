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
    /// Units of a capsule in the channel.
    pub(crate) fn channel() -> Self {
        Units {
            length: "l".to_owned(),
            velocity: "V".to_owned(),
            time: "l/V".to_owned(),
        }
    }

    /// Units of imported data, as far as they are known.
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

/// Writes a model file in the units that `scaling` leads to. The first settings are stored as text, as they were
/// given; the second, in the working units, are used.
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

#[cfg(test)]
#[path = "../../tests/support/mesh.rs"]
mod octahedron;

#[cfg(test)]
mod tests {
    use super::octahedron::octahedral;
    use super::*;
    use crate::LeftOut;
    use crate::pod::Snapshots;
    use crate::pod::tests::{motion, times};
    use crate::samples::State;
    use crate::{Storage, Truncation};
    use capsule_core::model::wire::{Method, Reference};
    use capsule_core::{Model, model::MatrixView};
    use capsule_database::{Mesh, Symmetry};

    /// Truncation error of the fixture, l.
    pub(super) const TOLERANCE: f64 = 1e-4;

    /// A model of one cluster of nine samples, and all that it was made from.
    pub(super) struct Fixture {
        pub(super) mesh: Mesh,
        pub(super) owned: OwnedMesh,
        pub(super) parameters: Vec<[f64; 2]>,
        pub(super) states: Vec<[State; 2]>,
        pub(super) cluster: OwnedCluster,
        domain: Domain,
        settings: Settings,
    }

    impl Fixture {
        pub(super) fn new() -> Self {
            let mesh = octahedral(1);
            let symmetry = Symmetry::detect(&mesh.nodes);
            let owned = OwnedMesh::new(&mesh, &symmetry, Reference::Sphere).unwrap();
            let parameters: Vec<[f64; 2]> = (0..9)
                .map(|j| [0.05 + 0.01 * f64::from(j % 3), 0.8 + 0.1 * f64::from(j / 3)])
                .collect();
            let states = motion(3 * symmetry.sector.len(), parameters.len());
            let borrowed: Vec<[&State; 2]> = states.iter().map(|[u, v]| [u, v]).collect();
            let truncation = Truncation::Tolerance(TOLERANCE);
            let snapshots = Snapshots::new(&borrowed, &times(), mesh.nodes.len(), truncation).unwrap();
            let pod = snapshots.reduce(&(0..parameters.len()).collect::<Vec<_>>()).unwrap();
            let rows: Vec<&[f64]> = parameters.iter().map(|row| &row[..]).collect();
            let mut cluster = OwnedCluster::new([0.8, 1.0], &rows, &snapshots, &pod, &owned, 2, Storage::Integer);
            let left_out = |j: usize| LeftOut {
                parameters: parameters[j].to_vec(),
                cluster: 0,
                answers: true,
                inside: true,
                method: Method::Direct,
                laboratory: vec![1e-3 * j as f64, 2e-3 * j as f64],
                shape: Vec::new(),
                deviation: 0.5 + j as f64,
            };
            let left_out: Vec<LeftOut> = (0..parameters.len()).map(left_out).collect();
            cluster.errors[0] = OwnedErrors::new(&left_out, 2, 3e-5);
            let domain = Domain {
                names: vec!["capillary_number".to_owned(), "confinement".to_owned()],
                units: Units::channel(),
                ranges: vec![[0.05, 0.07], [0.8, 1.0]],
                steady_limit: vec![[0.8, 0.2], [1.0, 0.1]],
                bending_stiffness: Some(1e-4),
                bending_effect: vec![[0.05, 0.9, 0.003]],
                border: vec![[0.85, 0.055], [0.95, 0.065]],
                times: times(),
                error_times: vec![1.0, 2.0],
                database_digest: "0123".to_owned(),
            };
            let settings = Settings {
                created_unix_s: 7,
                ..Settings::default()
            };
            Self {
                mesh,
                owned,
                parameters,
                states,
                cluster,
                domain,
                settings,
            }
        }

        /// The file of some clusters.
        pub(super) fn file(&self, clusters: &[&OwnedCluster]) -> Vec<u8> {
            let scaling = Scaling::none(&self.domain.ranges);
            let settings = [&self.settings, &self.settings];
            write(settings, &self.domain, &self.owned, clusters, &scaling).unwrap()
        }
    }

    #[test]
    fn metadata_and_settings_are_read_as_they_were_written() {
        let fixture = Fixture::new();
        let file = fixture.file(&[&fixture.cluster]);
        let model = Model::open(&file).unwrap();
        let (domain, settings) = (&fixture.domain, &fixture.settings);
        assert_eq!(
            [model.title(), model.membrane_law(), model.database_digest()],
            [&settings.title, &settings.membrane_law, "0123"]
        );
        assert_eq!((model.units().length, model.units().time), ("l", "l/V"));
        assert_eq!((model.created_unix_s(), model.bending_stiffness()), (7, Some(1e-4)));
        assert_eq!(model.default_method(), settings.default_method);
        for (found, (name, range)) in model.parameters().iter().zip(domain.names.iter().zip(&domain.ranges)) {
            assert_eq!((found.name, [found.min, found.max]), (&name[..], *range));
        }
        let text: serde_json::Value = serde_json::from_str(model.offline_settings()).unwrap();
        // The creation time has a field of its own, so that the settings of equal models are equal.
        assert_eq!(text["created_unix_s"], 0);
        assert_eq!(text["spacing"], settings.spacing);
        let column = |view: MatrixView<'_>| -> Vec<f32> { (0..view.rows()).map(|row| view.get(row, 0)).collect() };
        let singles = |values: &[f64]| -> Vec<f32> { values.iter().map(|value| *value as f32).collect() };
        assert_eq!(column(model.times()), singles(&domain.times));
        assert_eq!(column(model.error_times()), singles(&domain.error_times));
        assert!((model.steady_limit(0.9_f64).unwrap() - 0.15).abs() < 1e-7);
        assert!((model.jump_curve().at(0.9_f64).unwrap() - 0.06).abs() < 1e-7);
        assert_eq!(model.bending_effect().get(0, 2), 0.003);
        let contents = model.contents();
        assert_eq!((contents.kernel, contents.paper), (settings.kernel, settings.paper));
    }
}
