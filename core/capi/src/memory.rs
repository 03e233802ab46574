//! From C's pointers to Rust's references: null, misaligned and overlapping ones are refused.

use crate::Status;
use core::mem::MaybeUninit;
use core::ptr::NonNull;
use core::slice;

/// A value at a pointer, to be used after [`check`] has passed its bytes.
pub(crate) struct Place<T>(*mut T);

/// `count` values at a pointer, the first of them in its place.
pub(crate) struct Buffer<T> {
    first: Place<T>,
    count: usize,
}

impl<T> Clone for Place<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Place<T> {}

impl<T> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Buffer<T> {}

/// The bytes that a call reads or writes. They are stored at every call, so they are few words.
#[derive(Clone, Copy)]
pub(crate) struct Bytes {
    start: usize,
    /// Values, of this size.
    count: usize,
    size: u16,
    alignment: u8,
    written: bool,
}

impl Bytes {
    /// No memory.
    pub(crate) const NONE: Self = Self {
        start: 1,
        count: 0,
        size: 1,
        alignment: 1,
        written: false,
    };

    /// The same, if there is any: the pointer may be null.
    pub(crate) fn optional(self) -> Self {
        if self.start == 0 { Self::NONE } else { self }
    }

    fn validate(&self) -> Result<(), Status> {
        if self.start == 0 {
            return Err(Status::Null);
        }
        if !self.start.is_multiple_of(self.alignment.into()) {
            return Err(Status::Misaligned);
        }
        self.checked_end().map(|_| ()).ok_or(Status::Overlap)
    }

    /// The end of all values; none beyond the end of memory. A slice of Rust holds at most isize::MAX bytes.
    fn checked_end(&self) -> Option<usize> {
        let length = self.count.checked_mul(self.size.into())?;
        isize::try_from(length).ok()?;
        self.start.checked_add(length)
    }

    /// The end of all values; of the first one where the count exceeds the memory.
    fn end(&self) -> usize {
        let first = self.start.saturating_add(self.size.into());
        self.checked_end().unwrap_or(first)
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.start < other.end() && other.start < self.end()
    }
}

/// Refuses a place for the error that is misaligned or shares memory with one of the call's buffers, valid or not.
pub(crate) fn check_error(error: Bytes, buffers: &[Bytes]) -> Result<(), Status> {
    error.validate()?;
    if buffers.iter().any(|bytes| bytes.overlaps(&error)) {
        return Err(Status::Overlap);
    }
    Ok(())
}

/// Refuses buffers that are null or misaligned, reach beyond the end of memory, or share memory, and those that the
/// call would write over the bytes of a model's file.
pub(crate) fn check(buffers: &[Bytes], file: Bytes) -> Result<(), Status> {
    buffers.iter().try_for_each(Bytes::validate)?;
    for (i, a) in buffers.iter().enumerate() {
        if a.written && a.overlaps(&file) || buffers.iter().take(i).any(|b| a.overlaps(b)) {
            return Err(Status::Overlap);
        }
    }
    Ok(())
}

impl<T> Place<T> {
    /// A value to read.
    pub(crate) fn input(pointer: *const T) -> Self {
        Self(pointer.cast_mut())
    }

    /// A value to write.
    pub(crate) fn output(pointer: *mut T) -> Self {
        Self(pointer)
    }

    /// Its bytes, to read.
    pub(crate) fn read(&self) -> Bytes {
        self.bytes(1, false)
    }

    /// Its bytes, to write.
    pub(crate) fn written(&self) -> Bytes {
        self.bytes(1, true)
    }

    fn bytes(&self, count: usize, written: bool) -> Bytes {
        const {
            assert!(size_of::<T>() <= u16::MAX as usize && align_of::<T>() <= u8::MAX as usize);
        }
        Bytes {
            start: self.0.addr(),
            // At a null pointer there is no memory.
            count: if self.is_null() { 0 } else { count },
            size: size_of::<T>() as u16,
            alignment: align_of::<T>() as u8,
            written,
        }
    }

    /// Whether there is none.
    pub(crate) fn is_null(&self) -> bool {
        self.0.is_null()
    }

    /// Whether it may be read.
    pub(crate) fn is_valid(&self) -> bool {
        self.read().validate().is_ok()
    }

    /// Where it starts.
    ///
    /// # Safety
    /// [`check`] has passed it, or it [is valid](Self::is_valid).
    pub(crate) unsafe fn start(&self) -> NonNull<T> {
        // SAFETY: not null.
        unsafe { NonNull::new_unchecked(self.0) }
    }

    /// Its memory, which may hold anything.
    ///
    /// # Safety
    /// [`check`] has passed it with the others of the call. The caller of the interface promised that nobody else uses
    /// the memory.
    pub(crate) unsafe fn memory<'a>(self) -> &'a mut MaybeUninit<T> {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe { &mut *self.0.cast::<MaybeUninit<T>>() }
    }

    /// Its memory, set to zeros. In words of four bytes: for those of eight a microcontroller would link another
    /// function.
    ///
    /// # Safety
    /// As [`memory`](Self::memory). `T` is valid with zeros, and as large as some words.
    pub(crate) unsafe fn zeros<'a>(self) -> &'a mut T {
        const { assert!(size_of::<T>().is_multiple_of(4)) };
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe {
            self.0.cast::<u32>().write_bytes(0, size_of::<T>() / 4);
            &mut *self.0
        }
    }
}

impl<T> Buffer<T> {
    /// `count` values to read.
    pub(crate) fn input(pointer: *const T, count: usize) -> Self {
        let first = Place::input(pointer);
        Self { first, count }
    }

    /// `count` values to write.
    pub(crate) fn output(pointer: *mut T, count: usize) -> Self {
        let first = Place::output(pointer);
        Self { first, count }
    }

    /// Their bytes, to read.
    pub(crate) fn read(&self) -> Bytes {
        self.first.bytes(self.count, false)
    }

    /// Their bytes, to write.
    pub(crate) fn written(&self) -> Bytes {
        self.first.bytes(self.count, true)
    }

    /// Whether there are none.
    pub(crate) fn is_null(&self) -> bool {
        self.first.is_null()
    }

    /// The values.
    ///
    /// # Safety
    /// [`check`] has passed the buffer. The caller of the interface promised that the memory holds initialised values,
    /// which nobody writes while the reference lives. `T` is valid with every pattern of bits.
    pub(crate) unsafe fn values<'a>(self) -> &'a [T] {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe { slice::from_raw_parts(self.first.0, self.count) }
    }

    /// The memory, to write values into. What was in it is not known.
    ///
    /// # Safety
    /// [`check`] has passed the buffer with the others of the call. The caller of the interface promised that nobody
    /// else uses the memory. `T` is valid with every pattern of bits: memory that comes from C holds one, which nobody
    /// reads before it is written.
    pub(crate) unsafe fn room<'a>(self) -> &'a mut [T] {
        // SAFETY: aligned, not null, in bounds; the rest is promised.
        unsafe { slice::from_raw_parts_mut(self.first.0, self.count) }
    }
}
