//! Leave-one-out errors of a cluster.

use capsule_core::model::wire::Errors;

use super::matrix::StoredMatrix;
use crate::LeftOut;

/// Errors of one method at the samples of a cluster.
#[derive(Clone)]
pub(crate) struct OwnedErrors {
    /// `[N_c, N_e]`
    pub(crate) left_out: StoredMatrix,
    /// `[N_c, 1]`
    pub(crate) deviation: StoredMatrix,
    /// `[N_e, 1]`
    pub(crate) bound_factors: StoredMatrix,
    /// `[N_e, 1]`
    pub(crate) changes: StoredMatrix,
    pub(crate) floor: f64,
}

impl OwnedErrors {
    /// Placeholders for errors that are not measured yet.
    pub(crate) fn unknown(samples: usize, times: usize) -> Self {
        OwnedErrors {
            left_out: StoredMatrix::new(samples, times, |_, _| 0.0),
            deviation: StoredMatrix::new(samples, 1, |_, _| 1.0),
            bound_factors: StoredMatrix::new(times, 1, |_, _| 1.0),
            changes: StoredMatrix::new(times, 1, |_, _| 0.0),
            floor: 0.0,
        }
    }

    /// The errors of all samples of a cluster, in their order.
    pub(crate) fn new<'a>(errors: impl IntoIterator<Item = &'a LeftOut>, times: usize, floor: f64) -> Self {
        let errors: Vec<&LeftOut> = errors.into_iter().collect();
        OwnedErrors {
            left_out: StoredMatrix::new(errors.len(), times, |j, i| errors[j].laboratory[i]),
            deviation: StoredMatrix::new(errors.len(), 1, |j, _| errors[j].deviation.max(1e-12)),
            floor,
            ..OwnedErrors::unknown(0, times)
        }
    }

    /// Without the samples at these places.
    pub(super) fn without(&self, out: &[usize]) -> Self {
        OwnedErrors {
            left_out: self.left_out.without(out),
            deviation: self.deviation.without(out),
            bound_factors: self.bound_factors.clone(),
            changes: self.changes.clone(),
            floor: self.floor,
        }
    }

    /// Bytes of its arrays.
    pub(super) fn byte_len(&self) -> usize {
        let arrays = [&self.left_out, &self.deviation, &self.bound_factors, &self.changes];
        arrays.map(StoredMatrix::byte_len).iter().sum()
    }

    pub(super) fn wire(&self) -> Errors<'_> {
        Errors {
            left_out: self.left_out.matrix(),
            deviation: self.deviation.matrix(),
            bound_factors: self.bound_factors.matrix(),
            changes: self.changes.matrix(),
            floor: self.floor,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::writer::tests::Fixture;
    use capsule_core::{Method, Model};

    #[test]
    fn errors_are_read_as_they_were_written() {
        let fixture = Fixture::new();
        let file = fixture.file(&[&fixture.cluster]);
        let model = Model::open(&file).unwrap();
        let cluster = model.clusters().next().unwrap();
        let [direct, paper] = [Method::Direct, Method::Paper].map(|method| cluster.left_out(method));
        for j in 0..fixture.parameters.len() {
            let expected = [1e-3 * j as f64, 2e-3 * j as f64].map(|error| error as f32);
            assert_eq!([direct.get(j, 0), direct.get(j, 1)], expected);
            assert_eq!([paper.get(j, 0), paper.get(j, 1)], [0.0; 2]);
        }
        assert_eq!(model.contents().clusters[0].direct_errors.floor, 3e-5);
    }
}
