//! ClusterSamples of a cluster.

use super::matrix::MatrixView;
use super::wire::{Cluster, Method};

/// The samples of a cluster, with their leave-one-out errors.
#[derive(Clone, Copy, Debug)]
pub struct ClusterSamples<'a> {
    range: [f64; 2],
    parameters: MatrixView<'a>,
    /// By the direct and by the paper's method.
    left_out: [MatrixView<'a>; 2],
}

impl<'a> ClusterSamples<'a> {
    pub(super) fn new(cluster: &Cluster<'a>) -> Self {
        let errors = [&cluster.direct_errors, &cluster.paper_errors];
        Self {
            range: [cluster.min, cluster.max],
            parameters: MatrixView::new(&cluster.samples.parameters),
            left_out: errors.map(|errors| MatrixView::new(&errors.left_out)),
        }
    }

    /// Least and greatest scaled value of the parameter that divides the clusters.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// `[N_c, P]`: rows of scaled parameters; [`Parameter::value`](super::Parameter::value) gives the parameters.
    pub fn parameters(&self) -> MatrixView<'a> {
        self.parameters
    }

    /// `[N_c, N_e]`: error of each sample predicted without itself at the
    /// [`error_times`](super::Model::error_times), as a fraction of a.
    pub fn left_out(&self, method: Method) -> MatrixView<'a> {
        let [direct, paper] = self.left_out;
        match method {
            Method::Direct => direct,
            Method::Paper => paper,
        }
    }
}
