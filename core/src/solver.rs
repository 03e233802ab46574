//! Weights of a query, and the coefficients of both fields at an instant, by either method.

use crate::error::EvaluateError;
use crate::interpolate::{self, Coordinates, Weights};
use crate::linalg::{slice_or_empty, slice_or_empty_mut};
use crate::model::wire::{Cluster, Method};
use crate::model::{MatrixView, Model, QuantizedVectors};
use crate::motion::{Contracted, Controls, Motion, Quantity, significant_rank};
use crate::paper::dynamics::{Dynamics, Source, Step};
use crate::paper::times::Times;
use crate::paper::{self, Factor, PAPER_MODES};
use crate::parts::Parts;
use crate::{Query, Real};
use core::cell::Cell;
use core::mem::offset_of;

/// Root-mean-square displacement, as a share of the radius, below which the last modes of a shape are left out.
const NEGLIGIBLE: f32 = 1e-6;

/// Numbers of scratch that a [`Workspace`](crate::Workspace) of `local_modes` (M) and `neighbours` (N) needs.
pub const fn scratch_len(local_modes: usize, neighbours: usize) -> usize {
    let (interpolation, factor) = (interpolate::scratch_len(neighbours), paper::scratch_len(local_modes));
    if interpolation > factor { interpolation } else { factor }
}

/// An instant of a prepared query.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target<'a, T> {
    pub(crate) model: &'a Model<'a>,
    /// The cluster of the query.
    pub(crate) cluster: &'a Cluster<'a>,
    pub(crate) query: Query<T>,
    pub(crate) t: T,
}

impl<T: Real> Target<'_, T> {
    /// Time step of [`Method::Paper`].
    fn step(&self) -> Step<T> {
        let default = || T::from_f32(self.model.end_time()) / T::from_f32(1000.0);
        Step {
            length: self.query.step.unwrap_or_else(default),
            scheme: self.query.scheme,
        }
    }

    /// sqrt(N_x), the scale of the translation's coefficient.
    pub(crate) fn root_of_nodes(&self) -> T {
        T::from_index(self.model.mesh().nodes()).sqrt()
    }
}

/// Coefficients of a field at an instant, those of the shape quantised for products with the modes.
#[derive(Clone, Debug)]
pub(crate) struct Coefficients<T: Real, const K: usize> {
    /// The instant; none where there are no coefficients.
    pub(crate) t: Option<T>,
    pub(crate) translation: T,
    /// Whether all nodes computed from the coefficients are finite.
    bounded: bool,
    pub(crate) shape: QuantizedVectors<T, K>,
}

impl<T: Real, const K: usize> Coefficients<T, K> {
    const EMPTY: Self = Self {
        t: None,
        translation: T::ZERO,
        bounded: false,
        shape: QuantizedVectors::ZERO,
    };

    /// Checks the leading coefficients before any node is written to a caller's buffer: no entry of a mode exceeds 1e6,
    /// so all nodes are finite where the sum of the coefficients is bounded.
    fn check_bound(&mut self, modes: usize) {
        const MAX: f32 = 1e30;
        let values = self.shape.values.as_flattened().iter().take(modes);
        let sum = values.fold(self.translation.abs(), |sum, value| sum + value.abs());
        // False for a NaN.
        self.bounded = sum <= T::from_f32(MAX);
    }

    /// The coefficients, if all nodes computed from them are finite.
    ///
    /// # Errors
    /// [`EvaluateError::NotFinite`].
    pub(crate) fn finite(&self) -> Result<&Self, EvaluateError> {
        if self.bounded {
            Ok(self)
        } else {
            Err(EvaluateError::NotFinite)
        }
    }
}

/// Storage of the computation. Small fields lie before large ones: a Cortex-M reaches the first 4 KiB in one
/// instruction.
#[derive(Clone, Debug)]
#[repr(C)]
pub(crate) struct Solver<T: Real, const K: usize, const M: usize, const N: usize, const S: usize> {
    pub(crate) weights: Weights<T, N>,
    pub(crate) displacement: Coefficients<T, K>,
    pub(crate) velocity: Coefficients<T, K>,
    pub(crate) contracted: Contracted<T, K>,
    dynamics: Dynamics<T, M>,
    controls: Controls<T, K>,
    /// Used by one computation at a time: the interpolation, then the factor of either field's snapshots.
    pub(crate) scratch: [T; S],
}

