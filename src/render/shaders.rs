//! Validated shaders of the passes.

use std::collections::HashMap;

use crate::gpu::{Gpu, GpuError, Shader, ShaderLibrary, ShaderModuleInfo, shader::ShaderSource};

use super::{pass::Pass, shader_variant::ShaderVariant};

/// Validated shaders by pass name, each with its source text. Unused shaders stay cached with their
/// pipelines.
#[derive(Clone, Debug, Default)]
pub struct Shaders(HashMap<&'static str, (ShaderSource, Shader)>);

impl Shaders {
    /// Adds the needed shaders of `library`; shaders with unchanged text are reused.
    ///
    /// # Errors
    /// The first shader error, at the line in the author's file.
    pub fn updated(
        &self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        variant: ShaderVariant,
        needed: &[&'static Pass],
    ) -> Result<Self, GpuError> {
        let library = variant.library(library)?;
        let mut shaders = self.clone();
        for pass in needed {
            let source = library.source(pass.name)?;
            let is_same = |(old, _): &(ShaderSource, Shader)| {
                old.text == source.text && old.embedded == source.embedded
            };
            if shaders.0.get(pass.name).is_some_and(is_same) {
                continue;
            }
            let shader = Shader::from_source(gpu, &source, pass.checks)?;
            shaders.0.insert(pass.name, (source, shader));
        }
        Ok(shaders)
    }

    /// Whether these passes have the same shaders in both.
    pub fn are_same(&self, other: &Self, passes: &[&'static Pass]) -> bool {
        let text = |shaders: &Self, pass: &Pass| {
            let found = shaders.0.get(pass.name);
            found.map(|(source, _)| (source.text.clone(), source.embedded))
        };
        let same = |pass: &&'static Pass| text(self, pass) == text(other, pass);
        passes.iter().all(same)
    }

    /// Reflection of the shaders of these passes.
    ///
    /// # Errors
    /// As [`Shaders::get`].
    pub fn infos(&self, passes: &[&'static Pass]) -> Result<Vec<&ShaderModuleInfo>, GpuError> {
        let infos = passes.iter().map(|pass| Ok(&self.get(pass)?.info));
        infos.collect()
    }

    /// The shader of a pass.
    ///
    /// # Errors
    /// [`GpuError::Binding`] for a pass that the plan dropped.
    pub fn get(&self, pass: &Pass) -> Result<&Shader, GpuError> {
        let missing = || GpuError::Binding(format!("pass `{}` was not planned", pass.name));
        let found = self.0.get(pass.name);
        found.map(|(_, shader)| shader).ok_or_else(missing)
    }
}
