//! Model files of any bytes.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| capsule_fuzz::model(bytes));