impl<T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Solver<T, K, M, N, S> {
    pub(crate) const EMPTY: Self = Self {
        weights: Weights::EMPTY,
        displacement: Coefficients::EMPTY,
        velocity: Coefficients::EMPTY,
        contracted: Contracted::EMPTY,
        dynamics: Dynamics::EMPTY,
        controls: Controls::EMPTY,
        scratch: [T::ZERO; S],
    };

    /// Writes the parts that are not zeros, see [`Workspace::put`](crate::Workspace::put), at an offset.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, displacement.t), None::<T>);
        parts.put(at + offset_of!(Self, displacement.bounded), false);
        parts.put(at + offset_of!(Self, velocity.t), None::<T>);
        parts.put(at + offset_of!(Self, velocity.bounded), false);
        Contracted::<T, K>::put(parts, at + offset_of!(Self, contracted));
        Controls::<T, K>::put(parts, at + offset_of!(Self, controls));
        Dynamics::<T, M>::put(parts, at + offset_of!(Self, dynamics));
    }

    /// Discards all results of the query.
    pub(crate) fn invalidate(&mut self) {
        self.displacement.t = None;
        self.velocity.t = None;
        self.controls.invalidate();
        self.dynamics.invalidate();
    }

    /// Computes the weights of the samples at a query.
    ///
    /// # Errors
    /// Those of [`Weights::kernel`] and [`Weights::diffuse`].
    pub(crate) fn set_query(
        &mut self,
        model: &Model<'_>,
        cluster: &Cluster<'_>,
        query: &Query<T>,
    ) -> Result<(), EvaluateError> {
        let contents = model.contents();
        let (parameters, samples) = (&model.scaled(&query.parameters), &cluster.samples);
        let coordinates = Coordinates::new(contents);
        let (weights, scratch) = (&mut self.weights, &mut self.scratch);
        match query.method {
            Method::Direct => weights.kernel(&contents.kernel, &coordinates, samples, parameters, None, scratch),
            Method::Paper => weights.diffuse(&contents.paper, &coordinates, samples, parameters, None, scratch),
        }
    }

    /// Computes the derivatives of the weights by each parameter, into the scratch: a row of N for each.
    ///
    /// # Errors
    /// Those of [`Weights::kernel`].
    pub(crate) fn set_derivatives(
        &mut self,
        model: &Model<'_>,
        cluster: &Cluster<'_>,
        query: &Query<T>,
    ) -> Result<(), EvaluateError> {
        let contents = model.contents();
        let (parameters, samples) = (&model.scaled(&query.parameters), &cluster.samples);
        let coordinates = Coordinates::new(contents);
        let (weights, scratch) = (&mut self.weights, &mut self.scratch);
        let derivatives = weights.kernel_derivatives(&contents.kernel, &coordinates, samples, parameters, scratch)?;
        let ranges = &contents.metadata.parameters;
        for ((out, row), range) in scratch.chunks_mut(N).zip(&derivatives).zip(ranges) {
            for (out, value) in out.iter_mut().zip(row) {
                *out = *value / T::from_f64(range.scale);
            }
        }
        Ok(())
    }

    /// Puts the derivatives by a parameter in the place of the weights.
    pub(crate) fn select_derivative(&mut self, parameter: usize) {
        self.weights
            .replace(slice_or_empty(&self.scratch, N * parameter..N * (parameter + 1)));
    }

    /// Contracts the modes of the translation with the weights of the query.
    pub(crate) fn contract(&mut self, cluster: &Cluster<'_>) {
        self.contracted.set_weights(&cluster.field, &self.weights);
    }

    /// Does at most `pieces` pieces of the paper's method; returns true when nothing is left to do.
    pub(crate) fn advance(&mut self, target: &Target<'_, T>, pieces: usize) -> bool {
        if target.query.method == Method::Direct {
            return true;
        }
        let motion = Motion::new(&target.cluster.field, &self.weights, &mut self.contracted);
        let solver = paper_solver::<T, K, M>(target.model, motion, &mut self.controls, &mut self.scratch);
        let Some((mut source, factor)) = solver else {
            return true;
        };
        (0..pieces).any(|_| self.dynamics.advance(&mut source, target.step(), target.t, factor))
    }

    /// The translation's coefficient of a field.
    pub(crate) fn translation(&mut self, target: &Target<'_, T>, quantity: Quantity) -> T {
        match (target.query.method, quantity) {
            (Method::Direct, _) => {
                let motion = Motion::new(&target.cluster.field, &self.weights, &mut self.contracted);
                motion.translation(target.t, quantity)
            }
            (Method::Paper, Quantity::Displacement) => self.displacement(target).translation,
            (Method::Paper, Quantity::Velocity) => self.velocity(target).translation,
        }
    }

    /// The coefficients of the displacement.
    pub(crate) fn displacement(&mut self, target: &Target<'_, T>) -> &Coefficients<T, K> {
        if self.displacement.t != Some(target.t) {
            self.compute(target, Quantity::Displacement);
        }
        &self.displacement
    }

    /// The coefficients of the velocity.
    pub(crate) fn velocity(&mut self, target: &Target<'_, T>) -> &Coefficients<T, K> {
        if self.velocity.t != Some(target.t) {
            self.compute(target, Quantity::Velocity);
        }
        &self.velocity
    }

    /// Computes the coefficients of a field.
    fn compute(&mut self, target: &Target<'_, T>, quantity: Quantity) {
        let (t, step) = (target.t, target.step());
        let modes = MatrixView::new(&target.cluster.field.modes);
        let (computed, negligible) = match quantity {
            Quantity::Displacement => {
                let negligible = T::from_f32(NEGLIGIBLE) * target.model.radius(target.query.parameters);
                (&mut self.displacement, negligible * target.root_of_nodes())
            }
            Quantity::Velocity => (&mut self.velocity, T::ZERO),
        };
        // Computed in place, the translation first: the stack has no room for a second array.
        computed.t = None;
        let out = slice_or_empty_mut(computed.shape.values.as_flattened_mut(), 0..modes.columns() + 1);
        let mut motion = Motion::new(&target.cluster.field, &self.weights, &mut self.contracted);
        match target.query.method {
            Method::Direct => motion.coefficients(&mut self.controls, t, quantity, out),
            Method::Paper => {
                let solver = paper_solver::<T, K, M>(target.model, motion, &mut self.controls, &mut self.scratch);
                let Some((mut source, factor)) = solver else {
                    return;
                };
                match quantity {
                    Quantity::Displacement => self.dynamics.displacement(&mut source, step, t, factor, out),
                    Quantity::Velocity => self.dynamics.velocity(&mut source, step, t, factor, out),
                }
            }
        }
        computed.translation = out.first().copied().unwrap_or(T::ZERO);
        // Moves the others up by one: through cells, because `copy_within` can panic.
        let entries = Cell::from_mut(&mut *out).as_slice_of_cells();
        for (entry, next) in entries.iter().zip(entries.iter().skip(1)) {
            entry.set(next.get());
        }
        let count = significant_rank(slice_or_empty(out, 0..modes.columns()), negligible);
        computed.t = Some(t);
        computed.check_bound(modes.columns());
        computed.shape.quantize(&modes, count);
    }
}

