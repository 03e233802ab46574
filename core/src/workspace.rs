//! All storage of a computation, owned by the caller.

use crate::direct::Interval;
use crate::dynamics::Dynamics;
use crate::interpolate::Weights;
use crate::{Domain, Query, Real};

/// Storage for one query at a time; const-constructible, so that it can be a `static`. It keeps what was computed, so
/// that nothing is computed twice as long as the query stays.
///
/// Capacities: `K` modes (K_u, K_v, K_uc, K_vc), `M` local modes (m_u, m_v), `N` samples that take part in a query,
/// `N <= K`.
#[derive(Clone, Debug)]
pub struct Workspace<T, const K: usize = 64, const M: usize = 16, const N: usize = 32> {
    pub(crate) prepared: Option<Prepared<T>>,
    /// Room for one matrix at a time: the kernel's, then the snapshots' factor of either field.
    pub(crate) scratch: [[T; K]; K],
    pub(crate) weights: Weights<T, N>,
    /// psi_u and psi_v (eqs. 23, 24).
    pub(crate) psi: [[T; K]; 2],
    pub(crate) displacement: Coefficients<T, K>,
    pub(crate) velocity: Coefficients<T, K>,
    pub(crate) interval: Interval<T, K>,
    pub(crate) dynamics: Dynamics<T, K, M>,
}

/// The query that the workspace answers, of the model with this digest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prepared<T> {
    pub(crate) digest: u32,
    pub(crate) query: Query<T>,
    pub(crate) domain: Domain,
}

/// Coefficients of a field in the global modes, and the instant that they belong to.
#[derive(Clone, Debug)]
pub(crate) struct Coefficients<T, const K: usize> {
    pub(crate) t: Option<T>,
    pub(crate) values: [T; K],
}

impl<T: Real, const K: usize> Coefficients<T, K> {
    const EMPTY: Self = Self {
        t: None,
        values: [T::ZERO; K],
    };
}

impl<T: Real, const K: usize, const M: usize, const N: usize> Workspace<T, K, M, N> {
    /// An empty workspace.
    pub const fn new() -> Self {
        const { assert!(N <= K, "the kernel's matrix must fit into the scratch") };
        Self {
            prepared: None,
            scratch: [[T::ZERO; K]; K],
            weights: Weights::EMPTY,
            psi: [[T::ZERO; K]; 2],
            displacement: Coefficients::EMPTY,
            velocity: Coefficients::EMPTY,
            interval: Interval::EMPTY,
            dynamics: Dynamics::EMPTY,
        }
    }

    /// Forgets what belongs to a query: the next one is computed anew, whatever the storage holds.
    pub fn forget(&mut self) {
        self.prepared = None;
        self.displacement.t = None;
        self.velocity.t = None;
        self.interval.number = None;
        self.dynamics.forget();
    }
}

impl<T: Real, const K: usize, const M: usize, const N: usize> Default for Workspace<T, K, M, N> {
    fn default() -> Self {
        Self::new()
    }
}
