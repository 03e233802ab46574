//! From C's pointers to Rust's references: null, misaligned and overlapping ones are refused.

use crate::Status;
use core::mem::MaybeUninit;
use core::ptr::NonNull;
use core::slice;

/// `count` values at a pointer. What it points to may be used after [`check`] has passed its bytes.
pub(crate) struct Buffer<T> {
    start: *mut T,
    count: usize,
    written: bool,
}

impl<T> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Buffer<T> {}

/// The bytes of a buffer.
#[derive(Clone, Copy)]
pub(crate) struct Bytes {
    start: usize,
    /// The greatest number where there are more.
    length: usize,
    alignment: usize,
    written: bool,
}

impl Bytes {
    /// No memory.
    pub(crate) const NONE: Self = Self {
        start: 1,
        length: 0,
        alignment: 1,
        written: false,
    };

    fn judge(&self) -> Result<(), Status> {
        if self.start == 0 {
            return Err(Status::Null);
        }
        if !self.start.is_multiple_of(self.alignment) {
            return Err(Status::Misaligned);
        }
        // A slice of Rust may not be longer than an isize can say.
        if isize::try_from(self.length).is_err() || self.start.checked_add(self.length).is_none() {
            return Err(Status::Overlap);
        }
        Ok(())
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.start < other.start + other.length && other.start < self.start + self.length
    }
}

/// Refuses buffers that the call would write over the bytes of a model's file.
pub(crate) fn spare(file: Bytes, buffers: &[Bytes], error: Bytes) -> Result<(), Status> {
    let mut written = buffers.iter().chain([&error]).filter(|bytes| bytes.written);
    if written.any(|bytes| bytes.overlaps(&file)) {
        return Err(Status::Overlap);
    }
    Ok(())
}

/// Refuses buffers that are null or misaligned, reach beyond the end of memory, or share memory.
pub(crate) fn check(buffers: &[Bytes], error: Bytes) -> Result<(), Status> {
    buffers.iter().try_for_each(Bytes::judge)?;
    error.judge()?;
    for (i, a) in buffers.iter().enumerate() {
        if a.overlaps(&error) || buffers.iter().take(i).any(|b| a.overlaps(b)) {
            return Err(Status::Overlap);
        }
    }
    Ok(())
}

impl<T> Buffer<T> {
    /// `count` values at a pointer, to read.
    pub(crate) fn input(pointer: *const T, count: usize) -> Self {
        Self {
            start: pointer.cast_mut(),
            count,
            written: false,
        }
    }

    /// `count` values at a pointer, to write.
    pub(crate) fn output(pointer: *mut T, count: usize) -> Self {
        Self {
            start: pointer,
            count,
            written: true,
        }
    }

    /// Where it lies.
    pub(crate) fn bytes(&self) -> Bytes {
        Bytes {
            start: self.start.addr(),
            length: self.count.saturating_mul(size_of::<T>()),
            alignment: align_of::<T>(),
            written: self.written,
        }
    }

    /// Where it lies, if there is one: its pointer may be null.
    pub(crate) fn optional_bytes(&self) -> Bytes {
        if self.is_null() { Bytes::NONE } else { self.bytes() }
    }

    /// Whether there is none.
    pub(crate) fn is_null(&self) -> bool {
        self.start.is_null()
    }

    /// Its first value.
    ///
    /// # Safety
    /// [`check`] has passed the buffer.
    pub(crate) unsafe fn start(&self) -> NonNull<T> {
        // SAFETY: not null.
        unsafe { NonNull::new_unchecked(self.start) }
    }

    /// The values.
    ///
    /// # Safety
    /// [`check`] has passed the buffer. The caller of the interface promised that the memory holds initialised values,
    /// which nobody writes while the reference lives. `T` is valid with every pattern of bits.
    pub(crate) unsafe fn values<'a>(self) -> &'a [T] {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe { slice::from_raw_parts(self.start, self.count) }
    }

    /// The memory, set to zeros, to write values into.
    ///
    /// # Safety
    /// [`check`] has passed the buffer with the others of the call. The caller of the interface promised that nobody else
    /// uses the memory. `T` is valid with zeros.
    pub(crate) unsafe fn zeros<'a>(self) -> &'a mut [T] {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe {
            self.start.write_bytes(0, self.count);
            slice::from_raw_parts_mut(self.start, self.count)
        }
    }

    /// The memory of the first value, which may hold anything.
    ///
    /// # Safety
    /// As [`zeros`](Self::zeros), without what is said of `T`; `count` is at least 1.
    pub(crate) unsafe fn place<'a>(self) -> &'a mut MaybeUninit<T> {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe { &mut *self.start.cast::<MaybeUninit<T>>() }
    }
}
