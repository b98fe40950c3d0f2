//! Reflet in a page: scene text → messages, and scene text → picture, for the worker of `src/web/page`. The page hands over the
//! files ([`in_memory`]); nothing else can be read, and nothing is sent.
//!
//! [`language`] is the language server, for a worker of its own.
//!
//! A picture takes many answers of the device. [`show`] is suspended until each is there
//! (`src/gpu/wait.rs`); meanwhile the worker may call everything here but [`show`].
#![cfg(target_arch = "wasm32")]

mod bench;
mod editing;
mod saving;

use std::{
    cell::{Cell, RefCell},
    mem,
    panic::set_hook,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use serde::Deserialize;
use serde_json::{Value, json};
use wasm_bindgen::prelude::wasm_bindgen;

use bench::Measurement;
use editing::{Editing, own_camera};
use reflet_base::{clock::Instant, files::in_memory};
use reflet_gpu::{Gpu, GpuError, GpuOptions};
use reflet_lsp::{Server, quick_fix, range};
use reflet_render::{
    Picture, PictureRequest, SoFar,
    picture::{aov::Aov, aov_view},
    runtime::{
        InitialBuild, SceneSource, Session, SessionError, ViewOverrides, find_aovs,
        parameters::ParameterOverrides,
        read::{Read, read},
        scene_options::SceneOptions,
        scene_text::LoadedScene,
    },
};
use reflet_scene::{
    dependencies::Dependencies,
    desc::Method,
    diagnostic::{Diagnostic, at_most},
    project::{self, ProjectChoice},
};
use reflet_write_back::{
    page,
    presses::KeyAction,
    view_channel::{ViewChannel, aov_legend, ray_order},
};
use saving::Saving;

/// Time between two pictures of some samples.
const EACH_PART: Duration = Duration::from_secs(1);

#[wasm_bindgen]
extern "C" {
    /// Hands over the picture after some of its samples: pixels, RGBA.
    #[wasm_bindgen(js_namespace = globalThis)]
    fn tell_part(done: u32, samples: u32, width: u32, height: u32, pixels: Vec<u8>);

    /// Tells the page why the program ends.
    #[wasm_bindgen(js_namespace = globalThis)]
    fn tell_panic(why: &str);
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
    static LANGUAGE: RefCell<Server> = RefCell::new(Server::new(
        &json!({ "capabilities": { "textDocument": { "completion": { "completionItem": { "snippetSupport": true } } } } }),
    ));
}

#[derive(Default)]
struct State {
    asked: Option<Asked>,
    /// Input that [`editing::act`] is to follow next.
    acting: String,
    /// Measurement that [`bench::bench`] is to make next.
    measuring: Option<Measurement>,
    /// Answer of the last call of [`show`], [`editing::act`] or [`bench::bench`].
    answer: Value,
    shown: Shown,
    picture: Option<Picture>,
    saving: Saving,
    /// Signal that ends the picture in work.
    interrupt: Arc<AtomicBool>,
    /// Whether files have changed since the last picture.
    has_new_files: bool,
}

impl State {
    fn scene(&self) -> Result<&LoadedScene, &'static str> {
        let session = self.shown.session.as_ref();
        session.map(Session::scene).ok_or("no picture is shown")
    }
}

/// Picture to make next, as the page asks for it; values that are none are the scene's own.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Asked {
    scene: PathBuf,
    /// Text of the scene; none for a model, whose file is read.
    text: Option<String>,
    /// Width, pixels; 0 for the scene's own.
    width: u32,
    samples: Option<u32>,
    frame: u32,
    camera: Option<String>,
    /// Name of the reflection method.
    method: Option<String>,
    /// Name of the displayed channel; without it the picture.
    channel: Option<String>,
    /// The rest is as the manifest of a pack has it.
    set: Vec<String>,
    variant: Vec<String>,
    assets: Vec<PathBuf>,
    lenient: bool,
    strict: bool,
    project: Option<PathBuf>,
    aovs: Vec<String>,
}

impl Asked {
    fn new(json: &str) -> Self {
        serde_json::from_str(json).expect("the worker writes it")
    }

