//! Queries of any numbers.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| capsule_fuzz::query(bytes));
