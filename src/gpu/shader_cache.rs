//! Cache of a device's shaders: renderers that use the same text share a shader and its pipelines.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{error::GpuError, reflect::ShaderModuleInfo, shader::ShaderSource};

/// Maximum number of shaders kept; a frame has at most 19. The least recently used is dropped, so that a text that
/// is being edited pushes out its own old versions.
const SHADERS: usize = 64;

/// Maximum number of compute pipelines kept per shader: software drivers hold several MB of code for each.
const COMPUTES: usize = 6;

/// Maximum number of render pipelines kept per shader: a frame has up to 24, for cut-out, double-sided and mirrored
/// instances, shown, culled and seen only in reflections; their code is small.
const RENDERS: usize = 48;

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

/// A validated shader, and the cache of its pipelines.
#[derive(Clone, Debug)]
pub struct Shader {
    /// Reflection of the module.
    pub info: ShaderModuleInfo,
    pub(super) module: Arc<(naga::Module, naga::valid::ModuleInfo)>,
    /// Whether the text was built into this program, and the caller validates all indices that the shader reads.
    pub(super) trusted: bool,
    pub(super) computes: PipelineCache<wgpu::ComputePipeline, COMPUTES>,
    pub(super) renders: PipelineCache<wgpu::RenderPipeline, RENDERS>,
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

/// Cache of pipelines by entry point and state, shared by clones of the shader.
pub(super) type PipelineCache<P, const MOST: usize> = Arc<Mutex<Recent<String, P, MOST>>>;

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
    let known = locked(cache).find(&key);
    if let Some(value) = known {
        return Ok(value);
    }
    let value = make(&key)?;
    locked(cache).insert(key, value.clone());
    Ok(value)
}

fn locked<T>(cache: &Mutex<T>) -> MutexGuard<'_, T> {
    cache.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Cache of shaders by text.
#[derive(Debug, Default)]
pub(super) struct ShaderCache(Mutex<Recent<Key, Shader, SHADERS>>);

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
        get_or_make(&self.0, key, |key| make(&key.source))
    }
}
