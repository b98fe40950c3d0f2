//! The thread that owns the scene and renders it: it takes the newest view and every task, and
//! sleeps when nothing changed.

use std::{
    collections::VecDeque,
    sync::{
        Arc,
        mpsc::{self, Receiver, Sender},
    },
    thread,
    time::{Duration, Instant},
};

use super::{
    dynamic_resolution::FrameCost,
    frame_texture::FrameTexture,
    mailbox::Mailbox,
    picking::Mark,
    protocol::{Inspection, Report, SceneSummary, Shown, Task, View, ViewCamera, Visualization},
    reload_jobs::ReloadJobs,
    visualize::Pixels,
};
use crate::{
    app::{
        live::{Edit, Live, Reload, ViewOverrides},
        watch::{Change, News, WatchList, Watcher},
    },
    gpu::Gpu,
    render::{RenderError, stats::FrameStats},
    scene::desc::{CameraDesc, Method},
};

/// A still picture may take this long before sub-frames are left out, milliseconds.
const STILL_MS: f64 = 1000.0;
/// While frames follow each other, their numbers are told this often: they are read, not seen.
const TELL: Duration = Duration::from_millis(250);

/// The thread; ends when it is dropped.
pub struct RenderThread {
    /// Where it gets its tasks.
    pub mailbox: Mailbox,
    /// What it has to say.
    pub reports: Receiver<Report>,
    thread: Option<thread::JoinHandle<()>>,
}

