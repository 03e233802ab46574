//! Words separated by spaces, without an allocator; numbers as the hexadecimal digits of their bits.

use capsule_core::Real;
use core::str;

/// A scalar whose bits are written.
pub trait Word: Real {
    /// Hexadecimal digits of its bits.
    const DIGITS: usize;
    /// The bits.
    fn bits(self) -> u64;
    /// The number with these bits.
    fn from_bits(bits: u64) -> Self;
}

impl Word for f32 {
    const DIGITS: usize = 8;
    fn bits(self) -> u64 {
        self.to_bits().into()
    }
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
}

impl Word for f64 {
    const DIGITS: usize = 16;
    fn bits(self) -> u64 {
        self.to_bits()
    }
    fn from_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
}

/// A line of at most `N` characters; what does not fit is lost.
pub struct Text<const N: usize> {
    bytes: [u8; N],
    length: usize,
}

impl<const N: usize> Text<N> {
    /// Nothing.
    pub fn new() -> Self {
        Self {
            bytes: [0; N],
            length: 0,
        }
    }

    /// The text written so far.
    pub fn as_str(&self) -> &str {
        str::from_utf8(self.bytes.get(..self.length).unwrap_or_default()).unwrap_or_default()
    }

    /// Adds a word.
    pub fn word(&mut self, word: &str) {
        if self.length > 0 {
            self.push(b' ');
        }
        word.bytes().for_each(|byte| self.push(byte));
    }

    /// Adds the bits of a number.
    pub fn number<T: Word>(&mut self, number: T) {
        self.hexadecimal(number.bits(), T::DIGITS);
    }

    /// Adds a word of hexadecimal digits.
    pub fn hexadecimal(&mut self, bits: u64, digits: usize) {
        self.word("");
        for digit in (0..digits).rev() {
            let nibble = (bits >> (4 * digit)) as u8 & 15;
            self.push(if nibble < 10 { b'0' + nibble } else { b'a' + nibble - 10 });
        }
    }

    fn push(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self::new()
    }
}
