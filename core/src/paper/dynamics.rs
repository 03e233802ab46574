//! Reduced time stepping (Algorithm 2 of the paper, eqs. 47 to 49).
//!
//! The velocities of the data are those of the full-order model, not difference quotients. From the start they decay as
//! fast as the membrane relaxes, where forward Euler is stable for very small steps only. So a step is divided into
//! equal substeps, as many as the local relaxation rate of the learned manifold needs.

use crate::linalg::{add_scaled, dot, slice_or_empty_mut};
use crate::model::wire::Paper;
use crate::motion::{Controls, Motion, Quantity};
use crate::paper::basis::{Basis, BasisStage};
use crate::paper::manifold::Manifold;
use crate::paper::snapshot::Snapshot;
use crate::paper::times::Times;
use crate::paper::{Factor, PAPER_ROW};
use crate::parts::Parts;
use crate::{Real, Scheme};
use core::mem::offset_of;

/// Maximum of substep times relaxation rate. Forward Euler damps without oscillation up to 1, and its error is small
/// far below.
const STABLE: f32 = 0.25;
/// Maximum number of substeps of a step.
const MAX_SUBSTEPS: usize = 64;

/// The next piece of work.
#[derive(Clone, Copy, Debug)]
enum Stage<T> {
    /// The basis of a field, the displacement's first.
    Basis(Quantity, BasisStage<T>),
    Steps,
}

impl<T> Stage<T> {
    const START: Self = Self::Basis(Quantity::Displacement, BasisStage::START);
}

/// Length and scheme of a step in time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<T> {
    pub(crate) length: T,
    pub(crate) scheme: Scheme,
}

/// The interpolated motion that the local model is computed from, with the settings.
pub(crate) struct Source<'m, 'a, 's, T: Real, const K: usize> {
    /// Truncated to the coefficients that the method works in, the translation's among them.
    pub(crate) motion: Motion<'a, 's, T, K>,
    pub(crate) controls: &'m mut Controls<T, K>,
    /// The stored instants.
    pub(crate) times: Times<'a>,
    pub(crate) settings: &'m Paper,
}

impl<T: Real, const K: usize> Source<'_, '_, '_, T, K> {
    /// out <- the leading coefficients at a stored instant.
    fn at_instant(&mut self, instant: usize, quantity: Quantity, out: &mut [T]) {
        let t = self.times.get(instant);
        self.motion.coefficients(self.controls, t, quantity, out);
    }
}

/// The local reduced model of a query and its state alpha after a number of steps.
#[derive(Clone, Debug)]
pub(crate) struct Dynamics<T, const M: usize> {
    stage: Stage<T>,
    displacement: Basis<T, M>,
    velocity: Basis<T, M>,
    /// Q = W_u^T W_v, row by row: the global modes of both fields are the same.
    q: [[T; M]; M],
    manifold: Manifold<T, M>,
    steps: usize,
    alpha: [T; M],
}

impl<T: Real, const M: usize> Dynamics<T, M> {
    pub(crate) const EMPTY: Self = Self {
        stage: Stage::START,
        displacement: Basis::EMPTY,
        velocity: Basis::EMPTY,
        q: [[T::ZERO; M]; M],
        manifold: Manifold::EMPTY,
        steps: 0,
        alpha: [T::ZERO; M],
    };

    /// Writes the parts that are not zeros, see [`Workspace::put`](crate::Workspace::put), at an offset.
    pub(crate) fn put(parts: &mut impl Parts, at: usize) {
        parts.put(at + offset_of!(Self, stage), Stage::<T>::START);
        Manifold::<T, M>::put(parts, at + offset_of!(Self, manifold));
    }

    /// Discards the local model: the next query computes its own.
    pub(crate) fn invalidate(&mut self) {
        self.stage = Stage::START;
    }

    /// out <- displacement coefficients at `t`, by steps of `step` and a shorter last one.
    pub(crate) fn displacement<const K: usize>(
        &mut self,
        source: &mut Source<'_, '_, '_, T, K>,
        step: Step<T>,
        t: T,
        scratch: &mut Factor<T>,
        out: &mut [T],
    ) {
        let alpha = self.state(source, step, t, scratch);
        self.displacement.lift(&alpha, out);
    }

    /// out <- velocity coefficients at `t`.
    pub(crate) fn velocity<const K: usize>(
        &mut self,
        source: &mut Source<'_, '_, '_, T, K>,
        step: Step<T>,
        t: T,
        scratch: &mut Factor<T>,
        out: &mut [T],
    ) {
        let alpha = self.state(source, step, t, scratch);
        self.move_window(source, t);
        let xi = self.manifold.velocity(t, &alpha);
        self.velocity.lift(&xi, out);
    }

    /// Steps to the last whole step before `t`; returns alpha at `t` by a shorter step from there.
    fn state<const K: usize>(
        &mut self,
        source: &mut Source<'_, '_, '_, T, K>,
        step: Step<T>,
        t: T,
        scratch: &mut Factor<T>,
    ) -> [T; M] {
        while !self.advance(source, step, t, scratch) {}
        let start = T::from_index(self.steps) * step.length;
        self.march(source, step.scheme, start, t - start)
    }

