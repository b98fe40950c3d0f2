//! The last stage: a world becomes a renderer. Nothing else in the program builds one.

use std::ops::{Deref, DerefMut};

use crate::{Poses, RebuildSummary, RenderError, RenderOptions, Renderer};
use reflet_gpu::{Gpu, ShaderLibrary};

/// A renderer with the options that it was asked for.
///
/// Whatever they leave to `auto` is decided for [`Poses::first`] as [`RenderOptions::camera`] shows it at
/// the size of `image`, and stays until the next [`RendererStage::show`].
#[derive(Debug)]
pub struct RendererStage {
    renderer: Renderer,
    asked: RenderOptions,
}

impl RendererStage {
    /// Builds a renderer for the first time.
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`].
    pub fn new<'a>(
        gpu: &Gpu,
        library: &ShaderLibrary,
        poses: impl Into<Poses<'a>>,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        Ok(Self {
            renderer: Renderer::new(gpu, library, poses, options)?,
            asked: *options,
        })
    }

    /// Shows another world, other options or shaders: makes again what differs.
    ///
    /// # Errors
    /// Same errors as [`Renderer::change`]; the renderer is then as before.
    pub fn show<'a>(
        &mut self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        poses: impl Into<Poses<'a>>,
        options: &RenderOptions,
    ) -> Result<RebuildSummary, RenderError> {
        let rebuilt = self.renderer.change(gpu, library, poses, options)?;
        self.asked = *options;
        Ok(rebuilt)
    }

    /// Options that it was asked for; [`Renderer::options`] are the same without `auto`.
    pub fn asked(&self) -> &RenderOptions {
        &self.asked
    }
}

impl Deref for RendererStage {
    type Target = Renderer;

    fn deref(&self) -> &Renderer {
        &self.renderer
    }
}

impl DerefMut for RendererStage {
    fn deref_mut(&mut self) -> &mut Renderer {
        &mut self.renderer
    }
}
