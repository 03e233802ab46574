//! A list of node indices, read in place.

use super::wire::Blob;
use crate::linalg::slice_or_empty;
use core::ops::Range;

/// A stored list of node indices.
#[derive(Clone, Copy, Debug)]
pub struct Indices<'a>(&'a [[u8; 2]]);

impl<'a> Indices<'a> {
    /// A view of a blob of little-endian u16.
    pub fn new(blob: &Blob<'a>) -> Self {
        Self(blob.data.as_chunks().0)
    }

    /// The indices in a range; empty where the range reaches beyond the list.
    pub(super) fn slice_or_empty(&self, range: Range<usize>) -> Self {
        Self(slice_or_empty(self.0, range))
    }

    /// Number of indices.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Index number `i`, if there is one.
    pub fn get(&self, i: usize) -> Option<usize> {
        self.0.get(i).map(|bytes| usize::from(u16::from_le_bytes(*bytes)))
    }

    /// All indices in order.
    pub fn iter(self) -> impl DoubleEndedIterator<Item = usize> + ExactSizeIterator + use<'a> {
        self.0.iter().map(|bytes| usize::from(u16::from_le_bytes(*bytes)))
    }
}
