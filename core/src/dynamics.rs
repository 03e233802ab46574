//! Reduced time stepping (Algorithm 2 of the paper, eqs. 47 to 49).
//!
//! The velocities of the data are the true ones, not difference quotients, and those fall from the start as fast as the
//! membrane relaxes. Forward Euler is stable there with very small steps only, so a step is divided into as many equal
//! parts as the learned manifold needs where it is.

use crate::basis::{Basis, Learning};
use crate::linalg::{dot, part, part_mut};
use crate::manifold::Manifold;
use crate::model::wire::Paper;
use crate::motion::Motion;
use crate::{Real, Scheme};

/// Step times relaxation rate that a part of a step may have: Euler damps without oscillation up to 1.
const STABLE: f64 = 1.0;
/// The most parts of a step.
const MOST_PARTS: usize = 64;

/// What is to be done next.
#[derive(Clone, Copy, Debug)]
enum Stage<T> {
    Displacement(Learning<T>),
    Velocity(Learning<T>),
    Steps,
}

/// How time is stepped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<T> {
    pub(crate) length: T,
    pub(crate) scheme: Scheme,
}

/// The local reduced model of a query and its state after a whole number of steps.
#[derive(Clone, Debug)]
pub(crate) struct Dynamics<T, const K: usize, const M: usize> {
    stage: Stage<T>,
    displacement: Basis<T, K, M>,
    velocity: Basis<T, K, M>,
    /// Q = W_u^T (Phi_u^T Phi_v) W_v, row by row.
    q: [[T; M]; M],
    manifold: Manifold<T, M>,
    steps: usize,
    alpha: [T; M],
}

impl<T: Real, const K: usize, const M: usize> Dynamics<T, K, M> {
    pub(crate) const EMPTY: Self = Self {
        stage: Stage::Displacement(Learning::START),
        displacement: Basis::EMPTY,
        velocity: Basis::EMPTY,
        q: [[T::ZERO; M]; M],
        manifold: Manifold::EMPTY,
        steps: 0,
        alpha: [T::ZERO; M],
    };

    /// Forgets the query.
    pub(crate) fn forget(&mut self) {
        self.stage = Stage::Displacement(Learning::START);
    }

    /// out <- displacement coefficients at `t`, by steps of `step` and a shorter last one.
    pub(crate) fn displacement(
        &mut self,
        motion: &Motion<'_, '_, T>,
        settings: &Paper,
        step: Step<T>,
        t: T,
        scratch: &mut [[T; K]; K],
        out: &mut [T],
    ) {
        let alpha = self.state(motion, settings, step, t, scratch);
        self.displacement.lift(&alpha, out);
    }

    /// out <- velocity coefficients at `t`.
    pub(crate) fn velocity(
        &mut self,
        motion: &Motion<'_, '_, T>,
        settings: &Paper,
        step: Step<T>,
        t: T,
        scratch: &mut [[T; K]; K],
        out: &mut [T],
    ) {
        let alpha = self.state(motion, settings, step, t, scratch);
        let xi = self.equilibrium(motion, settings, t, T::ZERO, &alpha);
        self.velocity.lift(&xi, out);
    }

    /// Steps to the last whole step before `t` and returns alpha at `t`.
    fn state(
        &mut self,
        motion: &Motion<'_, '_, T>,
        settings: &Paper,
        step: Step<T>,
        t: T,
        scratch: &mut [[T; K]; K],
    ) -> [T; M] {
        while !self.advance(motion, settings, step, t, scratch) {}
        let start = T::from_index(self.steps) * step.length;
        self.march(motion, settings, step.scheme, start, t - start)
    }

    /// Does one piece of the work that leads to the last whole step before `t`; returns whether nothing is left to do.
    /// Starts again where `t` lies before the state.
    pub(crate) fn advance(
        &mut self,
        motion: &Motion<'_, '_, T>,
        settings: &Paper,
        step: Step<T>,
        t: T,
        scratch: &mut [[T; K]; K],
    ) -> bool {
        let instants = motion.times.count();
        match self.stage {
            Stage::Displacement(learning) => {
                let (field, rank) = (&motion.displacement, settings.displacement_rank.into());
                self.stage = match self.displacement.learn(learning, field, instants, rank, scratch) {
                    Some(learning) => Stage::Displacement(learning),
                    None => Stage::Velocity(Learning::START),
                };
            }
            Stage::Velocity(learning) => {
                let (field, rank) = (&motion.velocity, settings.velocity_rank.into());
                self.stage = match self.velocity.learn(learning, field, instants, rank, scratch) {
                    Some(learning) => Stage::Velocity(learning),
                    None => {
                        self.couple(motion);
                        Stage::Steps
                    }
                };
            }
            Stage::Steps => {
                let target = (t / step.length).to_index();
                if target < self.steps {
                    self.start(motion);
                }
                if target == self.steps {
                    return true;
                }
                let start = T::from_index(self.steps) * step.length;
                self.alpha = self.march(motion, settings, step.scheme, start, step.length);
                self.steps += 1;
            }
        }
        false
    }

