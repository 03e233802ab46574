//! Functions that a JavaScript engine calls. The module holds the model and the vectors, so that only counts cross.

use crate::{Asker, Precision, check};
use core::sync::atomic::{AtomicU32, Ordering};

static MODEL: &[u8] = include_bytes!("../../../models/capsule.crom");
static VECTORS: &str = include_str!("../vectors.txt");
static DIFFERENT: AtomicU32 = AtomicU32::new(0);

/// Asks all cases of a precision, 32 or 64; returns how many were asked, -1 if the vectors cannot be read.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn asked(bits: u32) -> i32 {
    let precision = if bits == 32 {
        Precision::Single
    } else {
        Precision::Double
    };
    let mut asker = Asker::new();
    DIFFERENT.store(0, Ordering::Relaxed);
    let differs = |_: &str, _: &str| {
        DIFFERENT.fetch_add(1, Ordering::Relaxed);
    };
    check(MODEL, VECTORS, precision, &mut asker, differs).map_or(-1, |count| count as i32)
}

/// How many came out otherwise the last time.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn different() -> u32 {
    DIFFERENT.load(Ordering::Relaxed)
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
