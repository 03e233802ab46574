//! Writes memory.x for the linker, from mps2.x, and tells the compiler which model to put into the board's memory: the
//! file that the environment variable CAPSULE_MODEL names, or the shipped one.

use std::env;
use std::path::PathBuf;

/// Where code, RAM and external memory of the boards start; those of the first stand in mps2.x.
const BOARDS: [(&str, [&str; 3]); 3] = [
    ("AN386", ["0x00000000", "0x20000000", "0x21000000"]),
    ("AN500", ["0x00000000", "0x20000000", "0x60000000"]),
    ("AN505", ["0x10000000", "0x38000000", "0x80000000"]),
];

fn main() {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    // The board is the first one, or that which CAPSULE_BOARD names.
    println!("cargo:rerun-if-changed=mps2.x");
    println!("cargo:rerun-if-env-changed=CAPSULE_BOARD");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    // Not named memory.x itself: the linker would find that one first.
    let mut memory = std::fs::read_to_string(here.join("mps2.x")).expect("mps2.x");
    let board = env::var("CAPSULE_BOARD").unwrap_or_else(|_| BOARDS[0].0.to_owned());
    let Some((_, starts)) = BOARDS.iter().find(|(name, _)| *name == board) else {
        panic!("CAPSULE_BOARD is {board}, it must be AN386, AN500 or AN505");
    };
    for (first, start) in BOARDS[0].1.iter().zip(starts) {
        memory = memory.replace(first, start);
    }
    std::fs::write(out.join("memory.x"), memory).expect("a file can be written");
    println!("cargo:rustc-link-search={}", out.display());

    println!("cargo:rerun-if-env-changed=CAPSULE_MODEL");
    let model = env::var_os("CAPSULE_MODEL").map_or_else(|| here.join("../../models/capsule.crom"), PathBuf::from);
    assert!(
        model.is_file(),
        "no model at {}: name one in the environment variable CAPSULE_MODEL",
        model.display()
    );
    println!("cargo:rerun-if-changed={}", model.display());
    println!("cargo:rustc-env=CAPSULE_MODEL={}", model.display());
}
