//! Many answers in one call: a read-out along time, a read-out over a grid of parameters, the distance of two shapes.

use crate::evaluation::Evaluation;
use capsule_core::{EvaluateError, Instant};
use capsule_refusal::Refusal;
use wasm_bindgen::prelude::*;

/// The read-outs, in the order of [`Evaluation::readouts`].
const QUANTITIES: [&str; 9] = [
    "axial_length",
    "half_width",
    "half_diagonal",
    "rear_depth",
    "velocity",
    "volume",
    "expected_error",
    "error_bound",
    "centroid",
];

#[wasm_bindgen]
impl Evaluation {
    /// All read-outs at the instant: axial length, half width, half diagonal, rear depth, velocity, volume, expected
    /// error, error bound, axial position of the centroid. A bound that does not exist is not a number.
    ///
    /// # Errors
    /// As [`Evaluation::readings`].
    pub fn readouts(&mut self) -> Result<Vec<f32>, Refusal> {
        self.ask(|instant| {
            let found = instant.observables()?;
            Ok(vec![
                found.axial_length,
                found.half_width,
                found.half_diagonal,
                found.rear_depth,
                found.velocity,
                instant.volume()?,
                instant.expected_error()?,
                bound(instant)?,
                found.centroid,
            ])
        })
    }

    /// One read-out at many instants of the prepared query; not a number where the core refuses the instant or where
    /// there is no bound.
    ///
    /// # Errors
    /// A read-out that does not exist.
    pub fn course(&mut self, quantity: &str, times: &[f32]) -> Result<Vec<f32>, Refusal> {
        known(quantity)?;
        let mut value = |t: &f32| {
            self.go_to(*t);
            self.ask(|instant| read(instant, quantity)).unwrap_or(f32::NAN)
        };
        Ok(times.iter().map(&mut value).collect())
    }

    /// One read-out at the instant `t` for many sets of parameters, one set after another; not a number where the core
    /// refuses the parameters or the instant, or where there is no bound. The last set stays prepared.
    ///
    /// # Errors
    /// A read-out that does not exist; sets of no parameters.
    pub fn grid(
        &mut self,
        quantity: &str,
        parameters: &[f64],
        count: usize,
        t: f32,
        method: &str,
    ) -> Result<Vec<f32>, Refusal> {
        known(quantity)?;
        if count == 0 {
            let expected = self.shared.core().parameters().len();
            return Err(EvaluateError::ParameterCount { expected, found: 0 }.into());
        }
        self.go_to(t);
        let mut value = |set: &[f64]| {
            if self.prepare(set, method, false).is_err() {
                return f32::NAN;
            }
            self.ask(|instant| read(instant, quantity)).unwrap_or(f32::NAN)
        };
        Ok(parameters.chunks_exact(count).map(&mut value).collect())
    }

    /// Modified Hausdorff distance between all nodes of two shapes, each at its instant, laboratory frame, in the
    /// model's length (paper, eqs. 52 to 54): the mean distance of the nodes of one to the nearest of the other, in the
    /// direction in which it is larger.
    ///
    /// # Errors
    /// As [`Evaluation::readings`], of either.
    pub fn distance(&mut self, other: &mut Evaluation) -> Result<f32, Refusal> {
        let (a, b) = (self.laboratory_nodes()?, other.laboratory_nodes()?);
        Ok(directed(&a, &b).max(directed(&b, &a)))
    }
}

fn known(quantity: &str) -> Result<(), Refusal> {
    if QUANTITIES.contains(&quantity) {
        return Ok(());
    }
    Err(Refusal::unknown("read-out", quantity, &QUANTITIES))
}

fn read(instant: &mut Instant<'_, '_, f32>, quantity: &str) -> Result<f32, EvaluateError> {
    match quantity {
        "volume" => instant.volume(),
        "expected_error" => instant.expected_error(),
        "error_bound" => bound(instant),
        "centroid" => instant.centroid(),
        _ => {
            let found = instant.observables()?;
            Ok(match quantity {
                "axial_length" => found.axial_length,
                "half_width" => found.half_width,
                "half_diagonal" => found.half_diagonal,
                "rear_depth" => found.rear_depth,
                _ => found.velocity,
            })
        }
    }
}

/// The error bound, or not a number where none is calibrated.
fn bound(instant: &mut Instant<'_, '_, f32>) -> Result<f32, EvaluateError> {
    instant.centroid()?;
    match instant.error_bound() {
        Err(EvaluateError::NoBound) => Ok(f32::NAN),
        bound => bound,
    }
}

/// Mean distance of the points of `from` to the nearest of `to`.
fn directed(from: &[[f32; 3]], to: &[[f32; 3]]) -> f32 {
    let axis = |d: usize| -> Vec<f32> { to.iter().map(|p| p[d]).collect() };
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let nearest = |p: &[f32; 3]| -> f64 {
        let squares = x.iter().zip(&y).zip(&z).map(|((x, y), z)| {
            let (dx, dy, dz) = (x - p[0], y - p[1], z - p[2]);
            dx * dx + dy * dy + dz * dz
        });
        f64::from(squares.fold(f32::INFINITY, f32::min)).sqrt()
    };
    (from.iter().map(nearest).sum::<f64>() / from.len() as f64) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_the_mean_of_the_nearest_distances() {
        let a = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let b = [[0.0, 3.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 4.0]];
        assert_eq!(directed(&a, &b), 0.5);
        assert_eq!(directed(&b, &a), 7.0 / 3.0);
    }
}
