#![no_main]

use etendue_fuzz::checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::exr(bytes));