    /// Source of the scene, with overrides of a camera that was moved.
    fn source(self, moved: Vec<String>) -> SceneSource {
        let project = self.project.map(|folder| folder.join(project::FILE));
        SceneSource {
            path: Some(self.scene),
            text: self.text.map(Into::into),
            options: SceneOptions {
                set: self.set.into_iter().chain(moved).collect(),
                variant: self.variant,
                assets: self.assets,
                lenient: self.lenient,
                strict: self.strict,
                project: project.map_or(ProjectChoice::Search, ProjectChoice::Named),
                ..SceneOptions::default()
            },
            ..SceneSource::default()
        }
    }
}

/// The open device and scene.
#[derive(Default)]
struct Shown {
    gpu: Option<Arc<Gpu>>,
    session: Option<Session>,
    /// Overrides that the scene was asked for with, without the place of a dragged camera.
    set: Vec<String>,
    /// Whether the session has the scene that was asked for last.
    is_open: bool,
    /// Whether the device holds a picture of it, perhaps of few samples.
    is_drawn: bool,
    /// Pixels of the displayed channel and its legend; none where the picture itself is displayed.
    channel: Option<(Vec<u8>, String)>,
    editing: Editing,
}

/// Has panics told to the page; to be called first.
#[wasm_bindgen]
pub fn start() {
    set_hook(Box::new(|panic| tell_panic(&panic.to_string())));
}

/// Puts a file where scenes find it by its name.
#[wasm_bindgen]
pub fn put_file(name: &str, bytes: Vec<u8>) {
    in_memory::put(Path::new(name), bytes);
    STATE.with_borrow_mut(|state| state.has_new_files = true);
}

/// Removes all files.
#[wasm_bindgen]
pub fn clear() {
    in_memory::clear();
    STATE.with_borrow_mut(|state| state.has_new_files = true);
}

/// Paths that were looked for since the last call and are not there, as JSON.
#[wasm_bindgen]
pub fn missing() -> String {
    let paths = in_memory::take_missing().into_iter();
    let below = |path: PathBuf| Some(path.to_str()?.trim_start_matches('/').to_owned());
    json!(paths.filter_map(below).collect::<Vec<_>>()).to_string()
}

/// Messages about the text and script of a scene, as JSON.
#[wasm_bindgen]
pub fn check(asked: &str) -> String {
    let text = Asked::new(asked).source(Vec::new()).read();
    let opened = text.and_then(|text| text.open(&[], &Dependencies::default()));
    let found = opened.map_or_else(|errors| errors, |opened| opened.warnings);
    json!(messages(found)).to_string()
}

/// List of messages of the language server that follow from one of the editor, both as JSON-RPC. A text that is opened takes
/// the place of the open one.
#[wasm_bindgen]
pub fn language(message: &str) -> String {
    let message = serde_json::from_str(message).unwrap_or_default();
    json!(LANGUAGE.with_borrow_mut(|server| server.handle(&message))).to_string()
}

/// Ends the picture in work.
#[wasm_bindgen]
pub fn interrupt() {
    STATE.with_borrow(|state| state.interrupt.store(true, Ordering::Relaxed));
}

/// Says what [`show`] is to make next.
#[wasm_bindgen]
pub fn ask(asked: &str) {
    STATE.with_borrow_mut(|state| state.asked = Some(Asked::new(asked)));
}

/// Makes the picture that was asked for last. The only function that is suspended; the worker calls it anew after it has
/// returned, never before.
#[wasm_bindgen]
pub fn show() {
    let taken = STATE.with_borrow_mut(|state| {
        state.interrupt = Arc::default();
        let asked = state.asked.take();
        let new_files = mem::take(&mut state.has_new_files);
        asked.map(|asked| {
            let shown = mem::take(&mut state.shown);
            (asked, shown, state.interrupt.clone(), new_files)
        })
    });
    let Some((asked, mut shown, interrupt, new_files)) = taken else {
        return;
    };
    let made = shown.picture(asked, &interrupt, !new_files);
    let is_lost = matches!(made, Err(SessionError::Gpu(GpuError::Lost(_))));
    let (answer, picture) = match made {
        Ok(picture) => (shown.answer(&picture), Some(picture)),
        Err(SessionError::Gpu(GpuError::Interrupted)) => {
            (json!({ "interrupted": true, "open": shown.is_open }), None)
        }
        Err(SessionError::Scene(errors)) => (json!({ "messages": messages(errors) }), None),
        Err(SessionError::UnknownName { kind, name, known }) => {
            let error = SessionError::UnknownName { kind, name, known };
            (json!({ "error": error.to_string(), "unknown": kind }), None)
        }
        Err(error) => (json!({ "error": error.to_string(), "lost": is_lost }), None),
    };
    if is_lost {
        shown = Shown::default();
    }
    shown.refresh();
    STATE.with_borrow_mut(|state| {
        (state.answer, state.shown) = (answer, shown);
        state.picture = picture.or(state.picture.take());
    });
}

