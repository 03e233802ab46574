//! The membrane's mechanics as named quantities at the nodes and as totals.

use anyhow::Result;
use capsule_core::Real;
use capsule_core::mechanics::Deformation;
use capsule_database::{Instant, PointData};
use capsule_fom::mechanics::Mechanics;
use capsule_fom::{Outcome, Solver};
use clap::ValueEnum;
use serde::Serialize;

/// Mechanical quantities of the membrane that can be requested.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Field {
    /// Extension ratios stretch_1 >= stretch_2 with directions, and area_dilation J_s
    Stretch,
    /// Principal tensions tension_1 >= tension_2, in G_s
    Tension,
    /// Load of the fluid on the membrane (jump of traction), in mu V / l
    Load,
    /// Elastic energy per stress-free area energy_density, in G_s
    Energy,
    /// All of them
    All,
}

/// A named quantity at the nodes.
pub struct Column {
    name: &'static str,
    values: Values,
}

enum Values {
    Scalars(Vec<f64>),
    Vectors(Vec<[f64; 3]>),
}

impl Column {
    pub fn vectors<T: Real>(name: &'static str, vectors: impl IntoIterator<Item = [T; 3]>) -> Self {
        let wide = vectors.into_iter().map(|vector| vector.map(T::to_f64));
        Self {
            name,
            values: Values::Vectors(wide.collect()),
        }
    }

    fn scalars<T: Real>(name: &'static str, scalars: impl IntoIterator<Item = T>) -> Self {
        Self {
            name,
            values: Values::Scalars(scalars.into_iter().map(T::to_f64).collect()),
        }
    }

    pub fn data(&self) -> PointData<'_> {
        match &self.values {
            Values::Scalars(values) => PointData::Scalar(self.name, values),
            Values::Vectors(values) => PointData::Vector(self.name, values),
        }
    }
}

/// A deformation, and what the membrane's law makes of it.
pub struct Strained<T> {
    pub deformation: Deformation<T>,
    /// Principal tensions, in G_s.
    pub tensions: [T; 2],
    /// Energy per stress-free area, in G_s.
    pub energy_density: T,
}

impl<T: Real> From<Deformation<T>> for Strained<T> {
    /// By the law of the core, the neo-Hookean one.
    fn from(deformation: Deformation<T>) -> Self {
        Self {
            tensions: deformation.tensions(),
            energy_density: deformation.energy_density(),
            deformation,
        }
    }
}

/// Whether `fields` ask for a field.
fn asked(fields: &[Field], field: Field) -> bool {
    fields.contains(&field) || fields.contains(&Field::All)
}

/// The quantities that `fields` ask for; `load` is called if it is asked for.
pub fn columns<T: Real>(
    fields: &[Field],
    nodes: &[Strained<T>],
    load: impl FnOnce() -> Result<Vec<[T; 3]>>,
) -> Result<Vec<Column>> {
    let asked = |field| asked(fields, field);
    let all = || nodes.iter().map(|node| &node.deformation);
    let mut columns = Vec::new();
    if asked(Field::Stretch) {
        let [first, second] = [0, 1].map(|k| move |at: &Deformation<T>| at.stretches()[k]);
        columns.push(Column::scalars("stretch_1", all().map(first)));
        columns.push(Column::scalars("stretch_2", all().map(second)));
        let [first, second] = [0, 1].map(|k| move |at: &Deformation<T>| at.directions()[k]);
        columns.push(Column::vectors("direction_1", all().map(first)));
        columns.push(Column::vectors("direction_2", all().map(second)));
        columns.push(Column::scalars("area_dilation", all().map(Deformation::area_dilation)));
    }
    if asked(Field::Tension) {
        let [first, second] = [0, 1].map(|k| nodes.iter().map(move |node| node.tensions[k]));
        columns.push(Column::scalars("tension_1", first));
        columns.push(Column::scalars("tension_2", second));
    }
    if asked(Field::Load) {
        columns.push(Column::vectors("load", load()?));
    }
    if asked(Field::Energy) {
        let energies = nodes.iter().map(|node| node.energy_density);
        columns.push(Column::scalars("energy_density", energies));
    }
    Ok(columns)
}

