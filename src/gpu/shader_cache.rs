//! Caches of a device's shaders and pipelines: renderers that use the same text share a shader, and texts that
//! specialize to the same module share its pipeline.

use std::{
    fmt::{self, Write as _},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use xxhash_rust::xxh3::Xxh3;

use super::{
    error::GpuError, reflect::ShaderModuleInfo, shader::ShaderSource, used_textures::UsedTextures,
};

/// Maximum number of shaders and of parsed texts kept; a frame has at most 19. The least recently used is dropped, so
/// that a text that is being edited pushes out its own old versions.
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
    /// Textures of its own group.
    pub textures: Arc<UsedTextures>,
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

/// Changes of the shaders' texts after which what the older texts made is dropped, so that a change that is taken back
/// compiles nothing.
const KEPT_CHANGES: u64 = 2;

/// Cache of at most `MOST` values by key, the most recently used last.
#[derive(Debug)]
pub(super) struct Recent<K, V, const MOST: usize> {
    entries: Vec<Kept<K, V>>,
    /// Number of changes of the texts so far.
    changes: u64,
}

#[derive(Debug)]
struct Kept<K, V> {
    key: K,
    value: V,
    /// [`Recent::changes`] at the last use.
    used: u64,
}

impl<K, V, const MOST: usize> Default for Recent<K, V, MOST> {
    fn default() -> Self {
        Self {
            entries: Vec::new(),
            changes: 0,
        }
    }
}

impl<K: PartialEq, V: Clone, const MOST: usize> Recent<K, V, MOST> {
    fn find(&mut self, key: &K) -> Option<V> {
        let at = self.entries.iter().position(|kept| kept.key == *key)?;
        let mut found = self.entries.remove(at);
        found.used = self.changes;
        let value = found.value.clone();
        self.entries.push(found);
        Some(value)
    }

    fn insert(&mut self, key: K, value: V) {
        if self.entries.len() >= MOST {
            self.entries.remove(0);
        }
        let used = self.changes;
        self.entries.push(Kept { key, value, used });
    }

    /// Drops entries that are not in use and were last used before the texts changed [`KEPT_CHANGES`] times.
    fn texts_changed(&mut self, is_in_use: impl Fn(&V) -> bool) {
        self.changes += 1;
        let oldest = self.changes.saturating_sub(KEPT_CHANGES);
        self.entries
            .retain(|kept| kept.used >= oldest || is_in_use(&kept.value));
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

/// Caches of a device: parsed texts, shaders by text and values of flags, and pipelines by their ingredients.
#[derive(Debug, Default)]
pub(super) struct ShaderCache {
    modules: Mutex<Recent<ShaderSource, Arc<naga::Module>, SHADERS>>,
    shaders: Mutex<Recent<Key, Shader, SHADERS>>,
    pub computes: Mutex<Recent<PipelineKey, Arc<wgpu::ComputePipeline>, COMPUTES>>,
    pub renders: Mutex<Recent<PipelineKey, Arc<wgpu::RenderPipeline>, RENDERS>>,
}

#[derive(Debug, PartialEq, Eq)]
struct Key {
    /// Text with its files and line numbers, which pipeline errors name.
    source: ShaderSource,
    checks: Checks,
    /// Values of boolean overrides.
    given: Vec<(String, bool)>,
}

impl ShaderCache {
    /// The module of this text, made by `parse` where it is not cached.
    ///
    /// # Errors
    /// The error of `parse`.
    pub fn parsed(
        &self,
        source: &ShaderSource,
        parse: impl FnOnce(&ShaderSource) -> Result<naga::Module, GpuError>,
    ) -> Result<Arc<naga::Module>, GpuError> {
        get_or_make(&self.modules, source.clone(), |source| {
            parse(source).map(Arc::new)
        })
    }

    /// The shader of this text and these values of its boolean overrides, made by `make` where it is not cached.
    ///
    /// # Errors
    /// The error of `make`.
    pub fn get_or_make(
        &self,
        source: ShaderSource,
        checks: Checks,
        given: Vec<(String, bool)>,
        make: impl FnOnce(&ShaderSource) -> Result<Shader, GpuError>,
    ) -> Result<Shader, GpuError> {
        let key = Key {
            source,
            checks,
            given,
        };
        get_or_make(&self.shaders, key, |key| make(&key.source))
    }

    /// Drops shaders and pipelines of older texts, of which nothing is in use any more.
    pub fn texts_changed(&self) {
        let is_in_use = |shader: &Shader| Arc::strong_count(&shader.module) > 1;
        locked(&self.modules).texts_changed(|_| false);
        locked(&self.shaders).texts_changed(is_in_use);
        locked(&self.computes).texts_changed(|pipeline| Arc::strong_count(pipeline) > 1);
        locked(&self.renders).texts_changed(|pipeline| Arc::strong_count(pipeline) > 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_older_texts_made_is_dropped_unless_it_is_in_use() {
        let mut cache = Recent::<u32, Arc<u32>, 8>::default();
        let held = Arc::new(0);
        cache.insert(0, held.clone());
        for text in 1..=5 {
            cache.insert(text, Arc::new(text));
            cache.texts_changed(|value| Arc::strong_count(value) > 1);
        }
        let kept: Vec<_> = cache.entries.iter().map(|kept| kept.key).collect();
        assert_eq!(kept, [0, 4, 5]);
        // A text that comes back counts as new.
        assert!(cache.find(&4).is_some());
        cache.texts_changed(|_| false);
        let kept: Vec<_> = cache.entries.iter().map(|kept| kept.key).collect();
        assert_eq!(kept, [5, 4]);
        drop(held);
    }

    #[test]
    fn the_least_recently_used_is_dropped_where_all_are_needed() {
        let mut cache = Recent::<u32, u32, 2>::default();
        cache.insert(1, 1);
        cache.insert(2, 2);
        assert_eq!(cache.find(&1), Some(1));
        cache.insert(3, 3);
        assert_eq!(
            [1, 2, 3].map(|key| cache.find(&key)),
            [Some(1), None, Some(3)]
        );
    }
}
