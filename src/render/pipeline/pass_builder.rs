//! Creates pipelines and bind groups of passes.

use reflet_gpu::{Gpu, GpuError, Named, Shader};

use super::{
    pass::{ComputePass, Override, Pass},
    resources::Resources,
    shaders::Shaders,
    shared_groups::SharedGroups,
    targets::Target,
};
use crate::{maps::method_maps::MethodMaps, plan::Plan, settings::options::RenderOptions};

/// Context for building passes.
pub struct PassBuilder<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Plan of the frame.
    pub plan: &'a Plan,
    /// Render options.
    pub options: &'a RenderOptions,
    /// Shaders of the needed passes.
    pub shaders: &'a Shaders,
    /// Bind groups 0 and 1.
    pub shared: &'a SharedGroups,
    /// Resources to bind.
    pub resources: Resources<'a>,
}

impl PassBuilder<'_> {
    /// Whether the frame records a pass.
    pub fn needs(&self, pass: &Pass) -> bool {
        (pass.needed)(self.plan, self.options)
    }

    /// The shader of a pass.
    ///
    /// # Errors
    /// Same errors as [`Shaders::get`].
    pub fn shader(&self, pass: &Pass) -> Result<&Shader, GpuError> {
        self.shaders.get(pass)
    }

    /// Values for the overrides of a pass on this device; its shader may declare fewer.
    pub fn overrides(&self, pass: &Pass) -> Vec<Override> {
        // Four shuffles put rows that are 16 apart beside each other, which suits 16 threads.
        let shuffles = if self.gpu.is_software() { 4.0 } else { 0.0 };
        let mut all = pass.constants(self.plan, self.options);
        all.push(("ROW_SHUFFLES", shuffles));
        all
    }

    /// Builds a compute pass; `aliases` give targets other names in its shader.
    ///
    /// # Errors
    /// A shader or wgpu error, by file and name.
    pub fn compute(
        &self,
        pass: &'static Pass,
        aliases: &[(&str, Target)],
    ) -> Result<ComputePass, GpuError> {
        let shader = self.shader(pass)?;
        self.bound(pass, shader, "main", &self.overrides(pass), aliases, &[])
    }

    /// Builds a compute pass named `pass` of the shader of `original`, with another value of one override and further
    /// bindings.
    ///
    /// # Errors
    /// Same errors as [`PassBuilder::compute`].
    pub fn variant(
        &self,
        pass: &'static Pass,
        original: &Pass,
        other: Override,
        extra: &[Named<'_>],
    ) -> Result<ComputePass, GpuError> {
        let mut overrides = self.overrides(original);
        overrides.retain(|(name, _)| *name != other.0);
        overrides.push(other);
        let shader = self.shaders.variant(self.gpu, original, &overrides)?;
        self.bound(pass, &shader, "main", &overrides, &pass.swapped(0), extra)
    }

    /// Builds a compute pass that starts at `entry` of its shader, with further bindings.
    ///
    /// # Errors
    /// Same errors as [`PassBuilder::compute`].
    pub fn with_resources(
        &self,
        pass: &'static Pass,
        entry: &str,
        extra: &[Named<'_>],
    ) -> Result<ComputePass, GpuError> {
        let shader = self.shader(pass)?;
        self.bound(pass, shader, entry, &self.overrides(pass), &[], extra)
    }

    /// The maps of the frame's method.
    ///
    /// # Errors
    /// [`GpuError::Binding`] in a frame of another method.
    pub fn maps<M: MethodMaps>(&self) -> Result<&M, GpuError> {
        let missing = || GpuError::Binding("maps of another method were planned".to_owned());
        self.resources.maps().ok_or_else(missing)
    }

    fn bound(
        &self,
        pass: &'static Pass,
        shader: &Shader,
        entry: &str,
        overrides: &[Override],
        aliases: &[(&str, Target)],
        extra: &[Named<'_>],
    ) -> Result<ComputePass, GpuError> {
        let mut built = ComputePass::new(self.gpu, pass, shader, entry, self.shared, overrides)?;
        let mut named = self.resources.ray_list.named().to_vec();
        named.extend(self.resources.captured.iter().flat_map(|maps| maps.named()));
        named.extend_from_slice(extra);
        built.bind(self.gpu, self.resources.targets, aliases, &named)?;
        Ok(built)
    }
}
