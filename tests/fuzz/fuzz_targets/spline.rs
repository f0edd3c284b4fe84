//! Any text, as the file of a curve: it is read, or refused in a sentence that names the file.
#![no_main]

use imu_tools::spline::file::read;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // A refusal names the file.
    if let Err(error) = read("curve", bytes) {
        assert!(error.to_string().starts_with("curve"), "{error}");
    }
});
