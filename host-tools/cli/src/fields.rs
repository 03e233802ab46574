//! The membrane's mechanics as named quantities at the nodes and as totals.

use capsule_core::Real;
use capsule_core::mechanics::Deformation;
use capsule_database::vtu::PointData;
use clap::ValueEnum;
use serde::Serialize;

/// What can be asked of the membrane.
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

/// The quantities that `fields` ask for; `load` is called if it is asked for.
pub fn columns<T: Real>(
    fields: &[Field],
    deformations: &[Deformation<T>],
    load: impl FnOnce() -> Vec<[T; 3]>,
) -> Vec<Column> {
    let asked = |field| fields.contains(&field) || fields.contains(&Field::All);
    let all = || deformations.iter();
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
        let [first, second] = [0, 1].map(|k| move |at: &Deformation<T>| at.tensions()[k]);
        columns.push(Column::scalars("tension_1", all().map(first)));
        columns.push(Column::scalars("tension_2", all().map(second)));
    }
    if asked(Field::Load) {
        columns.push(Column::vectors("load", load()));
    }
    if asked(Field::Energy) {
        columns.push(Column::scalars(
            "energy_density",
            all().map(Deformation::energy_density),
        ));
    }
    columns
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
pub fn extremes<T: Real>(deformations: &[Deformation<T>]) -> [T; 3] {
    let zero = T::ZERO;
    deformations
        .iter()
        .map(|at| {
            let ([stretch, _], [greatest, least]) = (at.stretches(), at.tensions());
            [stretch, greatest, least]
        })
        .reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2])])
        .unwrap_or([zero; 3])
}
