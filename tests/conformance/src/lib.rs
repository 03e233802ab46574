//! Queries with the bits of their answers, one a line of `vectors.txt`; docs/reference/conformance.md describes the
//! format.
//!
//! The same code asks on every target: the tests on this machine, the firmware on Cortex-M, Node and Chromium through
//! the functions that its module exports. It needs no allocator.
#![no_std]

mod answer;
mod line;
mod words;

#[cfg(target_arch = "wasm32")]
mod exports;

pub use answer::{Asker, Outcome};
pub use line::{Ask, Case, Precision};
pub use words::{Text, Word};

/// The longest line of the file.
pub const LONGEST_LINE: usize = 256;

/// Asks every case of a precision in a file of vectors; calls `differs` with each line that came out otherwise and what
/// came out. Returns how many were asked.
///
/// # Errors
/// The model does not open, the file is for another model, or a line cannot be read.
pub fn check(
    model: &[u8],
    vectors: &str,
    precision: Precision,
    asker: &mut Asker,
    mut differs: impl FnMut(&str, &str),
) -> Result<usize, &'static str> {
    let model = capsule_core::Model::open(model).map_err(|_| "the model does not open")?;
    let mut count = 0;
    for line in vectors.lines().filter(|line| !line.starts_with('#')) {
        if let Some(digest) = line.strip_prefix("model ") {
            if u32::from_str_radix(digest, 16) != Ok(model.digest()) {
                return Err("the vectors are for another model: `cargo xtask conformance --write`");
            }
            continue;
        }
        let case = Case::parse(line).ok_or("a line of the vectors cannot be read")?;
        if case.precision != precision {
            continue;
        }
        let mut text = Text::<LONGEST_LINE>::new();
        case.write(&mut text);
        asker.answer(&model, &case, &mut text);
        if text.as_str() != line {
            differs(line, text.as_str());
        }
        count += 1;
    }
    Ok(count)
}
