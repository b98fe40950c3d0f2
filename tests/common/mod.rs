//! Shared helpers of integration tests.

#![allow(dead_code, unused_macros, reason = "not every test uses every helper")]

pub mod animated;
pub mod folder;
pub mod program;
pub mod readme;

use std::path::{Path, PathBuf};

use reflet::{
    gpu::{Gpu, GpuError, GpuOptions, ShaderLibrary},
    render::{passes, pipeline::shader_variant::ShaderVariant},
};

/// The GPU, or `None` after printing `SKIPPED` without an adapter.
///
/// # Panics
/// Without an adapter when `REFLET_REQUIRE_GPU=1`, and when an adapter exists but fails.
pub fn gpu_or_skip() -> Option<Gpu> {
    required_or_skip(Gpu::new(&GpuOptions::default()))
}

/// The value, or the end of the test where there is none, which has been told by then.
macro_rules! or_skip {
    ($value:expr $(,)?) => {
        match $value {
            Some(value) => value,
            None => return,
        }
    };
}

/// The value of a result, or a panic with the message of its error.
macro_rules! or_panic {
    ($result:expr $(,)?) => {
        $result.unwrap_or_else(|error| panic!("{error}"))
    };
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

/// The shaders under test: built-in, or from the folder that `REFLET_TEST_SHADERS` names, in which `tools/mutants.py`
/// injects faults without a rebuild.
pub fn shaders() -> ShaderLibrary {
    let library = std::env::var_os("REFLET_TEST_SHADERS").map_or_else(
        || Ok(ShaderLibrary::embedded()),
        |folder| ShaderLibrary::from_dir(Path::new(&folder)),
    );
    let library =
        library.and_then(|library| ShaderVariant::default().library(&library, &passes::ALL));
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

    /// A number from 0 to less than 1.
    pub fn unit(&mut self) -> f64 {
        self.below(1 << 53) as f64 / (1_u64 << 53) as f64
    }
}

/// Asserts that a text contains each of these parts.
#[track_caller]
pub fn assert_says(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
}

/// Arguments of a command line, none of which has a space.
pub fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

/// Whether tests that take some of their cases daily take all cases: `REFLET_LONG=1`, which `tools/check.sh --full` sets.
pub fn is_long() -> bool {
    std::env::var_os("REFLET_LONG").is_some_and(|value| value != "0")
}

/// The first `count` cases of a list; all cases where [`is_long`] says so.
pub fn first_or_all<T>(cases: &[T], count: usize) -> &[T] {
    &cases[..if is_long() { cases.len() } else { count }]
}

/// Every `step`-th case; all cases where [`is_long`] says so.
pub fn sampled<T>(cases: Vec<T>, step: usize) -> Vec<T> {
    let step = if is_long() { 1 } else { step };
    cases.into_iter().step_by(step).collect()
}

/// Cases of a text, each one or more lines and then `=> ` with the consequence. Lines that begin with `//` before a
/// case are comments.
pub fn cases(text: &'static str) -> Vec<(&'static str, &'static str)> {
    let (mut cases, mut rest) = (Vec::new(), text);
    while let Some((mut case, after)) = rest.split_once("\n=> ") {
        while let Some((_, body)) = case.split_once('\n').filter(|_| case.starts_with("//")) {
            case = body;
        }
        let (follows, next) = after.split_once('\n').unwrap_or((after, ""));
        cases.push((case, follows));
        rest = next;
    }
    assert!(rest.is_empty() && !cases.is_empty(), "no case: {rest:?}");
    cases
}
