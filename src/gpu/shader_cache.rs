//! Caches of a device's shaders and pipelines: renderers that use the same text share a shader, and texts that
//! specialize to the same module share its pipeline.

use std::{
    fmt::{self, Write as _},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use xxhash_rust::xxh3::Xxh3;

use super::{error::GpuError, reflect::ShaderModuleInfo, shader::ShaderSource};

/// Maximum number of shaders kept; a frame has at most 19. The least recently used is dropped, so that a text that
/// is being edited pushes out its own old versions.
const SHADERS: usize = 64;

/// Maximum number of compute pipelines kept, of which a frame has up to 20: software drivers hold several MB of code
/// for each.
const COMPUTES: usize = 192;

/// Maximum number of render pipelines kept: a frame has up to 24 per shader, for cut-out, double-sided and mirrored
/// instances, shown, culled and seen only in reflections; their code is small.
const RENDERS: usize = 96;

/// Maximum number of pipelines whose keys are known per shader.
const KEYS: usize = 48;

/// Run-time checks of a shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Checks {
    /// Bounds checks and loop bounding.
    All,
    /// No bounds checks and no loop bounding, but only for text that was built into this
    /// program; for anything else this is [`Checks::All`]. The caller must have validated every
    /// index that the shader reads from buffers: no public function takes this.
    TrustedBuiltin,
}

/// A validated shader, and the keys of its pipelines.
#[derive(Clone, Debug)]
pub struct Shader {
    /// Reflection of the module.
    pub info: ShaderModuleInfo,
    pub(super) module: Arc<(naga::Module, naga::valid::ModuleInfo)>,
    /// Whether the text was built into this program, and the caller validates all indices that the shader reads.
    pub(super) trusted: bool,
    /// Pipeline keys by entry point, state, constants and bindings, which spare specializing the module again.
    pub(super) keys: Arc<Mutex<Recent<String, PipelineKey, KEYS>>>,
}

/// Hash of everything that makes a pipeline: the specialized module, its run-time checks, bindings and fixed-function
/// state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PipelineKey(u64);

impl PipelineKey {
    /// The key of a module without overrides, with `state` for the rest.
    pub fn new(module: &naga::Module, state: &str) -> Self {
        struct Text(Xxh3);
        impl fmt::Write for Text {
            fn write_str(&mut self, text: &str) -> fmt::Result {
                self.0.update(text.as_bytes());
                Ok(())
            }
        }
        let mut text = Text(Xxh3::new());
        // Hashing cannot fail, and naga's types have no other form than their debug text that covers all of them.
        let _ = write!(text, "{module:?} {state}");
        Self(text.0.digest())
    }
}

/// Cache of at most `MOST` values by key, the most recently used last.
#[derive(Debug)]
pub(super) struct Recent<K, V, const MOST: usize>(Vec<(K, V)>);

impl<K, V, const MOST: usize> Default for Recent<K, V, MOST> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<K: PartialEq, V: Clone, const MOST: usize> Recent<K, V, MOST> {
    fn find(&mut self, key: &K) -> Option<V> {
        let at = self.0.iter().position(|(other, _)| other == key)?;
        let found = self.0.remove(at);
        let value = found.1.clone();
        self.0.push(found);
        Some(value)
    }

    fn insert(&mut self, key: K, value: V) {
        if self.0.len() >= MOST {
            self.0.remove(0);
        }
        self.0.push((key, value));
    }
}

/// The cached value of this key.
pub(super) fn find<K: PartialEq, V: Clone, const MOST: usize>(
    cache: &Mutex<Recent<K, V, MOST>>,
    key: &K,
) -> Option<V> {
    locked(cache).find(key)
}

/// The cached value of this key, or a new one from `make`. The cache is not locked while `make` runs; two threads
/// that make the same key insert it twice, until the cache drops one.
///
/// # Errors
/// The error of `make`.
pub(super) fn get_or_make<K: PartialEq, V: Clone, const MOST: usize>(
    cache: &Mutex<Recent<K, V, MOST>>,
    key: K,
    make: impl FnOnce(&K) -> Result<V, GpuError>,
) -> Result<V, GpuError> {
    if let Some(value) = find(cache, &key) {
        return Ok(value);
    }
    let value = make(&key)?;
    locked(cache).insert(key, value.clone());
    Ok(value)
}

fn locked<T>(cache: &Mutex<T>) -> MutexGuard<'_, T> {
    cache.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Caches of a device: shaders by text, and pipelines by what makes them.
#[derive(Debug, Default)]
pub(super) struct ShaderCache {
    shaders: Mutex<Recent<Key, Shader, SHADERS>>,
    pub computes: Mutex<Recent<PipelineKey, wgpu::ComputePipeline, COMPUTES>>,
    pub renders: Mutex<Recent<PipelineKey, wgpu::RenderPipeline, RENDERS>>,
}

#[derive(Debug, PartialEq, Eq)]
struct Key {
    /// Text with its files and line numbers, which pipeline errors name.
    source: ShaderSource,
    checks: Checks,
}

impl ShaderCache {
    /// The shader of this text, made by `make` where it is not cached.
    ///
    /// # Errors
    /// The error of `make`.
    pub fn get_or_make(
        &self,
        source: ShaderSource,
        checks: Checks,
        make: impl FnOnce(&ShaderSource) -> Result<Shader, GpuError>,
    ) -> Result<Shader, GpuError> {
        let key = Key { source, checks };
        get_or_make(&self.shaders, key, |key| make(&key.source))
    }
}