    /// alpha after a time from the state at `start`, in as many parts as stability needs (eq. 48), each by the
    /// scheme.
    fn march(&mut self, motion: &Motion<'_, '_, T>, settings: &Paper, scheme: Scheme, start: T, length: T) -> [T; M] {
        let (u, v, window) = (&self.displacement, &self.velocity, T::from_f64(settings.window));
        let stiffness = self
            .manifold
            .stiffness(&motion.times, window, start, |instant, alpha, xi| {
                snapshot(motion, u, v, instant, alpha, xi);
            });
        let parts = (stiffness * length / T::from_f64(STABLE))
            .to_index()
            .clamp(0, MOST_PARTS - 1)
            + 1;
        let part = length / T::from_index(parts);
        let mut alpha = self.alpha;
        for done in 0..parts {
            let t = start + T::from_index(done) * part;
            let (from, mut rate) = (alpha, [T::ZERO; M]);
            for (place, weight) in scheme.stages() {
                let [ahead, weight] = [*place, *weight].map(|share| T::from_f64(share) * part);
                let stage = core::array::from_fn(|k| from[k] + ahead * rate[k]);
                let xi = self.equilibrium(motion, settings, t + ahead, part, &stage);
                rate = core::array::from_fn(|k| dot(&self.q[k], &xi));
                alpha = core::array::from_fn(|k| alpha[k] + weight * rate[k]);
            }
        }
        alpha
    }

    /// Q of the query; the state at t = 0.
    fn couple(&mut self, motion: &Motion<'_, '_, T>) {
        let (u, v) = (&motion.displacement, &motion.velocity);
        self.q = [[T::ZERO; M]; M];
        let mut rate = [T::ZERO; K];
        for (j, mode) in self.velocity.rows().iter().enumerate().take(M) {
            motion.rate(part(mode, 0..v.rank()), part_mut(&mut rate, 0..u.rank()));
            for (q, row) in self.q.iter_mut().zip(self.displacement.rows()) {
                q[j] = dot(row, &rate);
            }
        }
        self.manifold.forget();
        self.start(motion);
    }

    /// The state at t = 0: alpha^D(0), which holds the initial shape.
    fn start(&mut self, motion: &Motion<'_, '_, T>) {
        let (u, v) = (&self.displacement, &self.velocity);
        self.steps = 0;
        self.alpha = [T::ZERO; M];
        snapshot(motion, u, v, 0, &mut self.alpha, &mut [T::ZERO; M]);
    }

    /// xi = M(alpha, t) (eq. 49), for an Euler step of a length from there.
    ///
    /// The manifold is a line through a few snapshots that follow each other. Where these drift apart from their mean it
    /// amplifies whatever deviates from them, without bound. So the response to the deviation of the state from
    /// the learned trajectory counts only as far as the step does not enlarge the deviation: then what a step errs is
    /// added to the errors before it, and never multiplied.
    fn equilibrium(&mut self, motion: &Motion<'_, '_, T>, settings: &Paper, t: T, step: T, alpha: &[T; M]) -> [T; M] {
        let (u, v) = (&self.displacement, &self.velocity);
        let (times, window) = (&motion.times, T::from_f64(settings.window));
        let fetch = |instant, alpha: &mut _, xi: &mut _| snapshot(motion, u, v, instant, alpha, xi);
        let learned = self.manifold.trajectory(times, t, &self.q, fetch);
        let along = self.manifold.velocity(times, window, t, &learned, fetch);
        let here = self.manifold.velocity(times, window, t, alpha, fetch);
        let deviation: [T; M] = core::array::from_fn(|k| alpha[k] - learned[k]);
        let response: [T; M] = core::array::from_fn(|k| here[k] - along[k]);
        let rate: [T; M] = core::array::from_fn(|k| dot(&self.q[k], &response));
        // |deviation + step share rate| <= |deviation|
        let (closing, limit) = (-dot(&deviation, &rate), step * dot(&rate, &rate));
        let share = if closing <= T::ZERO {
            T::ZERO
        } else if closing + closing < limit {
            (closing + closing) / limit
        } else {
            T::ONE
        };
        core::array::from_fn(|k| along[k] + share * response[k])
    }
}

/// alpha^D and xi^D at a stored instant: the pseudo-snapshots in local coordinates.
fn snapshot<T: Real, const K: usize, const M: usize>(
    motion: &Motion<'_, '_, T>,
    displacement: &Basis<T, K, M>,
    velocity: &Basis<T, K, M>,
    instant: usize,
    alpha: &mut [T; M],
    xi: &mut [T; M],
) {
    let mut global = [T::ZERO; K];
    for (field, basis, out) in [
        (&motion.displacement, displacement, alpha),
        (&motion.velocity, velocity, xi),
    ] {
        let global = part_mut(&mut global, 0..field.rank());
        field.at_instant(instant, global);
        basis.project(global, out);
    }
}
