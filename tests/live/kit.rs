//! Test kit: temporary folders, a small scene, and waiting for changes.

use std::{
    sync::{
        Mutex, PoisonError,
        mpsc::{self, Receiver},
    },
    time::{Instant, SystemTime},
};

use reflet::{
    gpu::ShaderLibrary,
    runtime::{parameters::ParameterOverrides, scene_text::SceneOptions},
    scene::desc::CameraDesc,
    world::World,
};
use reflet_preview::{
    live::{Reload, SceneSource},
    viewer::protocol::ScreenshotGoal,
    watch::{Changes, WatchEvent, WatchList, Watcher},
};

// Names that most tests of the preview need, beside the functions below.
pub use crate::{
    background_scripts::Watched,
    common::{folder::*, gpu_or_skip, is_long, sampled},
    runtime::with_set,
};
pub use glam::Vec3;
pub use reflet::{
    gpu::Gpu,
    runtime::{Session, SessionOptions},
};
pub use reflet_preview::{
    live::{InitialBuild, Live, ViewOverrides},
    viewer::protocol::Report,
    watch::Change,
};
pub use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

/// A mirror floor and a box; placeholders `{…}` are replaced.
pub const SCENE: &str = include_str!("kit/scene.toml");

/// New files in a folder as the goal of screenshots.
pub fn file_goal(folder: &Folder, stem: &str) -> ScreenshotGoal {
    ScreenshotGoal::File {
        folder: folder.0.clone(),
        stem: stem.to_owned(),
    }
}

/// Copies the project's shaders.
pub fn copy_shaders(to: &Folder) -> PathBuf {
    for (path, text) in ShaderLibrary::embedded().texts() {
        to.write(&format!("shaders/{path}"), text);
    }
    to.path("shaders")
}

pub fn open(gpu: &Arc<Gpu>, scene: &Path, shaders: Option<&Path>) -> Live {
    open_with(gpu, scene, shaders, &[])
}

/// GPU device that no other test uses at the same time, with the pipelines of tests that have ended; `None` where tests
/// are skipped.
pub fn gpu() -> Option<Arc<Gpu>> {
    static ALL: Mutex<Vec<Arc<Gpu>>> = Mutex::new(Vec::new());
    let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(unused) = all.iter().find(|gpu| Arc::strong_count(gpu) == 1) {
        return Some(unused.clone());
    }
    all.push(new_gpu()?);
    all.last().cloned()
}

/// GPU device without pipelines, for tests that compile some or change shaders; `None` where tests are skipped.
pub fn new_gpu() -> Option<Arc<Gpu>> {
    gpu_or_skip().map(Arc::new)
}

/// The file of a scene, for a preview without options.
pub fn source(scene: &Path) -> SceneSource {
    SceneSource {
        path: Some(scene.to_owned()),
        options: SceneOptions::default(),
        shaders: None,
        text: None,
    }
}

/// A session with this scene, in a folder of this name.
pub fn session(name: &str, scene: &str, set: &[&str]) -> Session {
    let path = kept_folder(name, &[("scene.toml", scene)]).join("scene.toml");
    Session::open(path, &with_set(set)).expect("opens")
}

/// Opens a scene with `--set` overrides.
pub fn open_with(gpu: &Arc<Gpu>, scene: &Path, shaders: Option<&Path>, set: &[&str]) -> Live {
    let source = SceneSource {
        options: with_set(set).scene,
        shaders: shaders.map(Path::to_owned),
        ..source(scene)
    };
    or_panic!(Live::open(
        gpu.clone(),
        source,
        ViewOverrides::default(),
        InitialBuild::Whole,
    ))
}

/// Runs background jobs of the preview synchronously.
pub trait RunNow {
    /// Whether the frame is shown.
    fn pose_now(&mut self, frame: u32) -> bool;
    fn set_parameters_now(&mut self, parameters: ParameterOverrides) -> Reload;
}

impl RunNow for Live {
    fn pose_now(&mut self, frame: u32) -> bool {
        if let Some(reload_job) = self.pose_job(frame) {
            self.finish_job(reload_job.run());
        }
        self.problems.pose.is_empty()
    }

    fn set_parameters_now(&mut self, parameters: ParameterOverrides) -> Reload {
        self.set_parameters(parameters);
        self.read_now()
    }
}

/// The first camera of a world, which may move.
pub fn first_camera(world: &World) -> CameraDesc {
    world.cameras[0].value.clone()
}

/// The display pixels of the first camera's view.
pub fn picture(gpu: &Gpu, live: &mut Live) -> Vec<u8> {
    live.render(&first_camera).expect("renders");
    let display = reflet::render::pipeline::targets::Target::Display;
    live.renderer().read(gpu, display).expect("is read back")
}

/// A watcher with blocking access to its changes.
pub struct Watch {
    pub watcher: Watcher,
    changes: Receiver<Changes>,
    /// A watched marker file that synchronizes with the watching thread.
    marker: Option<(Folder, PathBuf)>,
}

/// Kind of the marker's changes; tests with a marker do not change assets.
const MARKED: Change = Change::Asset;

/// Timeout for a change to be reported.
const MOST: Duration = Duration::from_secs(90);

impl Watch {
    pub fn new() -> Self {
        let (sender, changes) = mpsc::channel();
        let watcher = Watcher::new(move |event| {
            if let WatchEvent::Changed(changes, _) = event {
                let _ = sender.send(changes);
            }
        });
        Self {
            watcher: watcher.expect("files can be watched"),
            changes,
            marker: None,
        }
    }

    /// Watches a list whose files were all written long ago.
    pub fn settled(mut list: WatchList) -> Self {
        let mut watch = Self::new();
        let folder = Folder::new();
        let path = folder.write("marker", "0");
        list.files.push((path.clone(), MARKED));
        // The first check reports only the marker, since it was written after all files were read.
        let marker = fs::File::options().write(true).open(&path).expect("opens");
        let modified = marker.set_modified(SystemTime::now() + 2 * MOST);
        modified.expect("may be set");
        watch.watcher.watch(list, SystemTime::now() + MOST);
        assert_eq!(watch.next(), Changes::from([MARKED]));
        watch.marker = Some((folder, path));
        watch
    }

    /// Waits for the next changes.
    pub fn next(&self) -> Changes {
        let next = self.changes.recv_timeout(MOST);
        next.expect("a change is seen")
    }

    /// All changes of saves until now, in the order of their reports.
    pub fn changes_so_far(&self) -> Vec<Changes> {
        let (folder, path) = self.marker.as_ref().expect("a settled one");
        let before = fs::read_to_string(path).expect("readable");
        let temporary = folder.write("next", before + "0");
        fs::rename(temporary, path).expect("renamed");
        let mut seen = Vec::new();
        loop {
            let mut changes = self.next();
            let is_last = changes.remove(&MARKED);
            if !changes.is_empty() {
                seen.push(changes);
            }
            if is_last {
                return seen;
            }
        }
    }

    /// Calls `react` with every change until `done`; panics when that never comes.
    pub fn until(&self, mut react: impl FnMut(&Changes), mut done: impl FnMut() -> bool) {
        let deadline = Instant::now() + MOST;
        while !done() {
            if let Ok(changes) = self.changes.recv_timeout(Duration::from_millis(20)) {
                react(&changes);
            }
            assert!(Instant::now() < deadline, "the last content was never seen");
        }
    }
}
