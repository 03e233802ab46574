//! Writes memory.x for the linker, from mps2.x, and tells the compiler which model to put into the board's memory: the file
//! that the environment variable CAPSULE_MODEL names, or the shipped one.

use std::env;
use std::path::PathBuf;

/// Where the external memory of AN386 starts.
const AN386: &str = "0x21000000";

fn main() {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    // Where the external memory starts: CAPSULE_EXTERNAL for another board than AN386.
    println!("cargo:rerun-if-changed=mps2.x");
    println!("cargo:rerun-if-env-changed=CAPSULE_EXTERNAL");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    // Not named memory.x itself: the linker would find that one first.
    let memory = std::fs::read_to_string(here.join("mps2.x")).expect("mps2.x");
    let external = env::var("CAPSULE_EXTERNAL").unwrap_or_else(|_| AN386.to_owned());
    std::fs::write(out.join("memory.x"), memory.replace(AN386, &external)).expect("a file can be written");
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