/// Answer of the last call of [`editing::act`], `changes` of texts, whether an input `writes`, that is, is over, and whether the camera
/// `moves`, or an `error`; or
/// of the last call of [`show`], as JSON: `messages` with `width`, `height`, `adapter` and `frame` of the picture, names of `aovs`,
/// the `timeline`, first frame, last frame and frames in a second, whether its camera `moves`, that is, stands as its text says, all
/// `cameras`, `methods` and `channels`, and the `method` and `samples` of the picture and the `legend` of its channel, or with none of
/// these; an `error` of the device, which may be `lost`, or of a name of an `unknown` camera, method or channel; or `interrupted`, and whether the scene is `open` then.
#[wasm_bindgen]
pub fn answer() -> String {
    STATE.with_borrow(|state| state.answer.to_string())
}

/// Pixels of the last picture or of its displayed channel, RGBA.
#[wasm_bindgen]
pub fn pixels() -> Vec<u8> {
    STATE.with_borrow(|state| {
        let channel = state.shown.channel.as_ref().map(|(pixels, _)| pixels);
        let display = state.picture.as_ref().map(|picture| &picture.display);
        channel.or(display).cloned().unwrap_or_default()
    })
}

/// Presses that the page understands, with their actions, and rows of its `help`, as JSON. The editor finds its undo itself.
#[wasm_bindgen]
pub fn keys() -> String {
    use KeyAction::{Close, Compare, Copy, Record, SafeArea, Undo};
    page::keys(
        &[Copy, Compare, SafeArea, Close, Record],
        &[Undo(false), Undo(true)],
    )
    .to_string()
}

impl Shown {
    /// The open device, whose pictures end by this signal.
    fn device(&mut self, interrupt: &Arc<AtomicBool>) -> Result<Arc<Gpu>, GpuError> {
        let gpu = match self.gpu.take() {
            Some(gpu) => gpu,
            None => Arc::new(Gpu::new(&GpuOptions::default())?),
        };
        self.gpu = Some(gpu.clone());
        gpu.check()?;
        gpu.interrupt_by(Some(interrupt.clone()));
        Ok(gpu)
    }