impl RenderThread {
    /// Starts rendering; `woken` is called after each report. One that is waiting for its scene has
    /// that read at once.
    pub fn start(
        gpu: Arc<Gpu>,
        live: Live,
        is_waiting: bool,
        woken: impl Fn() + Send + 'static,
    ) -> Self {
        let mailbox = Mailbox::default();
        let (sender, reports) = mpsc::channel();
        let inbox = mailbox.clone();
        let body = move || {
            let mailbox = inbox.clone();
            let watcher = Watcher::new(move |news| {
                mailbox.ask(match news {
                    News::Changed(changes, since) => Task::Reload(changes, since),
                    News::Trouble(why) => Task::Unwatched(why),
                });
            });
            let mut state = State {
                gpu,
                live,
                view: None,
                canvases: Vec::new(),
                heat: None,
                mark: None,
                outline: None,
                reload_jobs: ReloadJobs::default(),
                drawn: None,
                inspections: VecDeque::new(),
                reloads: Vec::new(),
                watched: WatchList::default(),
                told_frame: 0,
                told_at: Instant::now(),
                number: 0,
                cost: FrameCost::default(),
                sender,
                woken: Box::new(woken),
            };
            state.watch(watcher.as_ref().ok());
            if let Err(why) = &watcher {
                state.tell(Report::Unwatched(Some(why.clone())));
            }
            if is_waiting {
                // What the scene imports is not watched yet either.
                inbox.ask(Task::Reload(
                    [Change::Scene, Change::Asset].into(),
                    Instant::now(),
                ));
            }
            state.run(&inbox, watcher.as_ref().ok());
        };
        Self {
            mailbox,
            reports,
            thread: Some(thread::spawn(body)),
        }
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.mailbox.end();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What the thread works with.
pub(super) struct State {
    pub(super) gpu: Arc<Gpu>,
    pub(super) live: Live,
    pub(super) view: Option<View>,
    canvases: Vec<FrameTexture>,
    pub(super) heat: Option<(FrameTexture, Pixels)>,
    /// The selected instance.
    pub(super) mark: Option<Mark>,
    pub(super) outline: Option<FrameTexture>,
    /// Scripts that run.
    pub(super) reload_jobs: ReloadJobs,
    /// What is in the targets, if it is a view of its posed frame.
    pub(super) drawn: Option<View>,
    /// What waits for its frame.
    pub(super) inspections: VecDeque<Inspection>,
    /// What was reloaded since the last picture, and when that was saved.
    pub(super) reloads: Vec<(Reload, Instant)>,
    /// What was last said to be watched.
    pub(super) watched: WatchList,
    /// The frame of the facts that were told last.
    told_frame: u32,
    told_at: Instant,
    number: u64,
    cost: FrameCost,
    sender: Sender<Report>,
    woken: Box<dyn Fn() + Send>,
}

impl State {
    pub(super) fn tell(&self, report: Report) {
        // The window may be closed already.
        let _ = self.sender.send(report);
        (self.woken)();
    }

    pub(super) fn tell_facts(&mut self) {
        (self.told_frame, self.told_at) = (self.live.posed_frame(), Instant::now());
        self.tell(Report::SceneSummary(Box::new(SceneSummary::of(&self.live))));
    }

    pub(super) fn watch(&mut self, watcher: Option<&Watcher>) {
        let (list, since) = self.live.watch_list();
        self.watched.clone_from(&list);
        if let Some(watcher) = watcher {
            watcher.watch(list, since);
        }
    }

    fn run(mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) {
        self.tell_facts();
        while let Some((view, tasks)) = mailbox.take(self.until()) {
            let mut redraw = false;
            if let Some(view) = view {
                redraw = self.view.as_ref().is_none_or(|old| view.looks_other(old));
                self.view = Some(view);
            }
            for task in tasks {
                match task {
                    Task::Reload(changes, since) => self.reload(&changes, since),
                    Task::Edit(edit) => {
                        redraw = true;
                        self.edit(edit);
                    }
                    Task::Tune(tuned) => self.tune(tuned),
                    Task::Unwatched(why) => self.tell(Report::Unwatched(why)),
                    Task::Inspect(inspection) => self.inspections.push_back(inspection),
                    Task::Unpick => self.unpick(),
                }
            }
            redraw |= self.reload_jobs(mailbox, watcher);
            redraw |= self.reloads.iter().any(|(reload, _)| reload.ok);
            if redraw && !self.is_aside() {
                self.draw();
            }
            for (reload, since) in std::mem::take(&mut self.reloads) {
                let ms = since.elapsed().as_secs_f64() * 1e3;
                self.tell(Report::Reloaded(reload, ms));
            }
            self.inspect();
            if mailbox.is_empty() && self.inspections.is_empty() {
                self.tell(Report::Idle);
            }
        }
    }

    /// Whether the posed frame is not the view's, but that of something on demand.
    fn is_aside(&self) -> bool {
        let posed = self.live.posed_frame();
        let is_posed = |frame: u32| frame == posed;
        (self.inspections.front()).is_some_and(|of| is_posed(of.view.frame))
            && !(self.view.as_ref()).is_some_and(|view| is_posed(view.frame))
    }

    fn edit(&mut self, edit: Edit) {
        match self.live.edit(edit) {
            Ok(_) => self.tell_facts(),
            Err(error) => self.refuse(&error),
        }
    }

    /// Shows an error; the last picture stays.
    pub(super) fn refuse(&mut self, error: &RenderError) {
        self.live.problems.refused = Some(error.to_string());
        self.tell_facts();
    }

    fn draw(&mut self) {
        let Some(view) = self.view.clone() else {
            return;
        };
        match self.sides(&view).and_then(|s| Ok((s, self.picked()?))) {
            Ok((sides, picked)) => {
                self.drawn = Some(view.clone());
                self.number += 1;
                let had_problem = self.live.problems.refused.take().is_some();
                let number = self.number;
                self.tell(Report::Shown(Box::new(Shown {
                    number,
                    frame: self.live.posed_frame(),
                    camera: self.camera(&view.eye),
                    size: view.size,
                    sides,
                    picked,
                })));
                // Numbers that move are told now and then, and when they rest.
                let is_new = self.told_frame != self.live.posed_frame();
                let is_time = view.draft_ms.is_none() || self.told_at.elapsed() >= TELL;
                if had_problem || (is_new && is_time) {
                    self.tell_facts();
                }
            }
            Err(error) => self.refuse(&error),
        }
    }

    fn sides(&mut self, view: &View) -> Result<Vec<Visualization>, RenderError> {
        let mut sides: Vec<Visualization> = Vec::new();
        for (index, side) in std::iter::once(view.a).chain(view.b).enumerate() {
            let last = sides.last().filter(|_| view.a.method == side.method);
            let stats = match last {
                Some(last) => last.stats.clone(),
                None => self.render(view, side.method)?,
            };
            let old = self.canvases.get(index).cloned();
            let drawn = self.drawn(side, view, stats, old)?;
            self.canvases.truncate(index);
            self.canvases.push(drawn.canvas.clone());
            sides.push(drawn);
        }
        Ok(sides)
    }

    /// Where a view is taken from in the posed scene.
    pub(super) fn camera(&self, eye: &ViewCamera) -> CameraDesc {
        let cameras = &self.live.world().cameras;
        match eye {
            ViewCamera::Free(camera) => camera.clone(),
            ViewCamera::Through(name) => {
                let found = cameras.iter().find(|camera| camera.name == *name);
                let found = found.or(cameras.first());
                found.map_or_else(CameraDesc::default, |camera| camera.value.clone())
            }
        }
    }

    /// Renders into the targets with as many pixels and sub-frames as there is time for.
    pub(super) fn render(
        &mut self,
        view: &View,
        method: Method,
    ) -> Result<FrameStats, RenderError> {
        self.drawn = None;
        let most = self.gpu.limits.max_texture_dimension_2d;
        let pixels = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
        let mut size = view.size.map(|side| side.clamp(1, most));
        let mut samples = self.live.desc().image.samples;
        if let Some(draft_ms) = view.draft_ms {
            samples = 1;
            for _ in 0..3 {
                if self.cost.is_too_large(pixels(size), draft_ms) {
                    size = size.map(|side| side.div_ceil(2));
                }
            }
        }
        while samples > 1 && self.cost.ms(pixels(size) * f64::from(samples)) > STILL_MS {
            samples /= 2;
        }
        self.live.set_overrides(ViewOverrides {
            size: Some(size),
            method: Some(method),
            samples: Some(samples),
        })?;
        let stats = self.live.render(&self.camera(&view.eye))?;
        self.cost
            .learn(pixels(size) * f64::from(samples), stats.frame_ms);
        Ok(stats)
    }
}
