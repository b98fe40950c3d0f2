//! A loaded scene with its device and renderer, for one picture or many.

use std::sync::Arc;

use super::{open_shutter::OpenShutter, scene_text::LoadedScene};
use crate::{
    gpu::{Gpu, ShaderLibrary},
    render::{
        PendingPicture, Picture, PictureRequest, RenderError, RenderOptions, Renderer, aov::Aov,
        probe::PassCounts, unit_costs::UnitCosts,
    },
};

/// Everything that renders pictures of one scene.
pub struct SceneRenderer {
    /// The device, which the encoders of a film share.
    pub gpu: Arc<Gpu>,
    /// The scene, posed for the next picture.
    pub loaded: LoadedScene,
    renderer: Renderer,
    camera: usize,
    settings: RendererSettings,
}

/// What a renderer is to do beside the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RendererSettings {
    /// See [`RenderOptions::audit`].
    pub audit: bool,
    /// See [`RenderOptions::costs`].
    pub costs: Option<UnitCosts>,
}

/// Options of a scene, seen by one of its cameras.
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
    /// As [`Renderer::new`].
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

    /// Shows another scene, and builds anew only what differs.
    ///
    /// # Errors
    /// As [`Renderer::change`]; nothing has changed then.
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

    /// Shows the next pictures by another camera; what is `auto` stays decided.
    pub fn set_camera(&mut self, camera: usize) {
        self.camera = camera;
    }

    /// Settings without `auto`.
    pub fn options(&self) -> &RenderOptions {
        self.renderer.options()
    }

    /// Renders the posed scene.
    ///
    /// # Errors
    /// As [`Renderer::render`].
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

    /// Starts a picture of the posed scene.
    ///
    /// # Errors
    /// As [`Renderer::begin_picture`].
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
    /// As [`Renderer::counts`].
    pub fn counts(&mut self) -> Result<Vec<PassCounts>, RenderError> {
        let world = &self.loaded.world;
        let camera = &world.cameras[self.camera].value;
        self.renderer.counts(&self.gpu, world, camera)
    }
}
