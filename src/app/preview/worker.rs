//! The thread that owns the scene and renders it: it takes the newest view and every task, and
//! sleeps when nothing changed.

use std::{
    sync::{
        Arc,
        mpsc::{self, Receiver, Sender},
    },
    thread,
    time::Instant,
};

use super::{
    canvas::Canvas,
    desk::Desk,
    facts::{Edit, Facts, Judged, Look, Report, Shown, Side, Task, View},
};
use crate::{
    app::{
        aov,
        live::{Live, Reload, Wishes},
        output,
        watch::Watcher,
    },
    bench::{
        metric::{Maps, flip},
        picture::{Pair, Picture},
    },
    gpu::Gpu,
    render::{RenderError, stats::FrameStats, targets::Target},
    scene::desc::Method,
};

/// A draft should take no longer than this, milliseconds.
const DRAFT_MS: f64 = 50.0;
/// A still picture may take this long before sub-frames are left out, milliseconds.
const STILL_MS: f64 = 1000.0;

/// The thread; ends when it is dropped.
pub struct Worker {
    /// Where it gets its tasks.
    pub desk: Desk,
    /// What it has to say.
    pub reports: Receiver<Report>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Worker {
    /// Starts rendering; `woken` is called after each report.
    pub fn start(gpu: Arc<Gpu>, live: Live, woken: impl Fn() + Send + 'static) -> Self {
        let desk = Desk::default();
        let (sender, reports) = mpsc::channel();
        let inbox = desk.clone();
        let body = move || {
            let desk = inbox.clone();
            let watcher =
                Watcher::new(move |changes, since| desk.ask(Task::Reload(changes, since)));
            let state = State {
                gpu,
                live,
                view: None,
                canvases: Vec::new(),
                heat: None,
                number: 0,
                pixel_ms: 1e-4,
                sender,
                woken: Box::new(woken),
            };
            match &watcher {
                Ok(watcher) => state.watch(watcher),
                Err(why) => state.tell(Report::Note(why.clone())),
            }
            state.run(&inbox, watcher.as_ref().ok());
        };
        Self {
            desk,
            reports,
            thread: Some(thread::spawn(body)),
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.desk.end();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct State {
    gpu: Arc<Gpu>,
    live: Live,
    view: Option<View>,
    canvases: Vec<Canvas>,
    heat: Option<Canvas>,
    number: u64,
    /// What a pixel of a sub-frame took last, milliseconds.
    pixel_ms: f64,
    sender: Sender<Report>,
    woken: Box<dyn Fn() + Send>,
}

impl State {
    fn tell(&self, report: Report) {
        // The window may be closed already.
        let _ = self.sender.send(report);
        (self.woken)();
    }

    fn tell_facts(&self) {
        self.tell(Report::Facts(Box::new(Facts::of(&self.live))));
    }

    fn watch(&self, watcher: &Watcher) {
        let (list, since) = self.live.watch_list();
        watcher.watch(list, since);
    }

    fn run(mut self, desk: &Desk, watcher: Option<&Watcher>) {
        self.tell_facts();
        while let Some((view, tasks)) = desk.take() {
            let mut redraw = view.is_some() && view != self.view;
            if view.is_some() {
                self.view = view;
            }
            let (mut reloads, mut after) = (Vec::new(), Vec::new());
            for task in tasks {
                match task {
                    Task::Reload(changes, since) => {
                        let reload = self.live.reload(&changes);
                        if let Some(watcher) = watcher {
                            self.watch(watcher);
                        }
                        redraw |= reload.ok;
                        reloads.push((reload, since));
                        self.tell_facts();
                    }
                    Task::Edit(edit) => {
                        redraw = true;
                        self.edit(edit);
                    }
                    task => after.push(task),
                }
            }
            if redraw {
                self.draw();
            }
            self.tell_reloads(reloads);
            for task in after {
                self.look(task);
            }
            if desk.is_empty() {
                self.tell(Report::Idle);
            }
        }
    }

    fn tell_reloads(&self, reloads: Vec<(Reload, Instant)>) {
        for (reload, since) in reloads {
            let ms = since.elapsed().as_secs_f64() * 1e3;
            self.tell(Report::Reloaded(reload, ms));
        }
    }

    fn edit(&mut self, edit: Edit) {
        let edited = self.live.edit_materials(|index, material| {
            if index == edit.material {
                material.reflectivity = edit.reflectivity;
                material.roughness = edit.roughness;
                material.metallic = edit.metallic;
            }
        });
        match edited {
            Ok(_) => self.tell_facts(),
            Err(error) => self.refuse(&error),
        }
    }

    /// Tasks that need a frame.
    fn look(&mut self, task: Task) {
        let done = match task {
            Task::Judge => self.judge(),
            Task::Pick(at) => self.pick(at),
            Task::Shot(path) => {
                let said = match self.shot() {
                    Ok(png) => match crate::files::write_whole(&path, &png) {
                        Ok(()) => format!("wrote {}", path.display()),
                        Err(error) => format!("cannot write {}: {error}", path.display()),
                    },
                    Err(error) => format!("no screenshot: {error}"),
                };
                self.tell(Report::Note(said));
                Ok(())
            }
            Task::Reload(..) | Task::Edit(_) => Ok(()),
        };
        if let Err(error) = done {
            self.refuse(&error);
        }
    }

    /// Shows an error; the last picture stays.
    fn refuse(&mut self, error: &RenderError) {
        self.live.problems.refused = Some(error.to_string());
        self.tell_facts();
    }

    fn draw(&mut self) {
        let Some(view) = self.view.clone() else {
            return;
        };
        match self.sides(&view) {
            Ok(sides) => {
                self.number += 1;
                let had_problem = self.live.problems.refused.take().is_some();
                let number = self.number;
                self.tell(Report::Shown(Box::new(Shown { number, sides })));
                if had_problem {
                    self.tell_facts();
                }
            }
            Err(error) => self.refuse(&error),
        }
    }

    fn sides(&mut self, view: &View) -> Result<Vec<(Canvas, FrameStats)>, RenderError> {
        let mut sides = Vec::new();
        let mut last: Option<(Method, FrameStats)> = None;
        for (index, side) in std::iter::once(view.a).chain(view.b).enumerate() {
            let stats = match last.take().filter(|(method, _)| *method == side.method) {
                Some((_, stats)) => stats,
                None => self.render(view, side.method)?,
            };
            last = Some((side.method, stats.clone()));
            let canvas = self.canvas(index, stats.size)?;
            self.fill(&canvas, side, view)?;
            sides.push((canvas, stats));
        }
        Ok(sides)
    }

    /// Renders into the targets with as many pixels and sub-frames as there is time for.
    fn render(&mut self, view: &View, method: Method) -> Result<FrameStats, RenderError> {
        let most = self.gpu.limits.max_texture_dimension_2d;
        let pixels = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
        let mut size = view.size.map(|side| side.clamp(1, most));
        let mut samples = self.live.desc().image.samples;
        if view.draft {
            samples = 1;
            for _ in 0..3 {
                if self.pixel_ms * pixels(size) > DRAFT_MS {
                    size = size.map(|side| side.div_ceil(2));
                }
            }
        }
        while samples > 1 && self.pixel_ms * pixels(size) * f64::from(samples) > STILL_MS {
            samples /= 2;
        }
        self.live.wish(Wishes {
            size: Some(size),
            method: Some(method),
            samples: Some(samples),
        })?;
        let stats = self.live.render(&view.camera)?;
        self.pixel_ms = stats.frame_ms / (pixels(size) * f64::from(samples));
        Ok(stats)
    }

    fn canvas(&mut self, index: usize, size: [u32; 2]) -> Result<Canvas, RenderError> {
        let old = self.canvases.get(index).cloned();
        let canvas = Canvas::of_size(&self.gpu, old, size)?;
        self.canvases.truncate(index);
        self.canvases.push(canvas.clone());
        Ok(canvas)
    }

    fn fill(&self, canvas: &Canvas, side: Side, view: &View) -> Result<(), RenderError> {
        let renderer = self.live.renderer();
        match side.look {
            Look::Picture => {
                if let Some(display) = renderer.targets().texture(Target::Display) {
                    canvas.copy(&self.gpu, display)?;
                }
            }
            Look::Aov(aov) => {
                let plane = aov.plane(&self.gpu, renderer, &view.camera)?;
                canvas.write(&self.gpu, &aov::view(&plane));
            }
        }
        Ok(())
    }

    /// Renders one method at full size and reads it back.
    fn read(&mut self, method: Method) -> Result<([u32; 2], Vec<u8>), RenderError> {
        let Some(mut view) = self.view.clone() else {
            return Ok(([1, 1], vec![0; 4]));
        };
        view.draft = false;
        let stats = self.render(&view, method)?;
        let rgba = self.live.renderer().read(&self.gpu, Target::Display)?;
        Ok((stats.size, rgba))
    }

    fn judge(&mut self) -> Result<(), RenderError> {
        let Some(view) = self.view.clone() else {
            return Ok(());
        };
        let method = view.a.method;
        let (size, reference) = self.read(Method::Rt)?;
        let (test_size, test) = self.read(method)?;
        let picture = |rgba: &[u8]| {
            let rgb: Vec<u8> = rgba
                .chunks_exact(4)
                .flat_map(|p| [p[0], p[1], p[2]])
                .collect();
            Picture::from_rgb8(size[0] as usize, size[1] as usize, &rgb)
        };
        let (Ok(test), Ok(reference)) = (picture(&test), picture(&reference)) else {
            return Ok(());
        };
        let Ok(pair) = Pair::new(&test, &reference) else {
            self.tell(Report::Note(format!("{test_size:?} is not {size:?}")));
            return Ok(());
        };
        let maps = Maps::of(&pair);
        let heat = Canvas::of_size(&self.gpu, self.heat.take(), size)?;
        let rgb = flip::heat(&maps.flip);
        let rgba: Vec<u8> = rgb
            .chunks_exact(3)
            .flat_map(|p| [p[0], p[1], p[2], 255])
            .collect();
        heat.write(&self.gpu, &rgba);
        self.heat = Some(heat.clone());
        self.tell(Report::Judged(Box::new(Judged {
            view,
            scores: maps.scores(None),
            heat,
        })));
        Ok(())
    }

    fn shot(&mut self) -> Result<Vec<u8>, String> {
        let method = self.view.as_ref().map(|view| view.a.method);
        let method = method.ok_or("nothing is shown yet")?;
        let (size, rgba) = self.read(method).map_err(|error| error.to_string())?;
        output::encode_png(size, &rgba, None)
    }

    fn pick(&mut self, at: [f32; 2]) -> Result<(), RenderError> {
        let [width, height] = self.live.renderer().targets().size;
        let ids: Vec<[u32; 2]> = self.live.renderer().read(&self.gpu, Target::Ids)?;
        let pixel = |part: f32, side: u32| ((part * side as f32) as u32).min(side - 1);
        let index = pixel(at[1], height) * width + pixel(at[0], width);
        let instances = &self.live.world().instances;
        let instance = instances.get(ids[index as usize][0] as usize);
        self.tell(Report::Picked(instance.map(|found| found.material)));
        Ok(())
    }
}
