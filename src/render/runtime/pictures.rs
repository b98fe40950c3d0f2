//! Frames and pictures of the shown scene.

use std::sync::Arc;

use super::{
    RendererStage, Session,
    open_shutter::{self, OpenShutter},
};
use crate::{
    PendingPicture, Picture, PictureRequest, RebuildSummary, RenderError, SoFar,
    picture::aov::Aov,
    pipeline::instrument::PassCounts,
    renderer::frame::{Moments as _, Shot},
    renderer::stats::FrameStats,
};
use reflet_gpu::Gpu;
use reflet_scene::{
    desc::{CameraDesc, LightGroup},
    diagnostic::Diagnostic,
    motion::FrameState,
};
use reflet_world::World;

impl Session {
    /// Shows a posed frame: uploads poses, the top-level tree and material numbers only; nothing where all frames
    /// are equal. `edit` is done to the posed world.
    ///
    /// # Errors
    /// All errors of the frame; the former frame stays.
    pub fn apply(
        &mut self,
        frame: u32,
        pose: Option<FrameState>,
        edit: &dyn Fn(&mut World),
    ) -> Result<(), Vec<Diagnostic>> {
        let Some(state) = pose else {
            self.loaded.frame = frame;
            return Ok(());
        };
        self.complete().map_err(RenderError::into_diagnostics)?;
        let world = &mut self.loaded.world;
        world.apply(&state)?;
        edit(world);
        if let Err(error) = self.renderer.update(&self.gpu, world) {
            match (&self.state, &self.first) {
                // It was valid before.
                (Some(before), _) => drop(world.apply(before)),
                (None, Some(first)) => world.clone_from(first),
                (None, None) => {}
            }
            edit(world);
            return Err(error.into_diagnostics());
        }
        self.loaded.frame = frame;
        self.state = Some(state);
        Ok(())
    }

    /// Pose of the shown frame; `None` where all frames are equal.
    pub fn state(&self) -> Option<&FrameState> {
        self.state.as_ref()
    }

    /// Edits numbers of materials until the scene is read again.
    ///
    /// # Errors
    /// Same errors as [`crate::Renderer::change`]; then nothing changes.
    pub fn edit(&mut self, edit: &dyn Fn(&mut World)) -> Result<RebuildSummary, RenderError> {
        self.complete()?;
        let worlds = |session: &mut Self, change: &mut dyn FnMut(&mut World)| {
            change(&mut session.loaded.world);
            session.first.iter_mut().for_each(change);
        };
        let mut before = Vec::new();
        worlds(self, &mut |world| {
            before.push(world.materials.clone());
            edit(world);
        });
        let done = self.refresh();
        if done.is_err() {
            let mut before = before.into_iter();
            worlds(self, &mut |world| {
                world.materials = before.next().unwrap_or_default();
            });
        }
        done
    }

    /// Index of the camera that shows the posed frame.
    pub fn camera(&self) -> usize {
        self.camera_of(self.loaded.frame)
    }

    /// Index of the camera that shows a frame: the chosen one, else the camera of the last cut.
    pub fn camera_of(&self, frame: u32) -> usize {
        let chosen = self.view.camera_in(&self.loaded);
        chosen.unwrap_or_else(|| self.loaded.camera_at(frame))
    }

    /// Renders the scene at its current pose.
    ///
    /// # Errors
    /// Same errors as [`crate::Renderer::render`].
    pub fn picture(&mut self, aovs: &[Aov]) -> Result<Picture, RenderError> {
        let request = PictureRequest {
            aovs,
            timed: true,
            ..PictureRequest::COLOR
        };
        self.begin(request)?.take(&self.gpu)
    }

    /// Starts to render the scene at its current pose.
    ///
    /// # Errors
    /// Same errors as [`crate::Renderer::begin_picture`].
    pub fn begin(&mut self, request: PictureRequest) -> Result<PendingPicture, RenderError> {
        let mut picture = match self.error_bound() {
            Some(bound) => self.begin_within(bound, request)?,
            None => self.begin_counted(request)?,
        };
        for aov in request.aovs {
            if let Aov::Light(group) = aov {
                picture.add_light(*group, self.begin_light(*group, request)?);
            }
        }
        Ok(picture)
    }

