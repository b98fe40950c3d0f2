//! Rendered frames become files, on threads of their own: each waits for its picture, encodes it
//! and writes it, while the next ones render.

use std::{
    collections::HashSet,
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread::{self, Scope},
    time::Instant,
};

use super::{
    error::AppError,
    output::{picture_file::PictureFile, video::Film},
    progress::Progress,
};
use crate::{gpu::Gpu, render::PendingPicture};

/// Pictures that may wait for an encoder: enough that neither side waits for the other's hiccups.
const WAITING: usize = 2;

/// Most encoders; more would only wait for the disk.
const MOST: usize = 8;

/// Where the frames go.
pub enum Target {
    /// A file for each.
    Files {
        /// What kind of file.
        output: PictureFile,
        /// Name of each frame's file.
        names: Vec<PathBuf>,
    },
    /// All in one.
    Film(Box<Mutex<Film>>),
}

/// A frame on its way to its file.
pub struct Rendered {
    /// In the list of frames.
    pub index: usize,
    /// Its number.
    pub frame: u32,
    /// What the GPU is busy with.
    pub picture: PendingPicture,
    /// Its fingerprint.
    pub mark: String,
    /// When it was begun.
    pub started: Instant,
}

/// Frames without a picture, and why.
pub type Failures = Vec<(u32, String)>;

/// What all encoders of a command share.
pub struct Encoders<'a> {
    gpu: &'a Gpu,
    target: &'a Target,
    progress: Mutex<Progress>,
    failures: Mutex<Failures>,
    /// Why the disk takes no more.
    full: Mutex<Option<String>>,
    /// Frames that were written.
    written: Mutex<HashSet<u32>>,
}

/// How it went.
pub struct Outcome {
    /// Frames that have their file.
    pub done: usize,
    /// Frames that were written now.
    pub written: HashSet<u32>,
    /// Frames that could not be encoded or written.
    pub failures: Failures,
    /// Why the disk takes no more; nothing was written after that.
    pub full: Option<String>,
}

impl<'a> Encoders<'a> {
    /// Encoders that write to `target`.
    pub fn new(gpu: &'a Gpu, target: &'a Target, progress: Progress) -> Self {
        Self {
            gpu,
            target,
            progress: Mutex::new(progress),
            failures: Mutex::default(),
            full: Mutex::default(),
            written: Mutex::default(),
        }
    }

    /// Starts them, and gives the place where they get their frames from. They end when it is
    /// dropped; it refuses frames when they have ended.
    pub fn spawn<'scope>(&'scope self, scope: &'scope Scope<'scope, '_>) -> SyncSender<Rendered> {
        let count = match self.target {
            // Frames of one film must come in order.
            Target::Film(_) => 1,
            // Half of the cores: scripts and the driver need the others.
            Target::Files { .. } => {
                thread::available_parallelism().map_or(1, |cores| (cores.get() / 2).clamp(1, MOST))
            }
        };
        let (sender, queue) = sync_channel(WAITING);
        let queue = Arc::new(Mutex::new(queue));
        for _ in 0..count {
            let queue = queue.clone();
            scope.spawn(move || while self.one(&queue) {});
        }
        sender
    }

    /// Tells that a frame has no picture.
    pub fn failed(&self, frame: u32, why: &str) {
        lock(&self.progress).failed(frame, why);
    }

    /// Prints something beside the progress.
    pub fn aside(&self, print: impl FnOnce()) {
        lock(&self.progress).aside(print);
    }

    /// Whether the disk takes no more frames.
    pub fn is_full(&self) -> bool {
        lock(&self.full).is_some()
    }

    /// How it went.
    pub fn finish(self) -> Outcome {
        fn inner<T>(mutex: Mutex<T>) -> T {
            mutex.into_inner().unwrap_or_else(PoisonError::into_inner)
        }
        let progress = inner(self.progress);
        progress.end();
        Outcome {
            done: progress.written(),
            written: inner(self.written),
            failures: inner(self.failures),
            full: inner(self.full),
        }
    }

    /// Waits for a frame and writes it; whether another may follow.
    fn one(&self, queue: &Mutex<Receiver<Rendered>>) -> bool {
        let Ok(rendered) = lock(queue).recv() else {
            return false;
        };
        if self.is_full() {
            return false;
        }
        let (frame, started) = (rendered.frame, rendered.started);
        match self.write(rendered) {
            Ok((verb, path)) => {
                lock(&self.written).insert(frame);
                let seconds = started.elapsed().as_secs_f64();
                lock(&self.progress).done(frame, verb, &path, seconds);
                true
            }
            Err(AppError::Disk(why)) => {
                self.failed(frame, &why);
                lock(&self.full).get_or_insert(why);
                false
            }
            Err(error) => {
                let why = error.to_string();
                self.failed(frame, &why);
                lock(&self.failures).push((frame, why));
                // A film with a hole is none.
                !matches!(self.target, Target::Film(_))
            }
        }
    }

    fn write(&self, rendered: Rendered) -> Result<(&'static str, PathBuf), AppError> {
        let picture = rendered.picture.take(self.gpu);
        let picture = picture.map_err(|error| AppError::from_render(error, false))?;
        match self.target {
            Target::Film(film) => {
                let mut film = lock(film);
                film.add(&picture.display)?;
                Ok(("added to", film.goal().to_owned()))
            }
            Target::Files { output, names } => {
                let name = names[rendered.index].clone();
                let own = output.renamed(name.clone());
                own.write_marked(&picture, Some(&rendered.mark))?;
                Ok(("wrote", name))
            }
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
