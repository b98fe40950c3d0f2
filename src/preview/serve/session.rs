//! The scene behind the page: turns what viewers do into views and tasks of the render thread, and its reports into
//! what they see. All viewers share one view: the last input wins, and everyone sees it.

use std::{
    io::Cursor,
    sync::{
        Arc,
        mpsc::{self, Receiver, RecvTimeoutError, Sender},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use image::{ExtendedColorType, codecs::jpeg::JpegEncoder};

use super::{hub::Hub, state};
use crate::viewer::{
    opening::{Opened, ViewerOptions},
    protocol::{
        FinishedFrame, FrameAction, FrameRequest, Picked, Reply, Report, Screenshot,
        ScreenshotGoal, Task, Visualization,
    },
    render_thread::RenderThread,
    scene_summary::SceneSummary,
    view_state::ViewState,
};
use crate::write_back::{
    input::{Input, Unfinished},
    selection::Selection,
};
use reflet_gpu::Gpu;
use reflet_render::{
    picture::png_file,
    runtime::{SessionError, parameters::ParameterOverrides},
};
use reflet_scene::desc::CameraDesc;

/// Quality of pictures while something moves, 1 to 100.
const QUALITY: u8 = 82;
/// Longest wait without an event.
const IDLE: Duration = Duration::from_secs(3600);

/// Event of the session.
pub(super) enum Event {
    /// The render thread has reported.
    Report,
    /// A viewer did something.
    Input(Input),
    /// A viewer came.
    Joined,
    /// A viewer left, perhaps in a drag.
    Left(Unfinished),
    /// A viewer wants the picture as a PNG file, with the line of a wipe at this place, 0 to 1.
    Picture(f32, Sender<Result<Vec<u8>, String>>),
    /// The end.
    End,
}

pub(super) struct Session {
    pub(super) gpu: Arc<Gpu>,
    pub(super) hub: Hub,
    pub(super) render_thread: RenderThread,
    pub(super) state: ViewState,
    pub(super) overrides: ParameterOverrides,
    pub(super) selection: Selection,
    /// Place of the press in the picture, 0 to 1, that took hold of the dragged handle.
    pub(super) grip: Option<[f32; 2]>,
    pub(super) picked: Option<Picked>,
    /// Places where drags of handles began that another viewer took over, newest first.
    pub(super) taken: Vec<[f32; 2]>,
    /// Camera of the last picture.
    pub(super) shown_camera: Option<CameraDesc>,
    pub(super) size: [u32; 2],
    pub(super) started: Instant,
    /// Number of the last picture.
    number: u64,
    /// Name of the scene, for files.
    name: String,
}

/// Opens the scene and starts the session on its thread.
pub(super) fn start(
    gpu: Arc<Gpu>,
    options: &ViewerOptions,
    hub: Hub,
) -> Result<(Sender<Event>, JoinHandle<()>), SessionError> {
    let opened = Opened::new(&gpu, options)?;
    let (sender, events) = mpsc::channel();
    let reports = sender.clone();
    // The session may be over already.
    let on_report = move || drop(reports.send(Event::Report));
    let name = opened.stem.clone();
    let (render_thread, mut state) = opened.start(&gpu, options.denoiser.clone(), on_report);
    state.settings.denoises = options.denoiser.is_some().then_some(true);
    let session = Session {
        render_thread,
        state,
        gpu,
        hub,
        overrides: ParameterOverrides::default(),
        selection: Selection::default(),
        grip: None,
        picked: None,
        taken: Vec::new(),
        shown_camera: None,
        size: options.size,
        started: Instant::now(),
        number: 0,
        name,
    };
    Ok((sender, thread::spawn(move || session.run(&events))))
}

impl Session {
    pub(super) fn now_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    fn run(mut self, events: &Receiver<Event>) {
        let mut wait = IDLE;
        self.tell_scene();
        loop {
            match events.recv_timeout(wait) {
                Ok(Event::End) | Err(RecvTimeoutError::Disconnected) => return,
                Ok(Event::Input(input)) => self.act(input),
                Ok(Event::Picture(wipe_at, reply)) => self.screenshot(wipe_at, reply),
                Ok(Event::Left(unfinished)) => self.take_back(unfinished),
                Ok(Event::Report | Event::Joined) | Err(RecvTimeoutError::Timeout) => {}
            }
            self.handle_reports();
            self.tell_choices();
            wait = match self.hub.is_empty() {
                // Nobody looks: nothing is rendered.
                true => IDLE,
                false => self.request_view(),
            };
        }
    }

    pub(super) fn tell_scene(&self) {
        let scene = state::scene(&self.state, &self.name);
        self.hub.text("scene", &scene);
    }

    /// Tells what changes while something is dragged; what is as before is not sent again.
    fn tell_choices(&self) {
        let parameters = state::parameters(&self.state.summary, &self.overrides);
        self.hub.text("parameters", &parameters);
        self.hub.text("material", &state::material(&self.state));
        self.tell_item();
        self.tell_handles();
        self.hub
            .text("keys", &state::keys(&self.state, self.selection.shown()));
    }

    /// Has the picture rendered whole, also while something moves.
    fn screenshot(&self, wipe_at: f32, reply: Sender<Result<Vec<u8>, String>>) {
        let view = self.state.view(self.size, self.now_s());
        let action = FrameAction::Screenshot(Screenshot {
            goal: ScreenshotGoal::Reply(Reply(reply)),
            wipe_at,
            error_map: false,
        });
        self.post(Task::Frame(Box::new(FrameRequest { view, action })));
    }

    pub(super) fn say(&self, text: &str) {
        self.hub.text("message", &state::message(text));
    }

    pub(super) fn post(&self, task: Task) {
        self.render_thread.mailbox.post(task);
    }

    /// Requests the view, if it changed; returns the time until it changes by itself.
    fn request_view(&mut self) -> Duration {
        let now_s = self.now_s();
        let wait_s = self.state.advance(now_s);
        if let Some(task) = self.state.record() {
            self.post(task);
        }
        let view = self.state.view(self.size, now_s);
        self.hub.text("view", &state::view(&self.state));
        if self.state.request(&view) {
            self.render_thread.mailbox.post_view(view);
        }
        wait_s.map_or(IDLE, |wait_s| Duration::from_secs_f64(wait_s.max(0.001)))
    }

    fn handle_reports(&mut self) {
        let mut newest = None;
        while let Ok(report) = self.render_thread.reports.try_recv() {
            match report {
                Report::SceneSummary(summary) => self.adopt(*summary),
                Report::Frame(shown) => {
                    self.number = shown.number;
                    newest = Some(*shown);
                }
                Report::Idle => self.hub.text("idle", &state::idle(self.number)),
                Report::Reloaded(reload, ms) if reload.ok => {
                    self.say(&format!(
                        "reloaded in {ms:.0} ms from the save to the picture"
                    ));
                }
                Report::Reloaded(..) => self.say("reload failed; see the errors"),
                Report::Refused(refusal) => {
                    self.overrides = refusal.stays.clone();
                    let why = state::problems(&refusal.why).join("\n");
                    self.say(&format!("refused: {why}"));
                }
                Report::Picked(picked) => {
                    self.state.settings.material = picked.as_ref().map(|picked| picked.material);
                    self.picked = picked;
                }
                Report::Unpicked => {
                    self.picked = None;
                    self.selection.show(None);
                }
                Report::Inspected(inspected) => self.selection.show(inspected.map(|i| *i)),
                Report::Message(text) => self.say(&text),
                Report::Unwatched(Some(why)) => self.say(&why),
                _ => {}
            }
        }
        if let Some(shown) = newest {
            self.show(&shown);
        }
    }

    fn adopt(&mut self, summary: SceneSummary) {
        self.overrides.keep_what_fits(&summary.declared);
        self.state.adopt(summary, self.now_s());
        self.tell_scene();
    }

    fn show(&mut self, shown: &FinishedFrame) {
        self.state.show(shown);
        self.picked.clone_from(&shown.picked);
        self.shown_camera = Some(shown.camera.clone());
        let mut pictures = [None, None];
        let started = Instant::now();
        for (index, side) in shown.sides.iter().take(2).enumerate() {
            match self.encode(shown.number, index as u8, side, shown.is_draft) {
                Ok(bytes) => pictures[index] = Some(bytes.into()),
                Err(why) => return self.say(&format!("the picture is not sent: {why}")),
            }
        }
        self.hub.pictures(pictures);
        let encode_ms = started.elapsed().as_secs_f64() * 1e3;
        self.hub
            .text("statistics", &state::statistics(shown, encode_ms));
    }

    /// A side for the page: its index, the number of sides' picture (8 bytes, little endian), then JPEG or PNG.
    fn encode(
        &self,
        number: u64,
        index: u8,
        side: &Visualization,
        is_draft: bool,
    ) -> Result<Vec<u8>, String> {
        let size = side.texture.size;
        let rgba = side
            .texture
            .read(&self.gpu)
            .map_err(|error| error.to_string())?;
        let mut bytes = vec![index];
        bytes.extend_from_slice(&number.to_le_bytes());
        if !is_draft {
            bytes.extend(png_file::encode(size, &rgba, &[])?);
            return Ok(bytes);
        }
        let rgb = png_file::rgb(&rgba);
        let mut jpeg = Cursor::new(Vec::new());
        JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
            .encode(&rgb, size[0], size[1], ExtendedColorType::Rgb8)
            .map_err(|error| error.to_string())?;
        bytes.extend(jpeg.into_inner());
        Ok(bytes)
    }
}