    fn picture(
        &mut self,
        asked: Asked,
        interrupt: &Arc<AtomicBool>,
        reuses_files: bool,
    ) -> Result<Picture, SessionError> {
        let (none, texts) = (ParameterOverrides::default(), Dependencies::default());
        let (width, frame) = (asked.width, asked.frame);
        let method = (asked.method.as_deref())
            .map(|name| named("method", name, page::methods(), |it| it.name()))
            .transpose()?;
        let channel = (asked.channel.as_deref())
            .map(|name| named("channel", name, ViewChannel::of_frames(), |it| it.name()))
            .transpose()?;
        let channel = channel.filter(|channel| *channel != ViewChannel::Picture);
        let mut view = ViewOverrides {
            method,
            samples: asked.samples,
            camera: asked.camera.clone(),
            ..ViewOverrides::default()
        };
        let aovs = asked.aovs.clone();
        (self.is_open, self.is_drawn) = (false, false);
        self.set.clone_from(&asked.set);
        let is_same = (self.session.as_ref())
            .is_some_and(|open| open.source().path.as_ref() == Some(&asked.scene));
        let moved = match is_same {
            true => self.editing.overrides(),
            false => Vec::new(),
        };
        let source = asked.source(moved);
        let read = read(&source, &none, &texts, frame)?;
        view.size = size(&read, width);
        let gpu = self.device(interrupt)?;
        let same = self.session.take().filter(|_| is_same);
        if same.is_none() {
            self.editing = Editing::default();
        }
        view.left_out = self.editing.left_out.names(&read.scene().desc);
        let session = match same {
            Some(open) => {
                let session = self.session.insert(open);
                session.set_view(view)?;
                let pose = read.pose();
                session.show(read, pose, reuses_files)?;
                session
            }
            None => {
                let whole = InitialBuild::Whole;
                let open = Session::of_read(gpu.clone(), source, view, read, whole)?;
                self.session.insert(open)
            }
        };
        self.is_open = true;
        session.camera_named(session.view().camera.as_deref())?;
        let world = &session.scene().world;
        let aovs = aovs.iter().map(|name| find_aovs(name, world));
        let mut aovs = aovs.collect::<Result<Vec<_>, _>>()?.concat();
        if let Some(ViewChannel::Aov(aov)) = channel {
            aovs.push(aov);
        }
        let (told, is_drawn) = (Cell::new(Instant::now()), Cell::new(false));
        let each_sample = |so_far: &SoFar<'_>| {
            is_drawn.set(true);
            let has_parts = channel.is_none() && so_far.done < so_far.samples;
            if has_parts && told.get().elapsed() > EACH_PART {
                let part = so_far.picture()?;
                let [width, height] = part.size;
                tell_part(so_far.done, so_far.samples, width, height, part.display);
                told.set(Instant::now());
            }
            Ok(())
        };
        let request = PictureRequest {
            aovs: &aovs,
            each_sample: Some(&each_sample),
            ..PictureRequest::COLOR
        };
        let picture = session.begin(request);
        let picture = picture.and_then(|begun| begun.take(&gpu));
        self.is_drawn = is_drawn.get();
        let picture = picture?;
        self.channel = match channel {
            Some(ViewChannel::Aov(aov)) => picture
                .planes
                .last()
                .map(|plane| (aov_view::view(plane), aov_legend(aov, plane))),
            Some(ViewChannel::Rays) => {
                let rays = session.renderer().ray_list(&gpu)?;
                Some(ray_order(picture.size, rays, &picture.display))
            }
            _ => None,
        };
        Ok(picture)
    }

    fn answer(&self, picture: &Picture) -> Value {
        let session = self.session.as_ref();
        let found = session.map_or_else(Vec::new, |session| session.warnings().to_vec());
        let adapter = self.gpu.as_ref().map(|gpu| &gpu.adapter_info.name);
        let loaded = session.map(Session::scene);
        let time = loaded.and_then(|loaded| loaded.scene.timeline.as_ref());
        json!({
            "messages": messages(found),
            "log": session.map(|session| session.log().collect::<Vec<_>>()),
            "width": picture.size[0],
            "height": picture.size[1],
            "adapter": adapter,
            "moves": session.is_some_and(|session| own_camera(session).is_some()),
            "cameras": loaded.map(|loaded| loaded.world.cameras.iter().map(|it| &it.name).collect::<Vec<_>>()),
            "methods": page::methods().map(Method::name).collect::<Vec<_>>(),
            "channels": ViewChannel::of_frames().map(ViewChannel::name).collect::<Vec<_>>(),
            "legend": self.channel.as_ref().map(|(_, legend)| legend),
            "method": session.map(|session| session.renderer().method().name()),
            "samples": picture.stats.samples,
            "aovs": loaded.map(|loaded| Aov::names_in(&loaded.world)),
            "frame": loaded.map(|loaded| loaded.frame),
            "timeline": time.map(|time| (time.start, time.end, time.fps)),
        })
    }
}

/// The method or channel of this name.
fn named<T>(
    kind: &'static str,
    name: &str,
    all: impl Iterator<Item = T>,
    name_of: fn(&T) -> &'static str,
) -> Result<T, SessionError> {
    let mut known = Vec::new();
    for own in all {
        if name_of(&own) == name {
            return Ok(own);
        }
        known.push(name_of(&own).to_owned());
    }
    let name = name.to_owned();
    Err(SessionError::UnknownName { kind, name, known })
}

/// Size of a picture of this width and the scene's shape; `None` for the scene's own size.
fn size(read: &Read, width: u32) -> Option<[u32; 2]> {
    let [own, height] = read.scene().desc.image.size;
    let height = u64::from(height) * u64::from(width) / u64::from(own.max(1));
    (width > 0).then(|| [width, (height as u32).max(1)])
}

/// Messages with their file and, where they are about a place, its range in the form of the language server and the edit that
/// mends it.
fn messages(found: Vec<Diagnostic>) -> Vec<Value> {
    let message = |found: Diagnostic| {
        let source = found.span.source.as_ref();
        json!({
            "severity": found.severity.name(),
            "file": found.path().map(|path| path.strip_prefix("/").unwrap_or(path)),
            "range": source.map(|source| range(&source.text, &found.span.range)),
            "text": found.render(false),
            "fix": quick_fix(&found),
        })
    };
    at_most(found).into_iter().map(message).collect()
}
