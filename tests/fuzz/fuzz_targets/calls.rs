//! Calls of the C interface.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| capsule_fuzz::calls(bytes));
