//! Says whether the target has the DSP instructions: `thumbv7em` is ARMv7E-M, whose E means them, and stable Rust does not
//! tell.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(armv7e_m)");
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv7em-")) {
        println!("cargo::rustc-cfg=armv7e_m");
    }
}
