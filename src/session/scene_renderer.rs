//! A loaded scene with its device and renderer, to render one picture or many.

use std::sync::Arc;

use super::{open_shutter::OpenShutter, scene_text::LoadedScene};
use crate::{
    gpu::{Gpu, ShaderLibrary},
    render::{
        PendingPicture, Picture, PictureRequest, RenderError, RenderOptions, Renderer, aov::Aov,
        probe::PassCounts, unit_costs::UnitCosts,
    },
};

/// Everything needed to render pictures of one scene.
pub struct SceneRenderer {
    /// The device, shared with the video encoders.
    pub gpu: Arc<Gpu>,
    /// The scene, posed for the next picture.
    pub loaded: LoadedScene,
    renderer: Renderer,
    camera: usize,
    settings: RendererSettings,
}

/// Settings of a renderer that are not part of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RendererSettings {
    /// See [`RenderOptions::audit`].
    pub audit: bool,
    /// See [`RenderOptions::costs`].
    pub costs: Option<UnitCosts>,
}

/// Options to render a scene from one of its cameras.
fn options_of(loaded: &LoadedScene, camera: usize, settings: RendererSettings) -> RenderOptions {
    RenderOptions {
        camera: Some(camera),
        audit: settings.audit,
        costs: settings.costs,
        ..RenderOptions::of(&loaded.scene)
    }
}

impl SceneRenderer {
    /// Builds the renderer of a scene, with the shaders of `library`, for one of its cameras.
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`].
    pub fn new(
        gpu: Gpu,
        loaded: LoadedScene,
        camera: usize,
        settings: RendererSettings,
        library: &ShaderLibrary,
    ) -> Result<Self, RenderError> {
        let options = options_of(&loaded, camera, settings);
        let renderer = Renderer::new(&gpu, library, &loaded.first_frame(), &options)?;
        Ok(Self {
            gpu: Arc::new(gpu),
            loaded,
            renderer,
            camera,
            settings,
        })
    }

    /// Replaces the scene, and rebuilds only the parts that differ.
    ///
    /// # Errors
    /// Same errors as [`Renderer::change`]; nothing has changed then.
    pub fn change(
        &mut self,
        loaded: LoadedScene,
        camera: usize,
        library: &ShaderLibrary,
    ) -> Result<(), RenderError> {
        let options = options_of(&loaded, camera, self.settings);
        let world = loaded.first_frame();
        (self.renderer).change(&self.gpu, library, &world, &options)?;
        drop(world);
        (self.loaded, self.camera) = (loaded, camera);
        Ok(())
    }

    /// Renders the next pictures from another camera; values that were chosen for `auto` settings stay.
    pub fn set_camera(&mut self, camera: usize) {
        self.camera = camera;
    }

    /// Render options, with `auto` replaced by the chosen values.
    pub fn options(&self) -> &RenderOptions {
        self.renderer.options()
    }

    /// Renders the scene at its current pose.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`].
    pub fn picture(&mut self, aovs: &[Aov]) -> Result<Picture, RenderError> {
        if let Some(mut moments) = OpenShutter::of(&mut self.loaded) {
            let (gpu, camera) = (&self.gpu, self.camera);
            return (self.renderer).picture_of_moments(gpu, &mut moments, camera, aovs);
        }
        let world = &self.loaded.world;
        self.renderer.update(&self.gpu, world)?;
        let camera = &world.cameras[self.camera].value;
        self.renderer.picture(&self.gpu, world, camera, aovs)
    }

    /// Starts to render the scene at its current pose.
    ///
    /// # Errors
    /// Same errors as [`Renderer::begin_picture`].
    pub fn begin(&mut self, request: PictureRequest) -> Result<PendingPicture, RenderError> {
        if let Some(mut moments) = OpenShutter::of(&mut self.loaded) {
            let (gpu, camera) = (&self.gpu, self.camera);
            let renderer = &mut self.renderer;
            return renderer.begin_picture_of_moments(gpu, &mut moments, camera, request);
        }
        let world = &self.loaded.world;
        self.renderer.update(&self.gpu, world)?;
        let camera = &world.cameras[self.camera].value;
        self.renderer
            .begin_picture(&self.gpu, world, camera, request)
    }

    /// Renders a frame that counts the work of each pass.
    ///
    /// # Errors
    /// Same errors as [`Renderer::counts`].
    pub fn counts(&mut self) -> Result<Vec<PassCounts>, RenderError> {
        let world = &self.loaded.world;
        let camera = &world.cameras[self.camera].value;
        self.renderer.counts(&self.gpu, world, camera)
    }
}
