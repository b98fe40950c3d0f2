//! A folder of its own for each test, a small scene, and waiting for changes.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
        mpsc::{self, Receiver},
    },
    time::{Duration, Instant, SystemTime},
};

use reflet::{
    app::{
        args::SceneArgs,
        live::{Live, Origin, Reload, Reuse, ViewOverrides},
        params::ParameterOverrides,
        watch::{Changes, News, WatchList, Watcher},
    },
    gpu::Gpu,
};

/// A folder that is gone after the test.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("reflet-live-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("temporary folder");
        Self(path.canonicalize().expect("exists"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("folder");
        fs::write(&path, text).expect("writable");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A mirror floor and a box; `{…}` are replaced.
pub const SCENE: &str = r#"version = 1
[image]
size = [48, 32]
[camera.main]
eye = [0, 2, 5]
target = [0, 0.5, 0]
[material.floor]
base_color = [0.4, 0.4, 0.4]
reflectivity = 0.5
roughness = 0.02
[material.red]
base_color = [0.9, 0.1, 0.1]
[model.floor]
shape = { kind = "plane", size = [8, 8] }
material = "floor"
[model.box]
shape = { kind = "box" }
material = "red"
[[instance]]
model = "floor"
[[instance]]
model = "box"
translation = [0, 0.5, 0]
[light.lamp]
kind = "point"
position = [2, 4, 3]
intensity_cd = 30
shadow_px = 64
[environment]
color = [0.2, 0.2, 0.3]
"#;

/// Copies the project's shaders.
pub fn copy_shaders(to: &Folder) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    for folder in ["", "lib"] {
        for entry in fs::read_dir(from.join(folder)).expect("shaders") {
            let path = entry.expect("entry").path();
            if path.is_file() {
                let name = path.file_name().expect("a name").to_string_lossy();
                let text = fs::read(&path).expect("readable");
                to.write(&format!("shaders/{folder}/{name}"), text);
            }
        }
    }
    to.path("shaders")
}

pub fn open(gpu: &Arc<Gpu>, scene: &Path, shaders: Option<&Path>) -> Live {
    open_with(gpu, scene, shaders, &[])
}

/// With `--set`.
pub fn open_with(gpu: &Arc<Gpu>, scene: &Path, shaders: Option<&Path>, set: &[&str]) -> Live {
    let origin = Origin {
        path: Some(scene.to_owned()),
        from: SceneArgs {
            set: set.iter().map(|text| (*text).to_owned()).collect(),
            assets: Vec::new(),
        },
        shaders: shaders.map(Path::to_owned),
    };
    match Live::open(gpu.clone(), origin, ViewOverrides::default()) {
        Ok(live) => live,
        Err(error) => {
            error.print();
            panic!("the scene does not open");
        }
    }
}

/// What the preview does beside the picture, done at once.
pub trait AtOnce {
    /// Whether the frame is shown.
    fn pose_now(&mut self, frame: u32) -> bool;
    fn tune_now(&mut self, tuned: ParameterOverrides) -> Reload;
}

impl AtOnce for Live {
    fn pose_now(&mut self, frame: u32) -> bool {
        if let Some(reload_job) = self.posing(frame) {
            self.take(reload_job.run());
        }
        self.problems.pose.is_empty()
    }

    fn tune_now(&mut self, tuned: ParameterOverrides) -> Reload {
        self.tune(tuned);
        let keeps = Reuse {
            files: true,
            edits: true,
        };
        loop {
            let reload_job = self.reading(keeps, self.posed_frame());
            let reload = self.take(reload_job.run());
            if !self.reads_again() {
                return reload;
            }
        }
    }
}

/// The display pixels of the first camera's view.
pub fn picture(gpu: &Gpu, live: &mut Live) -> Vec<u8> {
    let camera = live.world().cameras[0].value.clone();
    live.render(&camera).expect("renders");
    let display = reflet::render::targets::Target::Display;
    live.renderer().read(gpu, display).expect("is read back")
}

/// A watcher whose changes are waited for.
pub struct Watch {
    pub watcher: Watcher,
    changes: Receiver<Changes>,
}

/// Longest that a change may take to be noticed; a test fails only past it.
const MOST: Duration = Duration::from_secs(20);

impl Watch {
    pub fn new() -> Self {
        let (sender, changes) = mpsc::channel();
        let watcher = Watcher::new(move |news| {
            if let News::Changed(changes, _) = news {
                let _ = sender.send(changes);
            }
        });
        Self {
            watcher: watcher.expect("files can be watched"),
            changes,
        }
    }

    /// Watches a list whose files were all written long ago.
    pub fn settled(list: WatchList) -> Self {
        let watch = Self::new();
        watch.watcher.watch(list, SystemTime::now() + MOST);
        // The watching thread takes its messages in order and reports nothing for this one.
        assert_eq!(watch.next(Duration::from_millis(300)), None);
        watch
    }

    pub fn next(&self, most: Duration) -> Option<Changes> {
        self.changes.recv_timeout(most).ok()
    }

    /// Calls `react` with every change until `done`; panics when that never comes.
    pub fn until(&self, mut react: impl FnMut(&Changes), mut done: impl FnMut() -> bool) {
        let deadline = Instant::now() + MOST;
        while !done() {
            if let Some(changes) = self.next(Duration::from_millis(20)) {
                react(&changes);
            }
            assert!(Instant::now() < deadline, "the last content was never seen");
        }
    }
}
