//! State of the rendering thread, and the rendering of a view.

use std::{
    collections::VecDeque,
    sync::{Arc, mpsc::Sender},
    time::Instant,
};

use super::{
    dynamic_resolution::{FrameCost, RestBudget},
    pixels::Pixels,
    reload_jobs::ReloadJobs,
};
use crate::{
    live::{Live, Reload, ViewOverrides},
    viewer::{
        frame_texture::FrameTexture,
        picture_filter::PictureFilter,
        protocol::{FrameRequest, Report, Task, View, ViewCamera},
        scene_summary::SceneSummary,
    },
    watch::{WatchList, Watcher},
    write_back::{SceneItem, picking::Clicks},
};
use reflet_gpu::Gpu;
use reflet_render::{
    Draft, RenderError, renderer::stats::FrameStats, runtime::parameters::ParameterOverrides,
};
use reflet_scene::desc::{CameraDesc, Method};
use reflet_world::World;

/// Halvings of a draft's size: a smaller one than a quarter of each side cannot be read.
const MOST_HALVINGS: u32 = 2;

/// State of the rendering thread.
pub(super) struct Worker {
    pub(super) gpu: Arc<Gpu>,
    pub(super) live: Live,
    pub(super) view: Option<View>,
    pub(super) textures: Vec<FrameTexture>,
    pub(super) error_map: Option<(FrameTexture, Pixels)>,
    /// Name of the selected instance, by which it is found in a reloaded scene.
    pub(super) selected: Option<String>,
    pub(super) outline: Option<FrameTexture>,
    /// Clicks on the picture.
    pub(super) clicks: Clicks,
    /// The inspected item, with its name.
    pub(super) item: Option<(SceneItem, Option<String>)>,
    /// Values of parameters to write into the text once they are shown.
    pub(super) unwritten: Option<ParameterOverrides>,
    /// Number of written texts that is known, and when the last of them was written, until its reload is over.
    pub(super) own_writes: u64,
    pub(super) own_write: Option<Instant>,
    /// Tasks that write, which wait for that reload.
    pub(super) waiting: VecDeque<Task>,
    /// Running and pending scripts.
    pub(super) reload_jobs: ReloadJobs,
    /// The view in the targets, if they hold one of the posed frame.
    pub(super) rendered_view: Option<View>,
    /// Requests that wait for their frame.
    pub(super) frame_requests: VecDeque<FrameRequest>,
    /// Reloads since the last picture, each with the time of its file event.
    pub(super) reloads: Vec<(Reload, Instant)>,
    /// The last list given to the watcher.
    pub(super) watched: WatchList,
    /// Frame of the summary that was sent last.
    pub(super) summary_frame: u32,
    pub(super) summary_sent_at: Instant,
    pub(super) number: u64,
    /// Number of saves that were shown.
    pub(super) saves: u64,
    /// Whether the picture of the view was given up, and is still to be drawn.
    pub(super) is_interrupted: bool,
    /// Time budget of the view at rest.
    pub(super) rest_budget: RestBudget,
    /// Filter of pictures at rest.
    pub(super) denoiser: Option<PictureFilter>,
    frame_cost: FrameCost,
    sender: Sender<Report>,
    on_report: Box<dyn Fn() + Send>,
}

/// A view's camera in a posed world.
fn camera_in(world: &World, eye: &ViewCamera) -> CameraDesc {
    match eye {
        ViewCamera::Free(camera) => camera.clone(),
        ViewCamera::Scene(name) => {
            let found = world.cameras.iter().find(|camera| camera.name == *name);
            let found = found.or(world.cameras.first());
            found.map_or_else(CameraDesc::default, |camera| camera.value.clone())
        }
    }
}

