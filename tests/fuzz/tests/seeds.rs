//! The seeds of every target, and ten thousand inputs that differ from a seed in a few bytes. The inputs are the same
//! in every run, so that a failure can be repeated.

use std::fs;

/// Number of inputs derived from each target's seeds.
const MADE: usize = 10_000;

/// Pseudo-random numbers (xorshift, Marsaglia 2003).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound.max(1) as u64) as usize
    }
}

fn change(bytes: &mut Vec<u8>, numbers: &mut Numbers) {
    for _ in 0..=numbers.below(4) {
        let (place, byte) = (numbers.below(bytes.len()), numbers.below(256) as u8);
        match numbers.below(4) {
            0 => bytes.truncate(place),
            1 => bytes.push(byte),
            _ => {
                if let Some(found) = bytes.get_mut(place) {
                    *found = byte;
                }
            }
        }
    }
}

fn replay(target: &str, run: fn(&[u8])) {
    let folder = format!("{}/seeds/{target}", env!("CARGO_MANIFEST_DIR"));
    let mut paths: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let seeds: Vec<Vec<u8>> = paths.iter().map(|path| fs::read(path).unwrap()).collect();
    assert!(!seeds.is_empty());
    for (path, seed) in paths.iter().zip(&seeds) {
        println!("{}", path.display());
        run(seed);
    }
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    for _ in 0..MADE {
        let mut bytes = seeds[numbers.below(seeds.len())].clone();
        change(&mut bytes, &mut numbers);
        println!("{bytes:?}");
        run(&bytes);
    }
}

#[test]
fn models() {
    replay("model", capsule_fuzz::model);
}

#[test]
fn queries() {
    replay("query", capsule_fuzz::query);
}

#[test]
fn calls() {
    replay("calls", capsule_fuzz::calls);
}
