//! The two opaque objects, which the caller allocates.

use crate::Status;
use crate::memory::{Buffer, Bytes, Place};
use capsule_core as rom;
use core::mem::MaybeUninit;
use core::ptr::NonNull;

/// The most modes of a field that a workspace holds, the translation included.
pub const MAX_MODES: usize = 129;
/// The most local modes of a field that a workspace holds.
#[cfg(not(feature = "direct"))]
pub const MAX_LOCAL_MODES: usize = 16;
/// None, as the library is without the paper's method.
#[cfg(feature = "direct")]
pub const MAX_LOCAL_MODES: usize = 0;
/// The most samples that take part in a query.
pub const MAX_NEIGHBOURS: usize = 32;

/// Words of eight bytes in a workspace.
#[cfg(not(feature = "direct"))]
pub const WORKSPACE_WORDS: usize = 3410;
/// Words of eight bytes in a workspace.
#[cfg(feature = "direct")]
pub const WORKSPACE_WORDS: usize = 1578;
/// Bytes of a workspace.
pub const WORKSPACE_SIZE: usize = WORKSPACE_WORDS * 8;
/// Alignment of a workspace.
pub const WORKSPACE_ALIGNMENT: usize = 8;
/// Words of eight bytes in a model.
pub const MODEL_WORDS: usize = 828;
/// Bytes of a model.
pub const MODEL_SIZE: usize = MODEL_WORDS * 8;
/// Alignment of a model.
pub const MODEL_ALIGNMENT: usize = 8;

/// An opened model. The file's bytes stay where they are.
#[repr(C)]
pub struct Model {
    /// For the library.
    pub opaque: [u64; MODEL_WORDS],
}

/// Storage for one query at a time.
#[repr(C)]
pub struct Workspace {
    /// For the library.
    pub opaque: [u64; WORKSPACE_WORDS],
}

/// cbindgen:ignore
pub(crate) const SCRATCH: usize = rom::scratch_len(MAX_LOCAL_MODES, MAX_NEIGHBOURS);
/// cbindgen:ignore
pub(crate) type CoreWorkspace = rom::Workspace<f32, MAX_MODES, MAX_LOCAL_MODES, MAX_NEIGHBOURS, SCRATCH>;

/// An opaque object of the interface, and what it holds. The tag tells memory that was set up from memory that was not.
pub(crate) trait Opaque: Sized {
    type Content;
    const TAG: u32;
    /// Status of a call with an object that was not set up.
    const MISSING: Status;
}

#[repr(C)]
struct Tagged<C> {
    tag: u32,
    content: C,
}

impl Opaque for Model {
    type Content = rom::Model<'static>;
    const TAG: u32 = u32::from_le_bytes(*b"v1mo");
    const MISSING: Status = Status::NoModel;
}

impl Opaque for Workspace {
    type Content = CoreWorkspace;
    const TAG: u32 = u32::from_le_bytes(*b"v1wo");
    const MISSING: Status = Status::NoWorkspace;
}

/// Memory in which a workspace is set up.
struct Room<'a>(&'a mut MaybeUninit<CoreWorkspace>);

impl rom::Parts for Room<'_> {
    fn put<P>(&mut self, offset: usize, part: P) {
        // SAFETY: a part of this type lies there in a workspace.
        unsafe { self.0.as_mut_ptr().byte_add(offset).cast::<P>().write(part) }
    }
}

impl Place<Workspace> {
    /// Makes an empty workspace where it lies: one on the stack would be larger than the stack of a microcontroller.
    ///
    /// # Safety
    /// The caller of the interface promised that nobody else uses the memory.
    pub(crate) unsafe fn empty(self) {
        // SAFETY: aligned, and large enough. Zeros are valid for the numbers, and all else is written.
        unsafe {
            let room = self.room();
            room.as_mut_ptr().write_bytes(0, 1);
            CoreWorkspace::put(&mut Room(room));
            self.set_up();
        }
    }
}

