//! Tells the linker where memory.x is and the compiler which model to put into the board's memory: the file that the environment
//! variable CAPSULE_MODEL names, or the shipped one.

use std::env;
use std::path::PathBuf;

fn main() {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    println!("cargo:rustc-link-search={}", here.display());
    println!("cargo:rerun-if-changed=memory.x");

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
