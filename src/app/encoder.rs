//! Encoder threads: each waits for a rendered picture, encodes it and writes its file while later
//! frames render.

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

use super::{error::AppError, progress::Progress, shutdown};
use crate::{
    files::Goal,
    gpu::Gpu,
    output::{
        denoise::{Denoiser, window::Window},
        picture_file::PictureFile,
        video::Film,
    },
    render::{Crop, PendingPicture, renderer::stats::FrameStats},
};

/// Queue length between renderer and encoders; absorbs short stalls of either.
const QUEUE_LENGTH: usize = 2;

/// Maximum number of encoder threads; more would only wait for the disk.
const MAX_THREADS: usize = 8;

/// Destination of the frames.
pub enum Target {
    /// One file per frame.
    Files {
        /// Kind of file.
        output: PictureFile,
        /// Name of each frame's file.
        names: Vec<Goal>,
    },
    /// One video file.
    Film(Box<Mutex<Film>>),
}

/// A submitted frame, not yet written.
pub struct Rendered {
    /// Index in the list of frames.
    pub index: usize,
    /// Frame number.
    pub frame: u32,
    /// Picture being rendered.
    pub picture: Rendering,
    /// Fingerprint of the frame.
    pub mark: String,
    /// Time at which its rendering started.
    pub started: Instant,
}

/// The picture of a submitted frame.
pub enum Rendering {
    /// A picture that no other is needed for.
    Alone(Box<PendingPicture>),
    /// A picture that is denoised with its neighbors.
    Window(Window),
}

/// Failed frames, each with its error.
pub type Failures = Vec<(u32, String)>;

/// State shared by the encoder threads of a command.
pub struct Encoders<'a> {
    gpu: &'a Gpu,
    target: &'a Target,
    /// Denoiser of the frames, if requested.
    denoiser: Option<Arc<Denoiser>>,
    /// Part of the frames that is written.
    crop: Option<Crop>,
    progress: Mutex<Progress>,
    /// The outcome so far, whose number of frames the progress counts.
    outcome: Mutex<Outcome>,
}

/// Numbers of frames of a film that were written, and that failed.
#[derive(Default)]
pub struct Outcome {
    /// Number of frames with a file.
    pub done: usize,
    /// Frames written by this run.
    pub written: HashSet<u32>,
    /// Frames that could not be encoded or written.
    pub failures: Failures,
    /// Error of a full disk; nothing was written after it.
    pub full: Option<String>,
    /// Statistics of the frame that was written last.
    pub last: Option<FrameStats>,
}

impl<'a> Encoders<'a> {
    /// Encoders that write to `target`.
    pub fn new(
        gpu: &'a Gpu,
        target: &'a Target,
        progress: Progress,
        denoiser: Option<Arc<Denoiser>>,
        crop: Option<Crop>,
    ) -> Self {
        Self {
            gpu,
            target,
            denoiser,
            crop,
            progress: Mutex::new(progress),
            outcome: Mutex::default(),
        }
    }

    /// Starts the threads and returns the sender of their queue. They end when it is dropped;
    /// sending fails once they have ended.
    pub fn spawn<'scope>(&'scope self, scope: &'scope Scope<'scope, '_>) -> SyncSender<Rendered> {
        let count = match self.target {
            // Frames of one film must come in order.
            Target::Film(_) => 1,
            // Half of the cores; scripts and the driver use the others.
            Target::Files { .. } => thread::available_parallelism()
                .map_or(1, |cores| (cores.get() / 2).clamp(1, MAX_THREADS)),
        };
        let (sender, queue) = sync_channel(QUEUE_LENGTH);
        let queue = Arc::new(Mutex::new(queue));
        for _ in 0..count {
            let queue = queue.clone();
            scope.spawn(move || while self.encode_next(&queue) {});
        }
        sender
    }

    /// Reports a failed frame.
    pub fn failed(&self, frame: u32, why: &str) {
        lock(&self.progress).failed(frame, why);
    }

    /// Prints lines above the progress bar.
    pub fn print_above(&self, print: impl FnOnce()) {
        lock(&self.progress).print_above(print);
    }

    /// Whether the disk is full.
    pub fn is_full(&self) -> bool {
        lock(&self.outcome).full.is_some()
    }

    /// Result of the run.
    pub fn finish(self) -> Outcome {
        let progress = self.progress.into_inner();
        let progress = progress.unwrap_or_else(PoisonError::into_inner);
        progress.end();
        let outcome = self.outcome.into_inner();
        Outcome {
            done: progress.written(),
            ..outcome.unwrap_or_else(PoisonError::into_inner)
        }
    }

    /// Waits for a frame and writes it; returns whether to continue.
    fn encode_next(&self, queue: &Mutex<Receiver<Rendered>>) -> bool {
        let Ok(rendered) = lock(queue).recv() else {
            return false;
        };
        if self.is_full() {
            return false;
        }
        let (frame, started) = (rendered.frame, rendered.started);
        match self.write(rendered) {
            Ok((verb, path)) => {
                lock(&self.outcome).written.insert(frame);
                let seconds = started.elapsed().as_secs_f64();
                lock(&self.progress).done(frame, verb, &path, seconds);
                true
            }
            Err(AppError::Interrupted(_)) => false,
            Err(AppError::Disk(why)) => {
                self.failed(frame, &why);
                lock(&self.outcome).full.get_or_insert(why);
                false
            }
            Err(error) => {
                let why = error.to_string();
                self.failed(frame, &why);
                lock(&self.outcome).failures.push((frame, why));
                // A film must have all its frames.
                !matches!(self.target, Target::Film(_))
            }
        }
    }

    fn write(&self, rendered: Rendered) -> Result<(&'static str, PathBuf), AppError> {
        let picture = match (rendered.picture, &self.denoiser) {
            (Rendering::Window(window), Some(denoiser)) => window.picture(self.gpu, denoiser)?,
            (Rendering::Window(_), None) => {
                return Err(AppError::Internal("a window without a denoiser".to_owned()));
            }
            (Rendering::Alone(pending), denoiser) => {
                let taken = pending.take(self.gpu);
                let mut picture = taken.map_err(|error| AppError::from_render(error, false))?;
                if let Some(denoiser) = denoiser {
                    denoiser.apply(&mut picture)?;
                }
                picture
            }
        };
        let picture = match self.crop {
            Some(crop) => picture.cropped(crop),
            None => picture,
        };
        let written = match self.target {
            Target::Film(film) => {
                let mut film = lock(film);
                film.add(&picture.display, shutdown::is_requested)?;
                ("added to", film.path().to_owned())
            }
            Target::Files { output, names } => {
                let name = &names[rendered.index];
                let own = output.renamed(name.clone());
                own.write_marked(&picture, Some(&rendered.mark))?;
                ("wrote", name.to_path_buf())
            }
        };
        lock(&self.outcome).last = Some(picture.stats);
        Ok(written)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
