//! A cluster: samples, motion, errors.

use capsule_core::Parameters;
use capsule_core::interpolate::Coordinates;
use capsule_core::model::MatrixView;
use capsule_core::model::wire::{Cluster, MAX_PARAMETERS, Samples};

use super::errors::OwnedErrors;
use super::field::OwnedField;
use super::matrix::StoredMatrix;
use super::mesh::OwnedMesh;
use crate::pod::{DoublePod, Snapshots};
use crate::scaling::Scaling;
use crate::settings::Storage;

/// A cluster of a model file, with its bytes.
#[derive(Clone)]
pub(crate) struct OwnedCluster {
    range: [f64; 2],
    samples: StoredMatrix,
    field: OwnedField,
    /// Of the direct method and of the paper's.
    pub(crate) errors: [OwnedErrors; 2],
    /// Errors between the instants, `[N_c, N_t - 1]`, or none.
    pub(crate) interval_errors: StoredMatrix,
    /// The 95 % bound as a multiple of them, `[N_t - 1, 1]`, or none.
    pub(crate) interval_bound_factors: StoredMatrix,
}

impl OwnedCluster {
    /// The cluster of the samples at `parameters`, from their double POD; errors unknown.
    pub(crate) fn new(
        range: [f64; 2],
        parameters: &[&[f64]],
        snapshots: &Snapshots,
        pod: &DoublePod,
        mesh: &OwnedMesh,
        error_times: usize,
        storage: Storage,
    ) -> Self {
        let unknown = || OwnedErrors::unknown(parameters.len(), error_times);
        OwnedCluster {
            range,
            samples: StoredMatrix::new(
                parameters.len(),
                parameters.first().map_or(0, |row| row.len()),
                |j, d| parameters[j][d],
            ),
            field: OwnedField::new(snapshots, pod, mesh, storage),
            errors: [unknown(), unknown()],
            interval_errors: StoredMatrix::new(0, 0, |_, _| 0.0),
            interval_bound_factors: StoredMatrix::new(0, 0, |_, _| 0.0),
        }
    }

    /// Without the samples at these places: the modes and coefficients stay.
    pub(crate) fn without(&self, out: &[usize]) -> Self {
        OwnedCluster {
            samples: self.samples.without(out),
            field: self.field.without(out),
            errors: self.errors.each_ref().map(|errors| errors.without(out)),
            interval_errors: self.interval_errors.without(out),
            interval_bound_factors: self.interval_bound_factors.clone(),
            range: self.range,
        }
    }

    /// In the units of the data.
    pub(super) fn scaled(&self, scaling: &Scaling) -> Self {
        OwnedCluster {
            field: self.field.scaled(scaling),
            ..self.clone()
        }
    }

    /// The samples in the coordinates of the interpolation.
    pub(super) fn places(&self, coordinates: &Coordinates<'_>) -> StoredMatrix {
        let matrix = self.samples.matrix();
        let samples = MatrixView::new(&matrix);
        let place = |j: usize| {
            let parameters: Vec<f64> = (0..samples.columns()).map(|d| samples.get(j, d).into()).collect();
            let parameters = Parameters::new(&parameters);
            parameters.map_or([0.0; MAX_PARAMETERS], |parameters| coordinates.transform(&parameters))
        };
        let places: Vec<_> = (0..samples.rows()).map(place).collect();
        StoredMatrix::new(samples.rows(), samples.columns(), |j, d| places[j][d])
    }

    /// Bytes of its arrays.
    pub(super) fn byte_len(&self) -> usize {
        let samples = 2 * self.samples.byte_len();
        let intervals = self.interval_errors.byte_len() + self.interval_bound_factors.byte_len();
        samples + intervals + self.field.byte_len() + self.errors.iter().map(OwnedErrors::byte_len).sum::<usize>()
    }

    pub(super) fn wire<'a>(&'a self, places: &'a StoredMatrix) -> Cluster<'a> {
        Cluster {
            min: self.range[0],
            max: self.range[1],
            samples: Samples {
                parameters: self.samples.matrix(),
                places: places.matrix(),
            },
            field: self.field.wire(),
            direct_errors: self.errors[0].wire(),
            paper_errors: self.errors[1].wire(),
            interval_errors: self.interval_errors.matrix(),
            interval_bound_factors: self.interval_bound_factors.matrix(),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::writer::tests::Fixture;
    use capsule_core::Model;

    #[test]
    fn the_samples_are_read_as_they_were_written() {
        let fixture = Fixture::new();
        let left = fixture.cluster.without(&[1, 5]);
        let kept = [0, 2, 3, 4, 6, 7, 8];
        let all: Vec<usize> = (0..fixture.parameters.len()).collect();
        for (cluster, expected) in [(&fixture.cluster, &all[..]), (&left, &kept)] {
            let file = fixture.file(&[cluster]);
            let model = Model::open(&file).unwrap();
            let read = model.clusters().next().unwrap();
            assert_eq!(read.range(), [0.8, 1.0]);
            let rows: Vec<[f32; 2]> = read.parameters().pairs().collect();
            let expected = expected
                .iter()
                .map(|j| fixture.parameters[*j].map(|value| value as f32));
            assert_eq!(rows, expected.collect::<Vec<_>>());
        }
    }
}
