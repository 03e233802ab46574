//! All storage of a computation, owned by the caller.

use crate::Real;
use crate::parts::Parts;
use crate::query::Prepared;
use crate::solver::{Solver, scratch_len};
use core::mem::offset_of;

/// Maximum number of modes: the sum of twice as many products of an 8-bit digit with a factor of 32,767 at most stays
/// below 2^31.
const MAX_MODES: usize = 256;

/// Storage for one query at a time; const-constructible, so that it can be a `static`. Results are kept while the query
/// stays the same.
///
/// Capacities: `K` modes (K, translation included, and K_c), at most 256; `M` local modes (m_u, m_v); `N` samples used
/// by a query; `S` numbers of scratch, at least [`scratch_len`] of `M` and `N`. With `M` = 0
/// [`Method::Paper`](crate::Method::Paper) is refused, and its storage and code are left out:
///
/// ```
/// use capsule_core::{Workspace, scratch_len};
///
/// type Direct = Workspace<f32, 129, 0, 16, { scratch_len(0, 16) }>;
/// assert!(size_of::<Direct>() < size_of::<Workspace<f32>>() / 2);
/// ```
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Workspace<
    T: Real,
    const K: usize = 129,
    const M: usize = 16,
    const N: usize = 32,
    const S: usize = { scratch_len(16, 32) },
> {
    pub(crate) prepared: Option<Prepared<T>>,
    /// The instant of an extrapolated query at which the shape was found plausible.
    pub(crate) plausible: Option<T>,
    pub(crate) solver: Solver<T, K, M, N, S>,
}

impl<T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Workspace<T, K, M, N, S> {
    /// An empty workspace.
    pub const fn new() -> Self {
        const {
            assert!(S >= scratch_len(M, N), "the scratch is shorter than scratch_len(M, N)");
            assert!(K <= MAX_MODES, "sums of products must not overflow")
        };
        Self {
            prepared: None,
            plausible: None,
            solver: Solver::EMPTY,
        }
    }

    /// Writes the parts of an empty workspace that are not zeros: with zeros elsewhere they are a valid workspace. For
    /// memory of another language, where the stack has no room for a whole workspace.
    pub fn put(parts: &mut impl Parts) {
        parts.put(offset_of!(Self, prepared), None::<Prepared<T>>);
        parts.put(offset_of!(Self, plausible), None::<T>);
        Solver::<T, K, M, N, S>::put(parts, offset_of!(Self, solver));
    }

    /// Discards all results: the next query is computed anew.
    pub fn invalidate(&mut self) {
        self.prepared = None;
        self.plausible = None;
        self.solver.invalidate();
    }
}

impl<T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Default for Workspace<T, K, M, N, S> {
    fn default() -> Self {
        Self::new()
    }
}
