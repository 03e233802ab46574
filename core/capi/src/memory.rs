//! From C's pointers to Rust's references: null, misaligned and overlapping ones are refused.

use crate::Status;
use core::mem::MaybeUninit;
use core::ptr::NonNull;
use core::slice;

/// `count` values at a pointer that is neither null nor misaligned and does not reach beyond the end of memory.
pub(crate) struct Buffer<T> {
    start: NonNull<T>,
    count: usize,
}

/// The bytes of a buffer.
#[derive(Clone, Copy)]
pub(crate) struct Bytes {
    start: usize,
    end: usize,
}

impl Bytes {
    /// No memory.
    pub(crate) const NONE: Self = Self { start: 0, end: 0 };
}

impl<T> Buffer<T> {
    /// Checks a pointer to `count` values.
    pub(crate) fn new(pointer: *const T, count: usize) -> Result<Self, Status> {
        let start = NonNull::new(pointer.cast_mut()).ok_or(Status::Null)?;
        if !pointer.is_aligned() {
            return Err(Status::Misaligned);
        }
        let length = count.checked_mul(size_of::<T>()).ok_or(Status::Overlap)?;
        // A slice of Rust may not be longer.
        let within = isize::try_from(length).is_ok() && pointer.addr().checked_add(length).is_some();
        if within {
            Ok(Self { start, count })
        } else {
            Err(Status::Overlap)
        }
    }

    /// Its first value.
    pub(crate) fn start(&self) -> NonNull<T> {
        self.start
    }

    /// Where it lies.
    pub(crate) fn bytes(&self) -> Bytes {
        let start = self.start.addr().get();
        Bytes {
            start,
            end: start + self.count * size_of::<T>(),
        }
    }

    /// The values.
    ///
    /// # Safety
    /// The caller of the interface promised that the memory holds initialised values, which nobody writes while the
    /// reference lives. `T` is valid with every pattern of bits.
    pub(crate) unsafe fn values<'a>(self) -> &'a [T] {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe { slice::from_raw_parts(self.start.as_ptr(), self.count) }
    }

    /// The memory, set to zeros, to write values into.
    ///
    /// # Safety
    /// The caller of the interface promised that nobody else uses the memory; [`apart`] was asked about the other
    /// buffers of the call. `T` is valid with zeros.
    pub(crate) unsafe fn zeros<'a>(self) -> &'a mut [T] {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe {
            self.start.as_ptr().write_bytes(0, self.count);
            slice::from_raw_parts_mut(self.start.as_ptr(), self.count)
        }
    }

    /// The memory of the first value, which may hold anything.
    ///
    /// # Safety
    /// As [`zeros`](Self::zeros), without what is said of `T`; `count` is at least 1.
    pub(crate) unsafe fn place<'a>(self) -> &'a mut MaybeUninit<T> {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe { self.start.cast::<MaybeUninit<T>>().as_mut() }
    }
}

/// Refuses buffers that share memory.
pub(crate) fn apart(buffers: &[Bytes]) -> Result<(), Status> {
    for (i, a) in buffers.iter().enumerate() {
        for b in buffers.iter().take(i) {
            if a.start < b.end && b.start < a.end {
                return Err(Status::Overlap);
            }
        }
    }
    Ok(())
}