    /// Starts to render the light of one group, with as many sub-frames as the last picture.
    fn begin_light(
        &mut self,
        group: LightGroup,
        request: PictureRequest,
    ) -> Result<PendingPicture, RenderError> {
        self.complete()?;
        let gpu = Arc::clone(&self.gpu);
        let with_light = |so_far: &SoFar<'_>| {
            let light = Some(group);
            (request.each_sample).map_or(Ok(()), |told| told(&SoFar { light, ..*so_far }))
        };
        let request = PictureRequest {
            each_sample: Some(&with_light),
            ..PictureRequest::COLOR
        };
        self.renderer.show_light(&gpu, Some(group));
        let picture = self.begin_counted(request);
        self.renderer.show_light(&gpu, None);
        picture
    }

    /// Starts to render with the number of sub-frames that the renderer has.
    pub(super) fn begin_counted(
        &mut self,
        request: PictureRequest,
    ) -> Result<PendingPicture, RenderError> {
        let camera = self.camera();
        self.complete()?;
        let renderer = &mut self.renderer;
        if let Some(mut moments) = OpenShutter::for_frame(&mut self.loaded, &self.meshes) {
            let seen_by = |world: &World| world.cameras[camera].value.clone();
            let shot = Shot::Moments(&mut moments, &seen_by);
            let picture = renderer.begin_picture(&self.gpu, shot, request);
            return picture.inspect_err(|_| close(renderer, &self.gpu, moments));
        }
        let camera = &self.loaded.world.cameras[camera].value;
        renderer.begin_picture(&self.gpu, camera, request)
    }

    /// Runs the passes once before they are timed.
    ///
    /// # Errors
    /// Same errors as [`crate::Renderer::warm_up`].
    pub fn warm_up(&mut self) -> Result<(), RenderError> {
        self.complete()?;
        let camera = &self.loaded.world.cameras[self.camera()].value;
        self.renderer.warm_up(&self.gpu, camera)
    }

    /// Renders a frame that counts the work of each pass.
    ///
    /// # Errors
    /// Same errors as [`crate::Renderer::counts`].
    pub fn counts(&mut self) -> Result<Vec<PassCounts>, RenderError> {
        self.complete()?;
        let camera = &self.loaded.world.cameras[self.camera()].value;
        self.renderer.counts(&self.gpu, camera)
    }

    /// Renders into the targets with a camera that may move with the world: while the shutter is open, each
    /// sub-frame shows another moment. `edit` is applied to each pose.
    ///
    /// # Errors
    /// Same errors as [`crate::Renderer::render`], and errors of a script at one of the moments.
    pub fn draw(
        &mut self,
        camera: &dyn Fn(&World) -> CameraDesc,
        edit: &dyn Fn(&mut World),
    ) -> Result<FrameStats, RenderError> {
        let loaded = &mut self.loaded;
        if self.coarse.is_some() || !open_shutter::moves(&loaded.scene) {
            let world = self.coarse.as_ref().unwrap_or(&loaded.world);
            return self.renderer.render(&self.gpu, &camera(world));
        }
        let mut moments = OpenShutter::new(&loaded.scene, &mut loaded.world, loaded.frame, edit)
            .with(&self.meshes);
        let shot = Shot::Moments(&mut moments, camera);
        let rendered = self.renderer.render(&self.gpu, shot);
        rendered.inspect_err(|_| close(&mut self.renderer, &self.gpu, moments))
    }
}

/// Poses the world and the renderer at the end of a frame, where another moment of it failed: later pictures show the
/// frame, which was valid before.
fn close(renderer: &mut RendererStage, gpu: &Gpu, mut moments: OpenShutter) {
    if let Ok(world) = moments.pose(0.0) {
        let _ = renderer.update(gpu, world);
    }
}
