//! Compilation targets beside this machine.

/// Browsers.
pub const WASM: &str = "wasm32-unknown-unknown";
/// Cortex-M4F; the library runs on a Cortex-M7 too.
pub const CORTEX_M: &str = "thumbv7em-none-eabihf";
/// Cortex-M33 with the DSP extension and the floating-point unit; the library runs on a Cortex-M35P, M55 and M85 too.
pub const CORTEX_M33: &str = "thumbv8m.main-none-eabihf";
