//! Reads any bytes as a panorama.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use reflet_base::memory::Budget;
use reflet_world::environment::{PanoramaLimits, read};

fuzz_target!(|bytes: &[u8]| {
    // The reader gets 512 MiB of the fuzzer's 1.5 GB limit.
    let limits = PanoramaLimits {
        max_px: 4096,
        budget_bytes: 256 << 20,
        memory: Budget::new(512 << 20),
    };
    if let Err(fault) = read(Path::new("sky.exr"), bytes, None, &limits) {
        assert_ne!(fault.name, "internal", "{}", fault.message);
    }
});
