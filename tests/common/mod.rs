//! What several integration tests share.

#![allow(dead_code, reason = "not every test uses every helper")]

use reflet::gpu::{Gpu, GpuError, GpuOptions};

/// The GPU, or `None` after saying `SKIPPED` where there is no adapter.
///
/// # Panics
/// Without an adapter when `REFLET_REQUIRE_GPU=1`, and when an adapter exists but fails.
pub fn gpu_or_skip() -> Option<Gpu> {
    let required = std::env::var("REFLET_REQUIRE_GPU").is_ok_and(|value| value == "1");
    match Gpu::new(&GpuOptions::default()) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter(why)) if !required => {
            eprintln!("SKIPPED: no adapter ({why})");
            None
        }
        Err(error) => panic!("{error}"),
    }
}
