//! All storage of a computation, owned by the caller.

use crate::error::EvaluateError;
use crate::interpolate::Weights;
use crate::linalg::{LANES, MAX_COLUMNS};
use crate::model::QuantizedVectors;
use crate::motion::{Contracted, Controls};
use crate::paper::dynamics::Dynamics;
use crate::{Domain, Query, Real};
use core::mem::offset_of;

/// Storage for one query at a time; const-constructible, so that it can be a `static`. It keeps what was computed, so
/// that nothing is computed twice as long as the query stays.
///
/// Capacities: `K` modes (K, translation included, and K_c), at most 256, `M` local modes (m_u, m_v), `N` samples that
/// take part in a query, and `S` numbers of scratch: at least [`scratch_len`] of `M` and `N`. With `M` = 0
/// [`Method::Paper`](crate::Method::Paper) is refused, and neither its storage nor its code is there:
///
/// ```
/// use capsule_core::{Workspace, scratch_len};
///
/// type Direct = Workspace<f32, 129, 0, 16, { scratch_len(0, 16) }>;
/// assert!(size_of::<Direct>() < size_of::<Workspace<f32>>() / 2);
/// ```
///
/// In this order, what is small lies before what is large: a Cortex-M reaches the first 4 KiB in one instruction.
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
    pub(crate) weights: Weights<T, N>,
    pub(crate) displacement: Coefficients<T, K>,
    pub(crate) velocity: Coefficients<T, K>,
    pub(crate) contracted: Contracted<T, K>,
    pub(crate) dynamics: Dynamics<T, M>,
    pub(crate) controls: Controls<T, K>,
    /// Room for one thing at a time: the interpolation, then the snapshots' factor of either field.
    pub(crate) scratch: [T; S],
}

/// Memory in which a workspace is set up.
pub trait Parts {
    /// Takes a part of it, to be written so many bytes from its start.
    fn put<P>(&mut self, offset: usize, part: P);
}

/// Leading coefficients, the translation's among them, that the paper's method works in. Those beyond are below its
/// error, and would take part in the few local modes.
pub(crate) const PAPER_MODES: usize = 41;
/// Room for them, and for zeros that fill the lanes of a product from any of them on.
pub(crate) const PAPER_ROW: usize = PAPER_MODES + LANES - 1;
/// Snapshots that there is room for.
pub(crate) const SNAPSHOTS: usize = 64;

/// The most modes: twice as many digits, each at most 128 times the greatest factor of singles, 32,767, are a sum below
/// 2^31.
const MAX_MODES: usize = 256;

/// Numbers of scratch that a [`Workspace`] of `M` local modes and `N` samples needs.
pub const fn scratch_len(local_modes: usize, neighbours: usize) -> usize {
    let interpolation = (MAX_COLUMNS + neighbours) * neighbours;
    let factor = if local_modes > 0 { PAPER_ROW * SNAPSHOTS } else { 0 };
    if interpolation > factor { interpolation } else { factor }
}

/// The factor of the snapshots.
pub(crate) type Factor<T> = [[T; PAPER_ROW]; SNAPSHOTS];

/// The query that the workspace answers, of the model with this digest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prepared<T> {
    pub(crate) digest: u32,
    pub(crate) query: Query<T>,
    pub(crate) domain: Domain,
}

/// Coefficients of a field, the shape's ready for products with the modes, and the instant that they belong to.
#[derive(Clone, Debug)]
pub(crate) struct Coefficients<T: Real, const K: usize> {
    pub(crate) t: Option<T>,
    pub(crate) translation: T,
    /// Whether nodes computed from them are sure to be finite.
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

    /// Judges the first of its values before any node is written to a caller's buffer: no entry of a mode is beyond
    /// 1e6, so that all nodes are finite where these are bounded.
    pub(crate) fn judge(&mut self, modes: usize) {
        const MAX: f32 = 1e30;
        let values = self.shape.values.as_flattened().iter().take(modes);
        let sum = values.fold(self.translation.abs(), |sum, value| sum + value.abs());
        // A NaN is not within.
        self.bounded = sum <= T::from_f32(MAX);
    }

    /// Refuses coefficients that could lead to a node that is not finite.
    pub(crate) fn checked(&self) -> Result<(), EvaluateError> {
        if self.bounded {
            Ok(())
        } else {
            Err(EvaluateError::NotFinite)
        }
    }
}

impl<T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Workspace<T, K, M, N, S> {
    /// An empty workspace.
    pub const fn new() -> Self {
        const {
            assert!(S >= scratch_len(M, N), "the work must fit into the scratch");
            assert!(K <= MAX_MODES, "sums of products must not overflow")
        };
        Self {
            prepared: None,
            plausible: None,
            scratch: [T::ZERO; S],
            weights: Weights::EMPTY,
            contracted: Contracted::EMPTY,
            controls: Controls::EMPTY,
            displacement: Coefficients::EMPTY,
            velocity: Coefficients::EMPTY,
            dynamics: Dynamics::EMPTY,
        }
    }

    /// Hands out what of an empty workspace is no number, part by part: with zeros elsewhere that is a workspace. For
    /// memory that is not Rust's, where the stack has no room for a whole one.
    pub fn put(parts: &mut impl Parts) {
        parts.put(offset_of!(Self, prepared), None::<Prepared<T>>);
        parts.put(offset_of!(Self, plausible), None::<T>);
        parts.put(offset_of!(Self, displacement.t), None::<T>);
        parts.put(offset_of!(Self, displacement.bounded), false);
        parts.put(offset_of!(Self, velocity.t), None::<T>);
        parts.put(offset_of!(Self, velocity.bounded), false);
        Contracted::<T, K>::put(parts, offset_of!(Self, contracted));
        Controls::<T, K>::put(parts, offset_of!(Self, controls));
        Dynamics::<T, M>::put(parts, offset_of!(Self, dynamics));
    }

    /// Forgets what belongs to a query: the next one is computed anew, whatever the storage holds.
    pub fn invalidate(&mut self) {
        self.prepared = None;
        self.plausible = None;
        self.displacement.t = None;
        self.velocity.t = None;
        self.controls.invalidate();
        self.dynamics.invalidate();
    }
}

impl<T: Real, const K: usize, const M: usize, const N: usize, const S: usize> Default for Workspace<T, K, M, N, S> {
    fn default() -> Self {
        Self::new()
    }
}
