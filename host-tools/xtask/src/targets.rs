//! Compilation targets beside this machine, and the archives of the C interface.

/// Browsers.
pub const WASM: &str = "wasm32-unknown-unknown";
/// Cortex-M with the DSP extension and the floating-point unit.
pub const CORTEX_M: &str = "thumbv7em-none-eabihf";
/// The same with the security extension.
pub const CORTEX_M33: &str = "thumbv8m.main-none-eabihf";
/// Cortex-M with the DSP extension alone.
pub const CORTEX_M_SOFT: &str = "thumbv7em-none-eabi";

/// An archive of the C interface.
pub struct Archive {
    /// Its target.
    pub target: &'static str,
    /// The processor that it is compiled for, where it is not the least one of the target.
    pub cpu: Option<&'static str>,
    /// Where it runs.
    pub runs_on: &'static str,
}

/// All archives.
pub const ARCHIVES: [Archive; 6] = [
    Archive {
        target: "x86_64-unknown-linux-gnu",
        cpu: None,
        runs_on: "Linux on x86-64",
    },
    Archive {
        target: "aarch64-unknown-linux-gnu",
        cpu: None,
        runs_on: "Linux on 64-bit ARM",
    },
    Archive {
        target: CORTEX_M,
        cpu: Some("cortex-m4"),
        runs_on: "Cortex-M4F and M7",
    },
    Archive {
        target: CORTEX_M33,
        cpu: Some("cortex-m33"),
        runs_on: "Cortex-M33, M35P, M55 and M85 with DSP extension and FPU",
    },
    Archive {
        target: CORTEX_M_SOFT,
        cpu: None,
        runs_on: "Cortex-M4 and M7 without FPU, or with soft-float calls",
    },
    Archive {
        target: "riscv32imac-unknown-none-elf",
        cpu: None,
        runs_on: "RV32IMAC without FPU",
    },
];
