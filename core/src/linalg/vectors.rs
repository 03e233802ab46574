//! The widest vectors that the machine has.

/// Does what `work` says, on x86-64 by instructions of AVX2 if the machine knows them; the bits are the same. What
/// `work` calls must be inlined into it.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn in_vectors<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// Does what `work` says: elsewhere the compiler knows what the machine has.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn in_vectors<R>(work: impl FnOnce() -> R) -> R {
    work()
}
