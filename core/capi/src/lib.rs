//! C interface of capsule-rom-core, in single precision: what `include/capsule.h` says, and nothing else.
//!
//! No heap, no global state, no panic. The caller owns all memory: a model's file, a [`Model`] that describes it, and a
//! [`Workspace`] for one query at a time. Every function returns a [`Status`]. Symbols carry the version of the
//! interface, so that two versions can be linked into one program; the header has plain names for them.
//!
//! Unsafe code is needed to read and write what C points to. What is done with a pointer stands in `memory` and
//! `opaque`, what can be checked is; what the caller has to keep is said in `functions`, whose calls rely on it. The
//! other unsafe code of the online stage is the instructions of capsule-dsp.
#![no_std]

mod dispatch;
mod error;
pub mod functions;
mod memory;
mod opaque;
mod status;
mod values;

pub use error::Error;
pub use functions::*;
pub use opaque::{
    MAX_LOCAL_MODES, MAX_MODES, MAX_NEIGHBOURS, MODEL_ALIGNMENT, MODEL_SIZE, MODEL_WORDS, Model, WORKSPACE_ALIGNMENT,
    WORKSPACE_SIZE, WORKSPACE_WORDS, Workspace,
};
pub use status::Status;
pub use values::{Description, Domain, Frame, Membrane, Method, Observables, Outline, Parameter, Query};

/// cbindgen:ignore
#[cfg(feature = "standalone")]
mod panic {
    unsafe extern "C" {
        /// Defined nowhere: a panic that the optimiser cannot rule out becomes a link error.
        fn capsule_a_panic_can_be_reached() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        // SAFETY: never linked, so never called.
        unsafe { capsule_a_panic_can_be_reached() }
    }
}
