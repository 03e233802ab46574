//! All storage of a computation, owned by the caller.

use crate::Real;

/// Storage for one query at a time; const-constructible, so that it can be a `static`. It keeps what was computed, so
/// that a query already prepared is not prepared again.
///
/// Capacities: `K` modes (K_u, K_v, K_uc, K_vc), `M` local modes (m_u, m_v), `N` samples that take part in a query.
#[derive(Clone, Debug)]
pub struct Workspace<T, const K: usize = 64, const M: usize = 16, const N: usize = 32> {
    pub(crate) scratch: [[T; K]; K],
    pub(crate) local: [[T; M]; M],
    pub(crate) neighbours: [T; N],
}

impl<T: Real, const K: usize, const M: usize, const N: usize> Workspace<T, K, M, N> {
    /// An empty workspace.
    pub const fn new() -> Self {
        Self {
            scratch: [[T::ZERO; K]; K],
            local: [[T::ZERO; M]; M],
            neighbours: [T::ZERO; N],
        }
    }
}

impl<T: Real, const K: usize, const M: usize, const N: usize> Default for Workspace<T, K, M, N> {
    fn default() -> Self {
        Self::new()
    }
}