/// Source and scratch of the paper's method; none for M = 0, where [`Method::Paper`] is refused: so the compiler drops
/// the method's code.
fn paper_solver<'a, 's, 'f, T: Real, const K: usize, const M: usize>(
    model: &'s Model<'a>,
    motion: Motion<'a, 's, T, K>,
    controls: &'s mut Controls<T, K>,
    scratch: &'f mut [T],
) -> Option<(Source<'s, 'a, 's, T, K>, &'f mut Factor<T>)> {
    if M == 0 {
        return None;
    }
    let factor = scratch.as_chunks_mut().0.first_chunk_mut()?;
    let source = Source {
        motion: motion.truncate(PAPER_MODES),
        controls,
        times: Times(model.times()),
        settings: &model.contents().paper,
    };
    Some((source, factor))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_that_could_overflow_a_node_are_no_answer() {
        let is_finite = |translation: f32, shape: [f32; 3], modes: usize| {
            let mut coefficients = Coefficients::<f32, 3>::EMPTY;
            assert_eq!(
                coefficients.finite().err(),
                Some(EvaluateError::NotFinite),
                "nothing yet"
            );
            coefficients.translation = translation;
            coefficients.shape.values = shape.map(|value| [value]);
            coefficients.check_bound(modes);
            coefficients.finite().is_ok()
        };
        assert!(is_finite(1.0, [-2.0, 3.0, 0.0], 3));
        assert!(!is_finite(2e30, [0.0; 3], 3));
        assert!(!is_finite(0.0, [0.0, -2e30, 0.0], 3));
        assert!(!is_finite(6e29, [6e29, 0.0, 0.0], 3));
        assert!(!is_finite(0.0, [0.0, f32::NAN, 0.0], 3));
        assert!(is_finite(0.0, [0.0, 0.0, f32::NAN], 2), "a mode that is not in use");
    }
}
