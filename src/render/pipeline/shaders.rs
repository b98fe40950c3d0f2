//! Validated shaders of the passes.

use std::{collections::HashMap, sync::Arc};

use reflet_gpu::{Gpu, GpuError, Shader, ShaderLibrary, ShaderModuleInfo, shader::ShaderSource};

use super::{
    pass::{Override, Pass},
    pass_targets::PassTargets,
    shader_variant::ShaderVariant,
};

/// Validated shaders by pass name, each with its source text.
#[derive(Debug)]
pub struct Shaders(HashMap<&'static str, (ShaderSource, Shader)>);

impl Shaders {
    /// The needed shaders of `library`, each without branches that the values of its overrides rule out, from the
    /// device's cache where it has them.
    ///
    /// # Errors
    /// The first shader error, at the line in the shader's source file.
    pub fn new(
        gpu: &Gpu,
        library: &ShaderLibrary,
        variant: ShaderVariant,
        needed: &[&'static Pass],
        constants: impl Fn(&Pass) -> Vec<Override>,
    ) -> Result<Self, GpuError> {
        let library = variant.library(library, needed)?;
        let shaders = needed.iter().map(|pass| {
            let source = library.source(pass.shader())?;
            let shader = gpu.shader(source.clone(), pass.checks, &constants(pass))?;
            Ok((pass.name, (source, shader)))
        });
        shaders.collect::<Result<_, GpuError>>().map(Self)
    }

    /// Whether these passes have the same shaders in both collections.
    pub fn are_same(&self, other: &Self, passes: &[&'static Pass]) -> bool {
        let text = |shaders: &Self, pass: &Pass| {
            let found = shaders.0.get(pass.name);
            found.map(|(source, _)| (source.text.clone(), source.embedded))
        };
        let same = |pass: &&'static Pass| text(self, pass) == text(other, pass);
        passes.iter().all(same)
    }

    /// Source texts of the shaders of these passes; `None` of a pass that the plan dropped.
    pub fn texts(&self, passes: &[&'static Pass]) -> Vec<Option<Arc<str>>> {
        let text =
            |pass: &&'static Pass| self.0.get(pass.name).map(|(source, _)| source.text.clone());
        passes.iter().map(text).collect()
    }

    /// Reflection of the shaders of these passes.
    ///
    /// # Errors
    /// Same errors as [`Shaders::get`].
    pub fn infos(&self, passes: &[&'static Pass]) -> Result<Vec<&ShaderModuleInfo>, GpuError> {
        let infos = passes.iter().map(|pass| Ok(&self.get(pass)?.info));
        infos.collect()
    }

    /// The shader of a pass.
    ///
    /// # Errors
    /// [`GpuError::Binding`] for a pass that the plan dropped.
    pub fn get(&self, pass: &Pass) -> Result<&Shader, GpuError> {
        Ok(&self.found(pass)?.1)
    }

    /// The shader of a pass with other values of its overrides.
    ///
    /// # Errors
    /// Same errors as [`Shaders::get`] and [`Shaders::new`].
    pub fn variant(
        &self,
        gpu: &Gpu,
        pass: &Pass,
        constants: &[Override],
    ) -> Result<Shader, GpuError> {
        let (source, _) = self.found(pass)?;
        gpu.shader(source.clone(), pass.checks, constants)
    }

    /// Targets of a pass.
    ///
    /// # Errors
    /// Same errors as [`Shaders::get`].
    pub fn targets(&self, pass: &Pass) -> Result<PassTargets, GpuError> {
        Ok(PassTargets::new(pass, &self.get(pass)?.textures))
    }

    fn found(&self, pass: &Pass) -> Result<&(ShaderSource, Shader), GpuError> {
        let missing = || GpuError::Binding(format!("pass `{}` was not planned", pass.name));
        self.0.get(pass.name).ok_or_else(missing)
    }
}
