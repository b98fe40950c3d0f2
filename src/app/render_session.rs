//! A loaded scene with its device and renderer, for one picture or many.

use std::{sync::Arc, time::SystemTime};

use super::{args::RenderArgs, error::AppError, scene::LoadedScene};
use crate::{
    gpu::{Gpu, GpuOptions, ShaderLibrary},
    render::{
        PendingPicture, Picture, PictureRequest, RenderError, RenderOptions, Renderer, aov::Aov,
        probe::PassCounts,
    },
};

/// Everything that renders pictures of one scene.
pub struct RenderSession {
    /// The device, which the encoders of a film share.
    pub gpu: Arc<Gpu>,
    /// The scene, posed for the next picture.
    pub loaded: LoadedScene,
    /// AOVs of every frame.
    pub aovs: Vec<Aov>,
    /// Time before the first of its files was opened.
    pub opened: SystemTime,
    /// Whether the shaders come from the user.
    pub own_shaders: bool,
    renderer: Renderer,
    camera: usize,
}

impl RenderSession {
    /// Opens the device, loads the scene and builds the renderer.
    ///
    /// # Errors
    /// No usable adapter, a scene past its limits, a shader error.
    pub fn new(
        args: &RenderArgs,
        loaded: LoadedScene,
        camera: usize,
        aovs: Vec<Aov>,
        library: &ShaderLibrary,
        opened: SystemTime,
    ) -> Result<Self, AppError> {
        let gpu = Gpu::new(&GpuOptions {
            adapter_filter: args.adapter.clone(),
        })?;
        let options = RenderOptions {
            camera: Some(camera),
            ..RenderOptions::of(&loaded.scene)
        };
        let own_shaders = args.shaders.is_some();
        let renderer = Renderer::new(&gpu, library, &loaded.first_frame(), &options)
            .map_err(|error| AppError::from_render(error, own_shaders))?;
        Ok(Self {
            gpu: Arc::new(gpu),
            loaded,
            aovs,
            opened,
            own_shaders,
            renderer,
            camera,
        })
    }

    /// Settings without `auto`.
    pub fn options(&self) -> &RenderOptions {
        self.renderer.options()
    }

    /// Renders the posed scene.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn picture(&mut self) -> Result<Picture, RenderError> {
        let world = &self.loaded.world;
        self.renderer.update(&self.gpu, world)?;
        let camera = &world.cameras[self.camera].value;
        self.renderer.picture(&self.gpu, world, camera, &self.aovs)
    }

    /// Starts a picture of the posed scene, with or without linear color.
    ///
    /// # Errors
    /// As [`Renderer::begin_picture`].
    pub fn begin(&mut self, color: bool) -> Result<PendingPicture, RenderError> {
        let world = &self.loaded.world;
        self.renderer.update(&self.gpu, world)?;
        let camera = &world.cameras[self.camera].value;
        let aovs = &self.aovs;
        self.renderer
            .begin_picture(&self.gpu, world, camera, PictureRequest { color, aovs })
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