/// Totals of an instant: area in l^2, energy in G_s l^2, pressure drop in mu V / l, tensions in G_s.
#[derive(Clone, Copy, Serialize)]
pub struct Totals<T> {
    pub area: T,
    pub energy: T,
    pub pressure_drop: T,
    pub max_stretch: T,
    pub max_tension: T,
    /// Negative where the membrane is compressed.
    pub min_tension: T,
}

/// The greatest stretch and tension and the least tension.
pub fn extremes<T: Real>(nodes: &[Strained<T>]) -> [T; 3] {
    let zero = T::ZERO;
    nodes
        .iter()
        .map(|node| {
            let ([stretch, _], [greatest, least]) = (node.deformation.stretches(), node.tensions);
            [stretch, greatest, least]
        })
        .reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2])])
        .unwrap_or([zero; 3])
}

/// All nodes at an instant, in the laboratory frame, with quantities.
pub struct Surface {
    pub time: f64,
    pub positions: Vec<[f64; 3]>,
    pub columns: Vec<Column>,
}

impl Surface {
    /// The instant for the writers.
    pub fn instant(&self) -> Instant<'_> {
        Instant {
            time: self.time,
            positions: &self.positions,
            data: self.columns.iter().map(Column::data).collect(),
        }
    }
}

/// Totals at every snapshot of a full-order run, in the units of [`Totals`] and l^3.
#[derive(Default, Serialize)]
pub struct History {
    area: Vec<f64>,
    volume: Vec<f64>,
    energy: Vec<f64>,
    max_stretch: Vec<f64>,
    max_tension: Vec<f64>,
    min_tension: Vec<f64>,
}

/// Checks before a run that `fields` can be given of it.
pub fn check(fields: &[Field], solver: &Solver) -> Result<()> {
    if asked(fields, Field::Load) {
        Mechanics::new(solver.discretisation())?.check_load()?;
    }
    Ok(())
}

/// The snapshots of a full-order run with velocities and the quantities that `fields` ask for, and their totals.
pub fn of_run(fields: &[Field], solver: &Solver, outcome: &Outcome) -> Result<(Vec<Surface>, Option<History>)> {
    let surface = |(i, &time): (usize, &f64)| Surface {
        time,
        positions: outcome.positions[i].clone(),
        columns: vec![Column::vectors("velocity", outcome.velocities[i].iter().copied())],
    };
    let mut surfaces: Vec<_> = outcome.times.iter().enumerate().map(surface).collect();
    if fields.is_empty() {
        return Ok((surfaces, None));
    }
    let mechanics = Mechanics::new(solver.discretisation())?;
    let (radius, capillary_number) = (
        outcome.configuration.confinement,
        outcome.configuration.capillary_number,
    );
    let mut history = History::default();
    for (surface, centroid) in surfaces.iter_mut().zip(&outcome.centroid) {
        let centred: Vec<_> = surface
            .positions
            .iter()
            .map(|[x, y, z]| [x - centroid, *y, *z])
            .collect();
        let deformations = mechanics.deformations(&centred, radius)?.into_iter();
        let nodes: Vec<_> = deformations
            .map(|deformation| Strained {
                tensions: mechanics.tensions(&deformation),
                energy_density: mechanics.energy_density(&deformation),
                deformation,
            })
            .collect();
        let totals = mechanics.totals(&centred, radius);
        let [max_stretch, max_tension, min_tension] = extremes(&nodes);
        history.area.push(totals.area);
        history.volume.push(totals.volume);
        history.energy.push(totals.energy);
        history.max_stretch.push(max_stretch);
        history.max_tension.push(max_tension);
        history.min_tension.push(min_tension);
        let load = || Ok(mechanics.load(&centred, radius, capillary_number)?);
        surface.columns.extend(columns(fields, &nodes, load)?);
    }
    Ok((surfaces, Some(history)))
}
