//! How fast the solution changes from sample to sample: what an extrapolation loses of it is a guess of its error.

use capsule_core::Model;
use capsule_core::model::MatrixView;
use rayon::prelude::*;

use crate::OfflineError;
use crate::assembled::Assembled;
use crate::distance::Distance;

/// The share of the samples around which the solution changes more slowly than what is stored.
const SHARE: f64 = 0.9;

/// The change at each instant of the errors, per unit of distance in the coordinates of the direct and of the paper's
/// method, as a fraction of the radius.
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
        let of_sample = |j: usize| -> Vec<f64> {
            let way = |k: usize| -> Vec<f64> { (0..columns).map(|d| place(k, d) - place(j, d)).collect() };
            let length = |way: &[f64]| way.iter().map(|x| x * x).sum::<f64>().sqrt();
            // The nearest one in each direction: of samples in dense rows the nearest of all lie along the row.
            let nearest = |d: usize, sign: f64| {
                let ways = (0..members.len()).map(|k| (way(k), k));
                let along = ways.filter(|(way, _)| sign * way[d] > 0.0 && way.iter().all(|x| x.abs() <= way[d].abs()));
                along
                    .map(|(way, k)| (length(&way), k))
                    .min_by(|a, b| a.0.total_cmp(&b.0))
            };
            let directions = (0..columns).flat_map(|d| [nearest(d, 1.0), nearest(d, -1.0)]).flatten();
            let own = &plan.samples[members[j]];
            let mut fastest = vec![0.0; own.truth.len()];
            for (way, k) in directions {
                let other = &plan.samples[members[k]];
                for (fastest, (a, b)) in fastest.iter_mut().zip(own.truth.iter().zip(&other.truth)) {
                    let change = Distance::Nodes.between(&a.positions, &b.positions) / plan.radius(own);
                    *fastest = f64::max(*fastest, change / way);
                }
            }
            fastest
        };
        let rates: Vec<Vec<f64>> = (0..members.len()).into_par_iter().map(of_sample).collect();
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
