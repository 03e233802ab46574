//! Identifications on the emulated board against those of this machine, bit for bit. Run by its name alone, because it
//! needs the target (`rustup target add thumbv7em-none-eabihf`) and the emulator (`apt-get install qemu-system-arm`):
//! `cargo test -p capsule-identify --test firmware`.

#[path = "../../../tests/firmware/src/identifications.rs"]
mod identifications;

use capsule_core::Model;
use identifications::{Storage, TASKS};
use std::path::Path;
use std::process::Command;

#[test]
fn the_board_identifies_with_the_same_bits() {
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/firmware");
    // A target directory of its own: this test's cargo holds the lock of the other.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("firmware");
    let run = Command::new(env!("CARGO"))
        .args(["run", "--release", "--locked", "--bin", "identify"])
        .current_dir(&firmware)
        .env("CARGO_TARGET_DIR", target)
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        .output()
        .expect("cargo starts");
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{said}\n{}", String::from_utf8_lossy(&run.stderr));

    let file = std::fs::read(firmware.join("../../models/capsule.crom")).unwrap();
    let model = Model::open(&file).unwrap();
    let mut storage = Storage::new();
    let grid = storage.grid(&model).unwrap();
    storage.draw(&model).unwrap();
    for (name, task) in TASKS {
        let found = storage.identify(&model, &grid, task).unwrap();
        let [ca, confinement] = [found.capillary_number, found.confinement].map(|estimate| estimate.value.to_bits());
        let expected = format!("{name}_bits {ca:016x} {confinement:016x}");
        assert!(said.lines().any(|line| line == expected), "{expected}\n{said}");
    }
}
