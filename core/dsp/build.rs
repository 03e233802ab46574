//! Finds out whether the target has the instructions of an ARM core that the crate uses. Stable Rust does not tell, so
//! the assembler is asked, with the target and the flags that the crate is built with.

use std::env;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// A feature of the target: its name, and an instruction that needs it.
const INSTRUCTIONS: [(&str, &str); 2] = [("smlad", "smlad r0, r1, r2, r3"), ("vsqrt", "vsqrt.f32 s0, s0")];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=RUSTFLAGS");
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    let arm = env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "arm");
    for (name, instruction) in INSTRUCTIONS {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if arm && assembles(instruction) {
            println!("cargo::rustc-cfg={name}");
        }
    }
}

/// Whether the target's assembler knows an instruction.
fn assembles(instruction: &str) -> bool {
    let variable = |name: &str| env::var(name).unwrap_or_else(|_| panic!("cargo sets {name}"));
    let flags = variable("CARGO_ENCODED_RUSTFLAGS");
    let object = Path::new(&variable("OUT_DIR")).join("instruction.o");
    let mut compiler = Command::new(variable("RUSTC"))
        .args([
            "--crate-name=instruction",
            "--crate-type=lib",
            "--edition=2024",
            "--emit=obj",
            "-o",
        ])
        .arg(object)
        .args(["--target", &variable("TARGET")])
        .args(flags.split('\x1f').filter(|flag| !flag.is_empty()))
        .arg("-")
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the compiler starts");
    let program = format!("#![no_std]\ncore::arch::global_asm!(\"{instruction}\");\n");
    let mut input = compiler.stdin.take().expect("it reads the program");
    input.write_all(program.as_bytes()).expect("it reads the program");
    drop(input);
    compiler.wait().expect("the compiler ends").success()
}