impl Place<Model> {
    /// Where the file of a model lies that was opened.
    ///
    /// # Safety
    /// As [`content`](Self::content).
    pub(crate) unsafe fn file(&self) -> Bytes {
        // SAFETY: the caller keeps this function's contract.
        let content = unsafe { self.content() };
        content.map_or(Bytes::NONE, |model| {
            let file = model.file();
            Buffer::input(file.as_ptr(), file.len()).read()
        })
    }
}

impl<O: Opaque> Place<O> {
    const FITS: () = assert!(
        size_of::<Tagged<O::Content>>() <= size_of::<O>() && align_of::<Tagged<O::Content>>() <= align_of::<O>(),
        "the object has room for its content"
    );

    /// # Safety
    /// The caller of the interface promised that the memory is there; it was checked.
    unsafe fn tagged(&self) -> NonNull<Tagged<O::Content>> {
        const { Self::FITS };
        // SAFETY: it was checked.
        unsafe { self.start() }.cast()
    }

    /// Room for the content.
    ///
    /// # Safety
    /// The caller of the interface promised that nobody else uses the memory.
    pub(crate) unsafe fn room<'a>(&self) -> &'a mut MaybeUninit<O::Content> {
        // SAFETY: aligned, and large enough.
        unsafe { &mut *(&raw mut (*self.tagged().as_ptr()).content).cast() }
    }

    /// Marks the object as set up.
    ///
    /// # Safety
    /// As [`room`](Self::room), where a content has been written.
    pub(crate) unsafe fn set_up(self) {
        // SAFETY: the tag is the first word of the object.
        unsafe { self.start().cast::<u32>().write(O::TAG) }
    }

    /// Marks the object as not set up.
    ///
    /// # Safety
    /// As [`room`](Self::room).
    pub(crate) unsafe fn clear(&self) {
        // SAFETY: the tag is the first word of the object.
        unsafe { self.start().cast::<u32>().write(0) }
    }

    /// Refuses an object that was not set up.
    ///
    /// # Safety
    /// As [`room`](Self::room).
    unsafe fn validate(&self) -> Result<(), Status> {
        // SAFETY: the tag is the first word of the object; a caller who leaves it uninitialised gets some number.
        let tag = unsafe { self.start().cast::<u32>().read() };
        if tag == O::TAG { Ok(()) } else { Err(O::MISSING) }
    }

    /// The content.
    ///
    /// # Safety
    /// The caller of the interface promised that the object is as the interface left it, and that nobody writes to it
    /// while the reference lives.
    pub(crate) unsafe fn content<'a>(&self) -> Result<&'a O::Content, Status> {
        // SAFETY: the tag says that the content was written.
        unsafe {
            self.validate()?;
            Ok(&self.tagged().as_ref().content)
        }
    }

    /// The content, to change.
    ///
    /// # Safety
    /// As [`content`](Self::content), and nobody else uses it.
    pub(crate) unsafe fn content_mut<'a>(&self) -> Result<&'a mut O::Content, Status> {
        // SAFETY: the tag says that the content was written.
        unsafe {
            self.validate()?;
            Ok(&mut self.tagged().as_mut().content)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::boxed::Box;
    use std::format;

    /// All bits set are valid for floating-point numbers only: Miri finds a field that was not written.
    #[test]
    fn every_field_that_is_not_a_number_is_written() {
        let mut memory = Box::<CoreWorkspace>::new_uninit();
        // SAFETY: of the memory's size.
        unsafe { memory.as_mut_ptr().write_bytes(0xff, 1) };
        CoreWorkspace::put(&mut Room(&mut memory));
        // SAFETY: its floating-point numbers accept any bits, and all other fields were written.
        let workspace = unsafe { memory.assume_init() };
        let (found, empty) = (format!("{workspace:?}"), format!("{:?}", CoreWorkspace::new()));
        // Equal apart from the numbers.
        let words = |text: &str| text.replace("NaN", "").replace(|c: char| !c.is_ascii_alphabetic(), "");
        assert_eq!(words(&found), words(&empty));
    }
}
