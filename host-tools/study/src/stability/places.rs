//! How well the samples around a query determine its weights, over the domain.

use capsule_core::interpolate::{Coordinates, Weights};
use capsule_core::model::MatrixView;
use capsule_core::model::wire::{Contents, Samples};
use capsule_core::{Domain, Model, Parameters, Real};
use serde::Serialize;

use super::orders::Diffuse;

/// The most samples that take part, as in the core's workspace.
pub(super) const NEIGHBOURS: usize = 32;

/// One query.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place {
    /// Ca
    pub capillary_number: f64,
    /// a/l
    pub confinement: f64,
    /// sum |L_j| of direct evaluation: the largest amplification of noise in the data.
    pub direct_lebesgue: f64,
    /// sum |L_j| of the paper's method.
    pub paper_lebesgue: f64,
    /// Condition number of the paper's least squares problem in the coordinates in which it is solved.
    pub condition: f64,
    /// Greatest difference of a weight in single and in double precision, of both methods.
    pub single_precision: f64,
}

/// A grid over the domain.
pub(super) fn places(model: &Model, quick: bool) -> Vec<Place> {
    let [rows, columns] = if quick { [10, 10] } else { [46, 60] };
    let [ca, confinement] = super::ranges(model);
    let between = |[low, high]: [f64; 2], i: usize, n: usize| low + (high - low) * (i as f64 + 0.5) / n as f64;
    let grid = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    grid.map(|(row, column)| [between(ca, column, columns), between(confinement, row, rows)])
        .filter(|[ca, confinement]| model.domain([*ca, *confinement]) == Ok(Domain::Inside))
        .filter_map(|query| place(model, query))
        .collect()
}

fn place(model: &Model, query: [f64; 2]) -> Option<Place> {
    let contents = model.contents();
    let coordinates = Coordinates::new(contents);
    let cluster = contents.clusters.iter().find(|cluster| query[1] <= cluster.max)?;
    let samples = &cluster.samples;
    let [direct, diffuse] = weights::<f64>(contents, &coordinates, samples, query)?;
    let [rounded, rounded_diffuse] = weights::<f32>(contents, &coordinates, samples, query)?;
    // The same neighbours: where rounding chooses others, there is nothing to compare.
    let difference = |a: &Weights<f64, NEIGHBOURS>, b: &Weights<f32, NEIGHBOURS>| {
        let pairs = a.iter().zip(b.iter()).filter(|((j, _), (k, _))| j == k);
        pairs
            .map(|((_, a), (_, b))| (a - f64::from(b)).abs())
            .fold(0.0, f64::max)
    };
    let own = Diffuse {
        order: 2,
        neighbours: contents.paper.neighbours as usize,
        scale: contents.paper.scales[0],
        radius: contents.paper.radius,
        ridge: 1e-4,
    };
    let all: Vec<[f64; 2]> = MatrixView::new(&samples.parameters).pairs().collect();
    Some(Place {
        capillary_number: query[0],
        confinement: query[1],
        direct_lebesgue: direct.lebesgue(),
        paper_lebesgue: diffuse.lebesgue(),
        condition: own
            .solve(&all, query, |sample| coordinates.separated(sample, query))
            .map_or(f64::INFINITY, |solved| solved.condition),
        single_precision: difference(&direct, &rounded).max(difference(&diffuse, &rounded_diffuse)),
    })
}

/// The weights of direct evaluation and of the paper's method.
fn weights<T: Real>(
    contents: &Contents<'_>,
    coordinates: &Coordinates<'_>,
    samples: &Samples<'_>,
    query: [f64; 2],
) -> Option<[Weights<T, NEIGHBOURS>; 2]> {
    let query = Parameters::from(query.map(T::from_f64));
    let (mut direct, mut diffuse) = (Weights::EMPTY, Weights::EMPTY);
    let mut scratch = vec![T::ZERO; Weights::<T, NEIGHBOURS>::SCRATCH];
    direct
        .kernel(&contents.kernel, coordinates, samples, &query, None, &mut scratch)
        .ok()?;
    diffuse
        .diffuse(&contents.paper, coordinates, samples, &query, None, &mut scratch)
        .ok()?;
    Some([direct, diffuse])
}
