//! A model in the making: all clusters of a plan, built from all samples.

use capsule_core::Method;
use capsule_core::Model;
use rayon::prelude::*;

use crate::OfflineError;
use crate::compare::{distances, predictions};
use crate::plan::{Built, Plan, Reduced};
use crate::samples::{Sample, Truth};

/// A model of all samples, cluster by cluster.
pub(crate) struct Assembled<'a> {
    pub(crate) plan: Plan<'a>,
    pub(crate) reduced: Vec<Reduced>,
    pub(crate) built: Vec<Built>,
}

impl<'a> Assembled<'a> {
    /// Builds the clusters of a plan; their errors are not known yet.
    pub(crate) fn new(plan: Plan<'a>) -> Result<Self, OfflineError> {
        let reduced = plan.reduce()?;
        let all = |cluster: &Reduced| plan.cluster(cluster, &(0..cluster.part.members.len()).collect::<Vec<_>>());
        let built = reduced.iter().map(all).collect::<Result<_, _>>()?;
        Ok(Assembled { plan, reduced, built })
    }

    /// Errors of a cluster by a method at its own samples, a row for each, at instants of the truth.
    pub(crate) fn own_errors(
        &self,
        cluster: usize,
        method: Method,
        truth: fn(&Sample) -> &[Truth],
    ) -> Result<Vec<Vec<f64>>, OfflineError> {
        let bytes = self.plan.write(&[&self.built[cluster].parts])?;
        let model = Model::open(&bytes).map_err(OfflineError::Invalid)?;
        let errors = self.reduced[cluster].part.members.par_iter().map(|j| {
            let sample = &self.plan.samples[*j];
            let failed = |source| OfflineError::Evaluate {
                parameters: sample.given.clone(),
                source,
            };
            let truth = truth(sample);
            let predictions = predictions(&model, &sample.parameters, method, truth).map_err(failed)?;
            let [errors, _] = distances(&model, &sample.parameters, &predictions, truth, &self.plan.distance);
            Ok(errors)
        });
        errors.collect()
    }
}
