//! Reading the message in place, field by field. serde would build each struct by value, on a larger stack than a
//! microcontroller has. The format is postcard's: integers above a byte in groups of seven bits, the lowest
//! first; bytes, texts and lists behind their length; enums by the number of the variant; floats as they are.

use super::wire::{
    Blob, Cluster, Contents, Encoding, Errors, Field, Kernel, Matrix, Mesh, Metadata, Method, NodeSet, Paper,
    Parameter, Reference, Samples, Span, Units, Widths,
};
use heapless::Vec;

/// A part of the message that is read in place.
pub(super) trait Decode<'a> {
    /// Reads it from the front of what is left.
    fn read(&mut self, from: &mut Reader<'a>);

    /// Visits its blobs in the order of the message.
    #[cfg(feature = "write")]
    fn for_each_blob(&mut self, _visit: &mut dyn FnMut(&mut Blob<'a>)) {}
}

/// A struct is its fields, in the order of the message. The compiler refuses a list that forgets one.
macro_rules! decode_fields {
    ($($part:ty { $($field:ident),+ })+) => { $(
        impl<'a> Decode<'a> for $part {
            fn read(&mut self, from: &mut Reader<'a>) {
                let Self { $($field),+ } = self;
                $($field.read(from);)+
            }

            #[cfg(feature = "write")]
            fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
                let Self { $($field),+ } = self;
                $($field.for_each_blob(visit);)+
            }
        }
    )+ };
}

decode_fields! {
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

/// The rest of a message. After bytes that do not decode it is empty and every value reads as 0, so that validity is
/// checked once, at the end.
pub(super) struct Reader<'a> {
    left: &'a [u8],
    is_valid: bool,
}

impl<'a> Reader<'a> {
    pub(super) fn new(message: &'a [u8]) -> Self {
        Self {
            left: message,
            is_valid: true,
        }
    }

    /// How many bytes are left, if all that was read did decode.
    pub(super) fn end(self) -> Option<usize> {
        self.is_valid.then_some(self.left.len())
    }

    fn fail(&mut self) {
        (self.left, self.is_valid) = (&[], false);
    }

    fn take(&mut self, count: usize) -> &'a [u8] {
        let Some((taken, left)) = self.left.split_at_checked(count) else {
            self.fail();
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
        self.fail();
        0
    }

    /// A length; one of more than 32 bits is refused on every target.
    fn length(&mut self) -> usize {
        self.integer(u32::BITS) as usize
    }

    #[inline(never)]
    fn bytes(&mut self) -> &'a [u8] {
        let length = self.length();
        self.take(length)
    }
}

impl<'a> Decode<'a> for u8 {
    fn read(&mut self, from: &mut Reader<'a>) {
        *self = from.byte();
    }
}

impl<'a> Decode<'a> for u16 {
    fn read(&mut self, from: &mut Reader<'a>) {
        *self = from.integer(Self::BITS) as Self;
    }
}

impl<'a> Decode<'a> for u32 {
    fn read(&mut self, from: &mut Reader<'a>) {
        *self = from.integer(Self::BITS);
    }
}

impl<'a> Decode<'a> for f64 {
    fn read(&mut self, from: &mut Reader<'a>) {
        *self = from
            .take(8)
            .first_chunk()
            .map_or(0.0, |bytes| Self::from_le_bytes(*bytes));
    }
}

impl<'a> Decode<'a> for Option<f64> {
    fn read(&mut self, from: &mut Reader<'a>) {
        *self = match from.byte() {
            0 => None,
            1 => {
                let mut value = 0.0;
                value.read(from);
                Some(value)
            }
            _ => return from.fail(),
        }
    }
}

impl<'a> Decode<'a> for &'a str {
    fn read(&mut self, from: &mut Reader<'a>) {
        match core::str::from_utf8(from.bytes()) {
            Ok(text) => *self = text,
            Err(_) => from.fail(),
        }
    }
}

impl<'a> Decode<'a> for Blob<'a> {
    fn read(&mut self, from: &mut Reader<'a>) {
        self.pad = from.bytes();
        self.data = from.bytes();
    }

    #[cfg(feature = "write")]
    fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
        visit(self);
    }
}

impl<'a> Decode<'a> for Method {
    fn read(&mut self, from: &mut Reader<'a>) {
        *self = match from.integer(32) {
            0 => Self::Direct,
            1 => Self::Paper,
            _ => return from.fail(),
        }
    }
}

impl<'a> Decode<'a> for Encoding {
    fn read(&mut self, from: &mut Reader<'a>) {
        *self = match from.integer(32) {
            0 => Self::F32,
            variant @ 1..=3 => {
                let mut wide_columns = 0;
                wide_columns.read(from);
                let widths = Widths { wide_columns };
                match variant {
                    1 => Self::Columns(widths),
                    2 => Self::ColumnPanels(widths),
                    _ => Self::RowPanels(widths),
                }
            }
            _ => return from.fail(),
        }
    }
}

impl<'a> Decode<'a> for Reference {
    fn read(&mut self, from: &mut Reader<'a>) {
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
            _ => return from.fail(),
        }
    }
}

impl<'a, P: Decode<'a>, const N: usize> Decode<'a> for [P; N] {
    fn read(&mut self, from: &mut Reader<'a>) {
        for part in self {
            part.read(from);
        }
    }

    #[cfg(feature = "write")]
    fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
        for part in self {
            part.for_each_blob(visit);
        }
    }
}

impl<'a, P: Decode<'a> + Default, const N: usize> Decode<'a> for Vec<P, N> {
    fn read(&mut self, from: &mut Reader<'a>) {
        for _ in 0..from.length() {
            // More than there is room for cannot be right.
            if self.push(P::default()).is_err() {
                return from.fail();
            }
            if let Some(part) = self.last_mut() {
                part.read(from);
            }
        }
    }

    #[cfg(feature = "write")]
    fn for_each_blob(&mut self, visit: &mut dyn FnMut(&mut Blob<'a>)) {
        for part in self {
            part.for_each_blob(visit);
        }
    }
}
