//! The units in which other people's data are reduced: the radius, the last instant, and the range of each parameter.
//!
//! Tolerances then mean the same for data in metres and in nanometres, and offsets (a temperature of 300 K that varies
//! by
//! 0.01 K) cost no precision. The model file has the data's own units again.

use capsule_database::Collection;

use crate::{OfflineError, Settings, Split, Truncation};

/// The largest parameter, and the inverse of the narrowest range, that a model file holds.
const MAX_PARAMETER: f64 = 1e36;
/// The least and greatest radius that a model file holds.
const RADIUS: [f64; 2] = [1e-12, 1e12];
/// The greatest last instant that a model file holds, and the inverse of the least.
const MAX_TIME: f64 = 1e18;

/// A parameter's range, and what is done to its values: (value - origin) / scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ParameterScale {
    pub(crate) range: [f64; 2],
    pub(crate) origin: f64,
    pub(crate) scale: f64,
}

impl ParameterScale {
    fn scaled(&self, value: f64) -> f64 {
        (value - self.origin) / self.scale
    }
}

/// The working units in the data's units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scaling {
    pub(crate) parameters: Vec<ParameterScale>,
    pub(crate) length: f64,
    pub(crate) time: f64,
    /// Axial position that counts as 0.
    pub(crate) origin: f64,
}

impl Scaling {
    /// Nothing is scaled.
    pub(crate) fn none(ranges: &[[f64; 2]]) -> Self {
        let (origin, scale) = (0.0, 1.0);
        let parameter = |range: &[f64; 2]| ParameterScale {
            range: *range,
            origin,
            scale,
        };
        Scaling {
            parameters: ranges.iter().map(parameter).collect(),
            length: 1.0,
            time: 1.0,
            origin: 0.0,
        }
    }

    /// The scaling of other people's data.
    ///
    /// # Errors
    /// [`OfflineError::OutOfScale`] for numbers that single precision cannot hold; the collection's errors.
    pub(crate) fn of(collection: &Collection) -> Result<Self, OfflineError> {
        let (mesh, length) = collection.reference()?;
        let within = |what: &str, value: f64, [least, greatest]: [f64; 2]| {
            if (least..=greatest).contains(&value) {
                return Ok(());
            }
            let what = what.to_owned();
            Err(OfflineError::OutOfScale {
                what,
                value,
                least,
                greatest,
            })
        };
        within("the radius of the capsule in `positions`", length, RADIUS)?;
        let time = collection.times.last().copied().unwrap_or_default();
        within("the last of `times`", time, [1.0 / MAX_TIME, MAX_TIME])?;
        let mut parameters = Vec::new();
        for (name, range) in collection.parameter_names.iter().zip(collection.ranges()) {
            let [low, high] = range;
            for value in range {
                let what = format!("a value of the parameter `{name}`");
                within(&what, value, [-MAX_PARAMETER, MAX_PARAMETER])?;
            }
            let what = format!("the range of the parameter `{name}`");
            within(&what, high - low, [1.0 / MAX_PARAMETER, MAX_PARAMETER])?;
            parameters.push(ParameterScale {
                range,
                // A single-precision number, so that the core takes it away exactly.
                origin: f64::from(low as f32),
                scale: high - low,
            });
        }
        let mut origin = 0.0;
        for positions in &collection.positions {
            origin += mesh.volume_and_centroid(&positions[0])?.1 / collection.positions.len() as f64;
        }
        Ok(Scaling {
            parameters,
            length,
            time,
            origin,
        })
    }

    /// A range of a parameter in the data's units.
    pub(crate) fn given_range(&self, parameter: usize, range: [f64; 2]) -> [f64; 2] {
        let ParameterScale { origin, scale, .. } = self.parameters[parameter];
        range.map(|value| origin + scale * value)
    }

    /// Parameters in the working units.
    fn parameters(&self, values: &[f64]) -> Vec<f64> {
        let pairs = self.parameters.iter().zip(values);
        pairs.map(|(parameter, value)| parameter.scaled(*value)).collect()
    }

    /// The data in the working units.
    pub(crate) fn collection(&self, given: &Collection) -> Collection {
        let (length, speed) = (1.0 / self.length, self.time / self.length);
        let field = |fields: &[Vec<Vec<[f64; 3]>>], origin: f64, unit: f64| -> Vec<Vec<Vec<[f64; 3]>>> {
            let vector = |[x, y, z]: &[f64; 3]| [unit * (x - origin), unit * y, unit * z];
            let instant = |nodes: &Vec<[f64; 3]>| nodes.iter().map(vector).collect();
            fields.iter().map(|run| run.iter().map(instant).collect()).collect()
        };
        Collection {
            parameters: given.parameters.iter().map(|row| self.parameters(row)).collect(),
            times: given.times.iter().map(|t| t / self.time).collect(),
            positions: field(&given.positions, self.origin, length),
            velocities: field(&given.velocities, 0.0, speed),
            ..given.clone()
        }
    }

    /// The settings in the working units.
    pub(crate) fn settings(&self, given: &Settings) -> Settings {
        let domain = given.domain.iter().zip(&self.parameters);
        Settings {
            domain: domain
                .map(|(range, parameter)| range.map(|value| parameter.scaled(value)))
                .collect(),
            split: given.split.map(|Split { parameter, value }| Split {
                parameter,
                value: self.parameters[parameter].scaled(value),
            }),
            truncation: match given.truncation {
                Truncation::Tolerance(tolerance) => Truncation::Tolerance(tolerance / self.length),
                ranks @ Truncation::Ranks(_) => ranks,
            },
            error_times: given.error_times.iter().map(|t| t / self.time).collect(),
            ..given.clone()
        }
    }
}
