//! The kernel behind libFuzzer: `tests/fuzz/run` says how.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| isolux_fuzz::tables(data));
