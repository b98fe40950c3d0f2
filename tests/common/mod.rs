//! Shared helpers of integration tests.

#![allow(dead_code, reason = "not every test uses every helper")]

pub mod animated;
pub mod readme;

use std::path::{Path, PathBuf};

use reflet::{
    gpu::{Gpu, GpuError, GpuOptions, ShaderLibrary},
    render::pipeline::shader_variant::ShaderVariant,
};

/// The GPU, or `None` after printing `SKIPPED` without an adapter.
///
/// # Panics
/// Without an adapter when `REFLET_REQUIRE_GPU=1`, and when an adapter exists but fails.
pub fn gpu_or_skip() -> Option<Gpu> {
    required_or_skip(Gpu::new(&GpuOptions::default()))
}

/// A value that needs an adapter, or `None` with the same exceptions as [`gpu_or_skip`].
pub fn required_or_skip<T>(made: Result<T, GpuError>) -> Option<T> {
    let required = std::env::var("REFLET_REQUIRE_GPU").is_ok_and(|value| value == "1");
    match made {
        Ok(made) => Some(made),
        Err(GpuError::NoAdapter(why)) if !required => {
            eprintln!("SKIPPED: no adapter ({why})");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Folder of files that are not part of the project: named by an environment variable, otherwise
/// beside the checkout. `None` after printing `SKIPPED` if it does not exist.
pub fn shared_folder(variable: &str, name: &str) -> Option<PathBuf> {
    let beside = || {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../shared")
            .join(name)
    };
    let folder = std::env::var_os(variable).map_or_else(beside, PathBuf::from);
    if !folder.is_dir() {
        eprintln!(
            "SKIPPED: there is no folder {} ({variable})",
            folder.display()
        );
        return None;
    }
    Some(folder)
}

/// The shaders under test: the built-in ones, or those of the folder that `REFLET_TEST_SHADERS`
/// names, in which `tools/mutants.py` injects faults without a rebuild.
pub fn shaders() -> ShaderLibrary {
    let library = std::env::var_os("REFLET_TEST_SHADERS").map_or_else(
        || Ok(ShaderLibrary::embedded()),
        |folder| ShaderLibrary::from_dir(Path::new(&folder)),
    );
    let library = library.and_then(|library| ShaderVariant::default().library(&library));
    library.unwrap_or_else(|error| panic!("{error}"))
}

/// Pseudo-random numbers from a seed, so that failures are reproducible (Marsaglia's xorshift64).
pub struct Random(pub u64);

impl Random {
    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n as u64) as usize
    }
}
