//! The shipped model: a capsule in a square channel, for `Model::open` of the crate `capsule-rom-core`.
#![no_std]

/// Its matrices are read in place where they are aligned.
#[repr(C, align(16))]
struct Aligned<T: ?Sized>(T);

static ALIGNED: &Aligned<[u8]> = &Aligned(*include_bytes!("../capsule.crom"));

/// The bytes of the file.
pub static SHIPPED: &[u8] = &ALIGNED.0;
