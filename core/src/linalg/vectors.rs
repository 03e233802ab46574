//! Run-time choice of the machine's widest vector instructions.

/// Runs `work`, on x86-64 compiled for the widest vectors that the processor has; the results are the same bits.
/// Functions that `work` calls must be inlined into it.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn in_vectors<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// Runs `work`: on other targets the instructions are fixed at compile time.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn in_vectors<R>(work: impl FnOnce() -> R) -> R {
    work()
}