    /// Does one piece of the work up to the last whole step before `t`; returns true when nothing is left to do. Starts
    /// again at t = 0 where `t` lies before the state.
    pub(crate) fn advance<const K: usize>(
        &mut self,
        source: &mut Source<'_, '_, '_, T, K>,
        step: Step<T>,
        t: T,
        scratch: &mut Factor<T>,
    ) -> bool {
        let (instants, rank) = (source.times.count(), source.motion.rank);
        match &mut self.stage {
            Stage::Basis(quantity, stage) => {
                let quantity = *quantity;
                let (basis, wanted) = match quantity {
                    Quantity::Displacement => (&mut self.displacement, source.settings.displacement_rank),
                    Quantity::Velocity => (&mut self.velocity, source.settings.velocity_rank),
                };
                let fetch = |instant, out: &mut [T]| source.at_instant(instant, quantity, out);
                let more = basis.step(stage, rank, fetch, instants, wanted as usize, scratch);
                match (more, quantity) {
                    (Some(()), _) => {}
                    (None, Quantity::Displacement) => {
                        self.stage = Stage::Basis(Quantity::Velocity, BasisStage::START);
                    }
                    (None, Quantity::Velocity) => {
                        self.couple(source);
                        self.stage = Stage::Steps;
                    }
                }
            }
            Stage::Steps => {
                let target = (t / step.length).to_index();
                if target < self.steps {
                    self.start(source);
                }
                if target == self.steps {
                    return true;
                }
                let start = T::from_index(self.steps) * step.length;
                self.alpha = self.march(source, step.scheme, start, step.length);
                self.steps += 1;
            }
        }
        false
    }

    /// alpha a time `length` after the state at `start` (eq. 48), in as many substeps of the scheme as stability needs.
    fn march<const K: usize>(
        &mut self,
        source: &mut Source<'_, '_, '_, T, K>,
        scheme: Scheme,
        start: T,
        length: T,
    ) -> [T; M] {
        self.move_window(source, start);
        let substeps = (self.manifold.stiffness() * length / T::from_f32(STABLE))
            .to_index()
            .clamp(0, MAX_SUBSTEPS - 1)
            + 1;
        let substep = length / T::from_index(substeps);
        let mut alpha = self.alpha;
        for done in 0..substeps {
            let t = start + T::from_index(done) * substep;
            let (from, mut rate) = (alpha, [T::ZERO; M]);
            for (node, divisor) in scheme.stages() {
                let (ahead, weight) = (T::from_f32(*node) * substep, substep / T::from_f32(*divisor));
                let mut stage = from;
                add_scaled(&mut stage, ahead, &rate);
                self.move_window(source, t + ahead);
                rate = self.manifold.rate(t + ahead, substep, &stage);
                add_scaled(&mut alpha, weight, &rate);
            }
        }
        alpha
    }

    /// Computes Q of the query and sets the state at t = 0.
    fn couple<const K: usize>(&mut self, source: &mut Source<'_, '_, '_, T, K>) {
        self.q = [[T::ZERO; M]; M];
        for (q, u) in self.q.iter_mut().zip(self.displacement.rows()) {
            for (q, v) in q.iter_mut().zip(self.velocity.rows()) {
                *q = dot(u, v);
            }
        }
        self.manifold
            .invalidate(self.displacement.rows().len().max(self.velocity.rows().len()));
        self.start(source);
    }

    /// Sets the state at t = 0 to alpha^D(0), the initial shape.
    fn start<const K: usize>(&mut self, source: &mut Source<'_, '_, '_, T, K>) {
        self.move_window(source, T::ZERO);
        self.steps = 0;
        self.alpha = self.manifold.start();
    }

    /// Moves the window of the learned manifold to `t`.
    fn move_window<const K: usize>(&mut self, source: &mut Source<'_, '_, '_, T, K>, t: T) {
        let Self {
            displacement,
            velocity,
            q,
            manifold,
            ..
        } = self;
        let (times, width) = (source.times, T::from_f64(source.settings.window));
        manifold.move_to(&times, width, t, |instant, out| {
            snapshot(source, displacement, velocity, q, instant, out)
        });
    }
}

/// The pseudo-snapshot at a stored instant in local coordinates.
fn snapshot<T: Real, const K: usize, const M: usize>(
    source: &mut Source<'_, '_, '_, T, K>,
    displacement: &Basis<T, M>,
    velocity: &Basis<T, M>,
    q: &[[T; M]; M],
    instant: usize,
    out: &mut Snapshot<T, M>,
) {
    let mut global = [T::ZERO; PAPER_ROW];
    let rank = source.motion.rank;
    for (quantity, basis, out) in [
        (Quantity::Displacement, displacement, &mut out.alpha),
        (Quantity::Velocity, velocity, &mut out.xi),
    ] {
        source.at_instant(instant, quantity, slice_or_empty_mut(&mut global, 0..rank));
        basis.project(&global, rank, out);
    }
    for (rate, q) in out.rate.iter_mut().zip(q) {
        *rate = dot(q, &out.xi);
    }
}
