//! Reading the message where it lies, field by field into place: what serde would build by value, on a stack that a
//! microcontroller does not have. The format is postcard's: integers above a byte in groups of seven bits, the lowest
//! first; bytes, texts and lists behind their length; enums by the number of the variant; floats as they are.

use super::wire::{
    Blob, Cluster, Contents, Digits, Encoding, Errors, Field, Kernel, Matrix, Mesh, Metadata, Method, NodeSet, Paper,
    Parameter, Reference, Samples, Span, Units,
};
use heapless::Vec;

/// A part of the message.
pub(super) trait Part<'a> {
    /// Reads it from the front of what is left.
    fn read(&mut self, from: &mut Cursor<'a>);

    /// Visits its blobs in the order of the message.
    fn for_each_blob(&mut self, _visit: &mut dyn FnMut(&mut Blob<'a>)) {}
}

/// The parts of a struct are its fields, in the order of the message. The compiler refuses a list that forgets one.
macro_rules! parts {
    ($($part:ty { $($field:ident),+ })+) => { $(
        impl<'a> Part<'a> for $part {
            fn read(&mut self, from: &mut Cursor<'a>) {
                let Self { $($field),+ } = self;
                $($field.read(from);)+
            }

            fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
                let Self { $($field),+ } = self;
                $($field.for_each_blob(visit);)+
            }
        }
    )+ };
}

parts! {
    Contents<'a> {
        metadata, mesh, times, error_times, steady_limit, bending_effect, border, default_method, kernel, paper, split,
        clusters
    }
    Metadata<'a> {
        title, units, membrane_law, bending_stiffness, parameters, database_digest, offline_settings, created_unix_s
    }
    Units<'a> { length, velocity, time }
    Parameter<'a> { name, min, max, origin, scale }
    Mesh<'a> {
        nodes, element_nodes, elements, reference, sector_reference, operations, images, origins, node_sets
    }
    NodeSet<'a> { name, nodes }
    Cluster<'a> {
        min, max, samples, field, direct_errors, paper_errors, interval_errors, interval_bound_factors
    }
    Samples<'a> { parameters, places }
    Field<'a> { modes, knots, spans, axial_controls, axial_modes }
    Span<'a> { parameter_modes, slices, core }
    Errors<'a> { left_out, deviation, bound_factors, changes, floor }
    Kernel { neighbours, scales }
    Paper { neighbours, scales, radius, displacement_rank, velocity_rank, window }
    Matrix<'a> { rows, columns, encoding, blob }
}

/// What is left of a message. Where it does not decode it is at its end, so that the rest reads as zeros; that it did
/// not decode is asked once, in the end.
pub(super) struct Cursor<'a> {
    left: &'a [u8],
    sound: bool,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(message: &'a [u8]) -> Self {
        Self {
            left: message,
            sound: true,
        }
    }

    /// How many bytes are left, if all that was read did decode.
    pub(super) fn end(self) -> Option<usize> {
        self.sound.then_some(self.left.len())
    }

    fn spoil(&mut self) {
        (self.left, self.sound) = (&[], false);
    }

    fn take(&mut self, count: usize) -> &'a [u8] {
        let Some((taken, left)) = self.left.split_at_checked(count) else {
            self.spoil();
            return &[];
        };
        self.left = left;
        taken
    }

    fn byte(&mut self) -> u8 {
        self.take(1).first().copied().unwrap_or_default()
    }

    /// An integer of at most `bits` bits. There is none of more than 32, which a microcontroller would take in two
    /// halves.
    #[inline(never)]
    fn integer(&mut self, bits: u32) -> u32 {
        let greatest = u32::MAX >> (u32::BITS - bits);
        let mut value = 0;
        for shift in (0..bits).step_by(7) {
            let byte = self.byte();
            let group = u32::from(byte & 0x7f);
            if group > greatest >> shift {
                break;
            }
            value |= group << shift;
            if byte < 0x80 {
                return value;
            }
        }
        self.spoil();
        0
    }

    /// The same number on every target: a length of more than 32 bits cannot be right.
    fn length(&mut self) -> usize {
        self.integer(u32::BITS) as usize
    }

    #[inline(never)]
    fn bytes(&mut self) -> &'a [u8] {
        let length = self.length();
        self.take(length)
    }
}

impl<'a> Part<'a> for u8 {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = from.byte();
    }
}

impl<'a> Part<'a> for u16 {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = from.integer(Self::BITS) as Self;
    }
}

impl<'a> Part<'a> for u32 {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = from.integer(Self::BITS);
    }
}

impl<'a> Part<'a> for f64 {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = from
            .take(8)
            .first_chunk()
            .map_or(0.0, |bytes| Self::from_le_bytes(*bytes));
    }
}

impl<'a> Part<'a> for Option<f64> {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = match from.byte() {
            0 => None,
            1 => {
                let mut value = 0.0;
                value.read(from);
                Some(value)
            }
            _ => return from.spoil(),
        }
    }
}

impl<'a> Part<'a> for &'a str {
    fn read(&mut self, from: &mut Cursor<'a>) {
        match core::str::from_utf8(from.bytes()) {
            Ok(text) => *self = text,
            Err(_) => from.spoil(),
        }
    }
}

impl<'a> Part<'a> for Blob<'a> {
    fn read(&mut self, from: &mut Cursor<'a>) {
        self.pad = from.bytes();
        self.data = from.bytes();
    }

    fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
        visit(self);
    }
}

impl<'a> Part<'a> for Method {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = match from.integer(32) {
            0 => Self::Direct,
            1 => Self::Paper,
            _ => return from.spoil(),
        }
    }
}

impl<'a> Part<'a> for Encoding {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = match from.integer(32) {
            0 => Self::F32,
            variant @ 1..=3 => {
                let mut coarse = 0;
                coarse.read(from);
                let digits = Digits { coarse };
                match variant {
                    1 => Self::Columns(digits),
                    2 => Self::ColumnPanels(digits),
                    _ => Self::RowPanels(digits),
                }
            }
            _ => return from.spoil(),
        }
    }
}

impl<'a> Part<'a> for Reference {
    fn read(&mut self, from: &mut Cursor<'a>) {
        *self = match from.integer(32) {
            0 => Self::Sphere,
            1 => {
                let (mut radius, mut origin, mut volumes) = (0.0, 0.0, [0.0; 2]);
                radius.read(from);
                origin.read(from);
                volumes.read(from);
                Self::Shape {
                    radius,
                    origin,
                    volumes,
                }
            }
            _ => return from.spoil(),
        }
    }
}

impl<'a, P: Part<'a>, const N: usize> Part<'a> for [P; N] {
    fn read(&mut self, from: &mut Cursor<'a>) {
        for part in self {
            part.read(from);
        }
    }

    fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
        for part in self {
            part.for_each_blob(visit);
        }
    }
}

impl<'a, P: Part<'a> + Default, const N: usize> Part<'a> for Vec<P, N> {
    fn read(&mut self, from: &mut Cursor<'a>) {
        for _ in 0..from.length() {
            // More than there is room for cannot be right.
            if self.push(P::default()).is_err() {
                return from.spoil();
            }
            if let Some(part) = self.last_mut() {
                part.read(from);
            }
        }
    }

    fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
        for part in self {
            part.for_each_blob(visit);
        }
    }
}
