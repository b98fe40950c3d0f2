//! Motion blur: pictures of a moving scene while the shutter is open; each sub-frame shows other moments.

use std::time::Instant;

use reflet_gpu::{Gpu, readback};
use reflet_scene::desc::CameraDesc;
use reflet_world::World;

use super::aov::Aov;
use crate::{
    error::RenderError,
    picture::{PendingPicture, Picture, PictureRequest},
    pipeline::recorder::{PassTimes, Timing},
    renderer::{Renderer, error_estimate::FirstHalf, stats::FrameStats},
    settings::pixel_share::{MOMENTS, PixelShare, needs_moments},
};

/// Poses of the moments of one picture.
pub trait Moments {
    /// The world at a moment within the time that the shutter is open, -0.5 to 0.5; 0 is the frame's own.
    ///
    /// # Errors
    /// A script error at that moment.
    fn pose(&mut self, moment: f64) -> Result<&World, RenderError>;
}

impl Renderer {
    /// Renders one picture of several moments into the targets, each seen by the camera at its moment.
    ///
    /// # Errors
    /// Same errors as [`Renderer::update`] and [`Renderer::render`], and errors of the poses.
    pub fn render_moments(
        &mut self,
        gpu: &Gpu,
        moments: &mut dyn Moments,
        camera: &dyn Fn(&World) -> CameraDesc,
    ) -> Result<FrameStats, RenderError> {
        let started = Instant::now();
        let mut times = PassTimes::default();
        self.each_moment(gpu, moments, |renderer, world, share| {
            let camera = camera(world);
            let view = renderer.view(gpu, &camera);
            let recorder = renderer.sub_frame(gpu, &view, share, Timing::Passes, None);
            times.extend(renderer.submitted(recorder.finish())?);
            Ok(())
        })?;
        gpu.wait()?;
        let frame_ms = started.elapsed().as_secs_f64() * 1e3;
        let mut stats = self.stats(times.summed(), frame_ms);
        let counters = self.bindings.ray_list.counted();
        stats.set_counters(&readback::read_buffer(gpu, counters)?);
        Ok(stats)
    }

    /// Renders one picture of several moments with camera number `camera`, times its passes and reads everything
    /// back.
    ///
    /// # Errors
    /// Same errors as [`Renderer::update`] and [`Renderer::picture`], and errors of the poses.
    pub fn picture_of_moments(
        &mut self,
        gpu: &Gpu,
        moments: &mut dyn Moments,
        camera: usize,
        aovs: &[Aov],
    ) -> Result<Picture, RenderError> {
        let request = PictureRequest {
            color: true,
            aovs,
            timed: true,
            estimates_error: false,
        };
        (self.begin_picture_of_moments(gpu, moments, camera, request)?).take(gpu)
    }

    /// Starts a picture of several moments, timed or without waiting for it.
    ///
    /// # Errors
    /// Same errors as [`Renderer::picture_of_moments`].
    pub fn begin_picture_of_moments(
        &mut self,
        gpu: &Gpu,
        moments: &mut dyn Moments,
        camera: usize,
        request: PictureRequest,
    ) -> Result<PendingPicture, RenderError> {
        self.first_half = FirstHalf::of_picture(request.estimates_error);
        let stats = if request.timed {
            let seen_by = |world: &World| world.cameras[camera].value.clone();
            self.render_moments(gpu, moments, &seen_by)?
        } else {
            self.submit_moments(gpu, moments, camera)?
        };
        let world = moments.pose(0.0)?;
        self.pending(gpu, &world.cameras[camera].value, request, stats)
    }

    /// Submits one picture of several moments, like [`Renderer::submit`] for a single moment.
    fn submit_moments(
        &mut self,
        gpu: &Gpu,
        moments: &mut dyn Moments,
        camera: usize,
    ) -> Result<FrameStats, RenderError> {
        let mut before = None;
        self.each_moment(gpu, moments, |renderer, world, share| {
            let camera = &world.cameras[camera].value;
            let view = renderer.view(gpu, camera);
            let recorder = renderer.sub_frame(gpu, &view, share, Timing::None, None);
            let submission = renderer.submitted(recorder.submit())?;
            if let Some(before) = before.replace(submission) {
                gpu.wait_for(&before)?;
            }
            Ok(())
        })?;
        Ok(self.stats(PassTimes::default(), 0.0))
    }

    /// Poses the renderer for each moment of each sub-frame, and calls `record`.
    fn each_moment(
        &mut self,
        gpu: &Gpu,
        moments: &mut dyn Moments,
        mut record: impl FnMut(&mut Self, &World, PixelShare) -> Result<(), RenderError>,
    ) -> Result<(), RenderError> {
        let samples = self.options.image.samples.count();
        let moments_each = match self.plan.features.moments && needs_moments(samples) {
            true => MOMENTS,
            false => 1,
        };
        for sample in 0..samples {
            for share in PixelShare::of_sub_frame(sample, moments_each) {
                let world = moments.pose(share.moment_of(samples))?;
                self.update(gpu, world)?;
                record(self, world, share)?;
            }
            self.end_of_sub_frame(gpu, sample)?;
        }
        Ok(())
    }
}
