//! How fast the solution changes from sample to sample: what an extrapolation loses of it is a guess of its error.

use capsule_core::Model;
use capsule_core::model::MatrixView;
use rayon::prelude::*;

use crate::OfflineError;
use crate::assembled::Assembled;
use crate::distance::Distance;

/// As many of a sample's nearest others are compared with it.
const NEAREST: usize = 4;
/// The share of the changes that are slower than what is stored.
const SHARE: f64 = 0.9;

/// The change at each instant of the errors, per unit of distance in the coordinates of the direct and of the paper's method, as a
/// fraction of the radius.
pub(crate) fn changes(assembled: &Assembled, cluster: usize) -> Result<[Vec<f64>; 2], OfflineError> {
    let plan = &assembled.plan;
    let members = &assembled.reduced[cluster].part.members;
    let bytes = plan.write(&[&assembled.built[cluster].parts])?;
    let model = Model::open(&bytes).map_err(OfflineError::Invalid)?;
    let stored = &model.contents().clusters[0].samples;
    let scales = plan.settings.paper.scales;
    let direct = MatrixView::new(&stored.places);
    let paper = MatrixView::new(&stored.parameters);
    let of_direct = |j: usize, d: usize| f64::from(direct.get(j, d));
    let of_paper = |j: usize, d: usize| scales[d] * f64::from(paper.get(j, d));
    let columns = direct.columns();
    let rates = |place: &(dyn Fn(usize, usize) -> f64 + Sync)| -> Vec<f64> {
        let of_sample = |j: usize| -> Vec<Vec<f64>> {
            let apart = |k: usize| {
                (0..columns)
                    .map(|d| (place(j, d) - place(k, d)).powi(2))
                    .sum::<f64>()
                    .sqrt()
            };
            let mut others: Vec<(f64, usize)> = (0..members.len()).filter(|k| *k != j).map(|k| (apart(k), k)).collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0));
            let radius = plan.radius(&plan.samples[members[j]]);
            let rate = |(way, k): &(f64, usize)| {
                let pairs = plan.samples[members[j]]
                    .truth
                    .iter()
                    .zip(&plan.samples[members[*k]].truth);
                pairs
                    .map(|(a, b)| Distance::Nodes.between(&a.positions, &b.positions) / radius / way)
                    .collect()
            };
            others
                .iter()
                .take(NEAREST)
                .filter(|(way, _)| *way > 0.0)
                .map(rate)
                .collect()
        };
        let rates: Vec<Vec<f64>> = (0..members.len()).into_par_iter().flat_map(of_sample).collect();
        let at = |instant: usize| {
            let mut values: Vec<f64> = rates.iter().map(|rate| rate[instant]).collect();
            values.sort_by(f64::total_cmp);
            values
                .get((SHARE * values.len() as f64) as usize)
                .copied()
                .unwrap_or(0.0)
        };
        (0..plan.error_times().len()).map(at).collect()
    };
    Ok([rates(&of_direct), rates(&of_paper)])
}
