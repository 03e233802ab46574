//! Models from parts of a database, without reducing it again: to see what a smaller design would have given.

use rayon::prelude::*;

use capsule_core::Method;
use capsule_core::Model;
use capsule_database::Database;

use crate::leave_one_out::{LeftOut, left_out};
use crate::plan::{Plan, Reduced};
use crate::writer::{OwnedCluster, OwnedErrors};
use crate::{OfflineError, Progress, Settings};

/// A database, reduced once; models of any of its samples share its modes.
pub struct Subsets<'a> {
    plan: Plan<'a>,
    reduced: Vec<Reduced>,
    parts: Vec<OwnedCluster>,
}

impl<'a> Subsets<'a> {
    /// Reduces a database.
    ///
    /// # Errors
    /// As [`crate::build`].
    pub fn new(database: &Database, settings: &'a Settings, progress: Progress) -> Result<Self, OfflineError> {
        let plan = Plan::new(database.into(), settings, progress)?;
        let reduced = plan.reduce()?;
        let parts = reduced.iter().map(|cluster| {
            let all: Vec<usize> = (0..cluster.part.members.len()).collect();
            Ok(plan.cluster(cluster, &all)?.parts)
        });
        Ok(Self {
            parts: parts.collect::<Result<_, OfflineError>>()?,
            plan,
            reduced,
        })
    }

    /// The parameters of all samples.
    pub fn samples(&self) -> Vec<&[f64]> {
        self.plan.samples.iter().map(|sample| &sample.parameters[..]).collect()
    }

    /// The bytes of the model of the samples with these indices, with their leave-one-out errors by the direct method.
    ///
    /// # Errors
    /// [`OfflineError::Evaluate`] where the samples are too few to answer.
    pub fn model(&self, chosen: &[usize]) -> Result<Vec<u8>, OfflineError> {
        let clusters = self
            .reduced
            .iter()
            .zip(&self.parts)
            .enumerate()
            .map(|(index, (cluster, parts))| {
                let members = &cluster.part.members;
                let (keep, out): (Vec<usize>, Vec<usize>) =
                    (0..members.len()).partition(|j| chosen.contains(&members[*j]));
                let errors = keep.par_iter().map(|j| {
                    let without: Vec<usize> = out.iter().copied().chain([*j]).collect();
                    let method = Method::Direct;
                    left_out(&self.plan, index, cluster, *j, &parts.without(&without), method)
                });
                let errors: Vec<LeftOut> = errors.collect::<Result<_, OfflineError>>()?;
                let mut parts = parts.without(&out);
                parts.errors[0] = OwnedErrors::new(&errors, self.plan.error_times().len(), 0.0);
                Ok(parts)
            });
        let clusters: Vec<OwnedCluster> = clusters.collect::<Result<_, OfflineError>>()?;
        let bytes = self.plan.write(&clusters.iter().collect::<Vec<_>>())?;
        Model::open(&bytes).map_err(OfflineError::Invalid)?;
        Ok(bytes)
    }
}