impl Worker {
    pub(super) fn new(
        gpu: Arc<Gpu>,
        live: Live,
        denoiser: Option<PictureFilter>,
        sender: Sender<Report>,
        on_report: Box<dyn Fn() + Send>,
    ) -> Self {
        Self {
            gpu,
            live,
            view: None,
            textures: Vec::new(),
            error_map: None,
            selected: None,
            outline: None,
            clicks: Clicks::default(),
            item: None,
            unwritten: None,
            own_writes: 0,
            own_write: None,
            waiting: VecDeque::new(),
            reload_jobs: ReloadJobs::default(),
            rendered_view: None,
            frame_requests: VecDeque::new(),
            reloads: Vec::new(),
            watched: WatchList::default(),
            summary_frame: 0,
            summary_sent_at: Instant::now(),
            number: 0,
            saves: 0,
            is_interrupted: false,
            rest_budget: RestBudget::starting(0.0),
            denoiser,
            frame_cost: FrameCost::default(),
            sender,
            on_report,
        }
    }

    pub(super) fn send(&self, report: Report) {
        // The window may be closed already.
        let _ = self.sender.send(report);
        (self.on_report)();
    }

    pub(super) fn send_summary(&mut self) {
        (self.summary_frame, self.summary_sent_at) = (self.live.scene().frame, Instant::now());
        self.send(Report::SceneSummary(Box::new(SceneSummary::from_live(
            &self.live,
        ))));
    }

    pub(super) fn watch(&mut self, watcher: Option<&Watcher>) {
        let (list, since) = self.live.watch_list();
        self.watched.clone_from(&list);
        if let Some(watcher) = watcher {
            watcher.watch(list, since);
        }
    }

    /// Shows an error; the last picture stays.
    pub(super) fn report_error(&mut self, error: &RenderError) {
        self.live.problems.undrawn = Some(error.to_string());
        self.send_summary();
    }

    /// A view's camera in the posed scene.
    pub(super) fn camera(&self, eye: &ViewCamera) -> CameraDesc {
        camera_in(self.live.world(), eye)
    }

    /// Renders the coarse first picture.
    pub(super) fn render_coarse(&mut self, view: &View) -> Result<FrameStats, RenderError> {
        let most = self.gpu.limits.max_texture_dimension_2d;
        self.live.set_view(ViewOverrides {
            size: Some(view.size.map(|side| side.clamp(1, most))),
            ..self.live.view().clone()
        })?;
        self.live.render(&|world| camera_in(world, &view.camera))
    }

    /// Renders into the targets, with resolution and sub-frames reduced to the time budget; what is `auto` is
    /// decided for the whole picture.
    pub(super) fn render(
        &mut self,
        view: &View,
        method: Method,
    ) -> Result<FrameStats, RenderError> {
        self.rendered_view = None;
        let most = self.gpu.limits.max_texture_dimension_2d;
        let pixels = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
        let whole = view.size.map(|side| side.clamp(1, most));
        self.live.set_view(ViewOverrides {
            samples: view.samples,
            left_out: view.left_out.names(self.live.desc()),
            ..self.live.view().clone()
        })?;
        let (mut size, all_samples) = (whole, self.live.samples());
        let mut samples = all_samples;
        if let Some(draft_ms) = view.draft_ms {
            samples = 1;
            for _ in 0..MOST_HALVINGS {
                if self.frame_cost.is_too_large(pixels(size), draft_ms) {
                    size = size.map(|side| side.div_ceil(2));
                }
            }
        }
        while samples > 1
            && self
                .frame_cost
                .predict_ms(pixels(size) * f64::from(samples))
                > self.rest_budget.ms
        {
            samples /= 2;
        }
        let is_whole = (size, samples) == (whole, all_samples);
        self.live.set_view(ViewOverrides {
            size: Some(whole),
            method: Some(method),
            draft: (!is_whole).then_some(Draft { size, samples }),
            camera: view.chosen.clone(),
            ..self.live.view().clone()
        })?;
        self.live.complete()?;
        let stats = self.live.render(&|world| camera_in(world, &view.camera))?;
        if !is_whole && view.draft_ms.is_none() {
            self.rest_budget.fall_short(stats.frame_ms);
        }
        self.frame_cost
            .record(pixels(size) * f64::from(samples), stats.frame_ms);
        Ok(stats)
    }
}
