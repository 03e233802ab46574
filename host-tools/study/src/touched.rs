//! The parts of a model file on which an answer depends, found from outside the core by overwriting the others.

use capsule_core::{EvaluateError, Method, Model};

use crate::StudyError;
use crate::task::{Asker, Question, Task, What};

/// Bytes of the header, which has no numbers.
const HEADER: usize = 16;

/// Spoils every byte of a block and leaves the CRC-32 of the whole as it is, so that the file still opens and prepared
/// parameters still belong to it: the generator polynomial (x^32 + ... + 1, 33 bits, the lowest of a byte first), added
/// at each byte where it fits.
fn spoil(block: &mut [u8]) {
    const GENERATOR: [u8; 5] = [0x41, 0x06, 0x71, 0xdb, 0x01];
    for start in 0..(block.len() + 1).saturating_sub(GENERATOR.len()) {
        for (byte, term) in block.iter_mut().skip(start).zip(GENERATOR) {
            *byte ^= term;
        }
    }
}

/// An answer's bits, or why there is none.
type Answer = Result<Vec<u64>, EvaluateError>;

/// The blocks of so many bytes, at least 5, of a file on which the answer to a task depends; what was prepared before
/// was prepared with the whole file. Blocks whose spoiling makes the file invalid (dimensions, indices, instants,
/// singles, which become too large) are not among them.
///
/// # Errors
/// A file that cannot be opened.
pub fn touched(file: &[u8], block: usize, task: &Task, question: &Question) -> Result<Vec<usize>, StudyError> {
    let whole = Model::open(file)?;
    let mut ready = Asker::<f32>::new(&whole, Method::Direct)?;
    ready.before(&whole, task, question)?;
    let ask = |model: &Model<'_>| -> Answer {
        let mut asker = ready.clone();
        asker.answer(model, task, question)?;
        let mut what = task.what;
        if what == What::Nothing {
            // The prepared state is compared by the answer that the whole file gives with it.
            what = What::Surface;
            asker.answer(
                &whole,
                &Task {
                    new: false,
                    what,
                    ..*task
                },
                question,
            )?;
        }
        Ok(asker.numbers(what).into_iter().map(f64::to_bits).collect())
    };
    let expected = ask(&whole);
    let mut spoilt = file.to_vec();
    let mut found = Vec::new();
    let mut ranges = vec![(HEADER.div_ceil(block), file.len().div_ceil(block))];
    while let Some((from, to)) = ranges.pop() {
        let blocks = |file: &mut [u8]| {
            file.chunks_mut(block).take(to).skip(from).for_each(spoil);
        };
        blocks(&mut spoilt);
        // None: the file is invalid.
        let same = Model::open(&spoilt).ok().map(|model| ask(&model) == expected);
        blocks(&mut spoilt);
        match same {
            Some(true) => {}
            Some(false) if to - from == 1 => found.push(from),
            None if to - from == 1 => {}
            _ => {
                let middle = usize::midpoint(from, to);
                ranges.extend([(from, middle), (middle, to)]);
            }
        }
    }
    found.sort_unstable();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spoilt_block_has_no_byte_left_and_the_same_checksum() {
        let checksum = |bytes: &[u8]| {
            let mut sum = u32::MAX;
            for byte in bytes {
                sum ^= u32::from(*byte);
                for _ in 0..8 {
                    sum = if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 };
                }
            }
            !sum
        };
        for length in [5, 17, 256] {
            let block: Vec<u8> = (0..length).map(|i| (37 * i + 5) as u8).collect();
            let mut after = block.clone();
            spoil(&mut after);
            assert_eq!(checksum(&after), checksum(&block));
            assert!(after.iter().zip(&block).all(|(a, b)| a != b), "{length}");
            spoil(&mut after);
            assert_eq!(after, block);
        }
    }
}
