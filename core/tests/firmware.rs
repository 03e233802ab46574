//! The firmware's answers under QEMU against this machine's, bit for bit. Run by its name alone, because it needs the
//! targets (`rustup target add thumbv7em-none-eabihf thumbv8m.main-none-eabihf`) and the emulator (`apt-get install
//! qemu-system-arm`): `cargo test -p capsule-rom-core --test firmware`.

#[path = "suite/common/mod.rs"]
mod common;
#[path = "../../tests/firmware/src/questions.rs"]
mod questions;

use capsule_core::{Model, Workspace};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

fn firmware() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/firmware")
}

/// Settings of a board beyond the firmware's own settings, which are those of a Cortex-M4F: arguments of cargo, and
/// variables of the environment.
type Board = (&'static [&'static str], &'static [(&'static str, &'static str)]);

const CORTEX_M4: Board = (&[], &[]);
const CORTEX_M7: Board = (
    &[],
    &[
        ("CAPSULE_BOARD", "AN500"),
        (
            "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUNNER",
            "qemu-system-arm -M mps2-an500 -cpu cortex-m7 -nographic -semihosting-config enable=on,target=native \
             -kernel",
        ),
    ],
);
const CORTEX_M33: Board = (
    &["--target", "thumbv8m.main-none-eabihf"],
    &[("CAPSULE_BOARD", "AN505")],
);

/// Builds a program of the firmware with a model in its flash, runs it and returns what it prints.
fn on_the_target(program: &str, model: &Path, (arguments, variables): Board) -> String {
    // A target directory of its own: this test's cargo holds the lock of the other.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("firmware");
    let output = Command::new(env!("CARGO"))
        .args(["run", "--release", "--locked", "--bin", program])
        .args(arguments)
        .envs(variables.iter().copied())
        .current_dir(firmware())
        .env("CAPSULE_MODEL", model)
        .env("CARGO_TARGET_DIR", target)
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        .output()
        .expect("cargo starts");
    assert!(
        output.status.success(),
        "the firmware failed:\n{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("the firmware prints ASCII")
}

/// The same on this machine.
fn on_this_machine(model: &Path) -> String {
    let bytes = std::fs::read(model).unwrap_or_else(|error| panic!("{}: {error}", model.display()));
    let model = Model::open(&bytes).unwrap();
    let mut workspace = Workspace::<f32>::new();
    let mut text = String::new();
    for i in 0..questions::COUNT {
        let mut emit = |value: f32| write!(text, "{:08x} ", value.to_bits()).unwrap();
        questions::answer(&model, &mut workspace, i, &mut emit).unwrap();
        text.push('\n');
    }
    text
}

fn agree(model: &Path) {
    let (target, here) = (
        on_the_target("capsule-firmware", model, CORTEX_M4),
        on_this_machine(model),
    );
    assert_eq!(target.lines().count(), questions::COUNT);
    for (question, (target, here)) in target.lines().zip(here.lines()).enumerate() {
        assert_eq!(
            target.trim(),
            here.trim(),
            "question {question}: the target's answer, and this machine's"
        );
    }
}

#[test]
fn a_small_model_gives_the_same_bits_on_the_target() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("family.crom");
    std::fs::write(&path, common::Family::new(3).file()).unwrap();
    agree(&path);
}

#[test]
fn the_shipped_model_gives_the_same_bits_on_the_target() {
    agree(&firmware().join("../../models/capsule.crom"));
}

#[test]
fn the_conformance_vectors_on_cortex_m4_m7_and_m33() {
    for board in [CORTEX_M4, CORTEX_M7, CORTEX_M33] {
        let said = on_the_target("conformance", &firmware().join("../../models/capsule.crom"), board);
        assert!(said.trim_end().ends_with("passed, 0 failed"), "{said}");
    }
}
