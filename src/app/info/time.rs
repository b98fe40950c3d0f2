//! Expected time of a picture, by its first samples, and its memory.

use std::{
    cell::Cell,
    time::{Duration, Instant},
};

use serde::Serialize;

use crate::{
    app::{
        args::RenderArgs,
        error::AppError,
        progress::{Pace, about},
        render_session::RenderSession,
        shaders,
    },
    gpu::GpuError,
    output::stats::mebibytes,
    render::{SoFar, picture::aov::Aov},
    runtime::scene_text::LoadedScene,
};

/// Time over which samples after the first are timed at least, as a GPU needs milliseconds for one, seconds.
const TIMED_S: f64 = 1.0;

/// Time and memory of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PictureTime {
    /// Time of the picture with all its samples, with reading the scene, seconds.
    pub picture_s: f64,
    /// Whether it is expected by the first samples; false where all were rendered.
    pub is_expected: bool,
    /// Time of each sample but the first, seconds; `None` where the picture has too few.
    pub sample_s: Option<f64>,
    /// Memory of the adapter, bytes.
    pub adapter_bytes: u64,
}

impl PictureTime {
    /// Renders the first samples of a frame, whose scene was read in `load`.
    ///
    /// # Errors
    /// No usable adapter, a crop outside of the picture, and errors of rendering.
    pub fn measure(
        args: &RenderArgs,
        loaded: LoadedScene,
        camera: Option<usize>,
        aovs: Vec<Aov>,
        frame: u32,
        load: Duration,
    ) -> Result<Self, AppError> {
        let began = Instant::now();
        let seconds = || (load + began.elapsed()).as_secs_f64();
        let samples = loaded.scene.image.samples.count();
        let library = shaders::library(args.picture.shaders.as_deref())?;
        let mut session = RenderSession::new(args, loaded, camera, aovs, &library)?;
        let total = samples * session.pictures();
        let (pace, bytes, is_timed) = (Cell::new(Pace::default()), Cell::new(0), Cell::new(false));
        let each_sample = |so_far: &SoFar<'_>| {
            bytes.set(so_far.bytes());
            if so_far.light.is_none() {
                pace.set(pace.get().with(seconds(), so_far.done));
                is_timed.set(pace.get().timed_s() >= TIMED_S);
            }
            match is_timed.get() {
                true => Err(GpuError::Interrupted.into()),
                false => Ok(()),
            }
        };
        let rendered = session.picture(frame, Some(&each_sample));
        let end_s = pace.get().end_s(total).filter(|_| is_timed.get());
        let picture_s = match end_s {
            Some(end_s) => end_s,
            None => rendered.map(|_| seconds())?, // all samples were rendered
        };
        Ok(Self {
            picture_s,
            is_expected: end_s.is_some(),
            sample_s: pace.get().sample_s(),
            adapter_bytes: bytes.get(),
        })
    }

    /// The time in words.
    pub fn words(&self) -> String {
        let each_s = self.sample_s.filter(|_| self.is_expected);
        let each = each_s.map_or(String::new(), |each_s| {
            format!(" by its first samples, {each_s:.3} s each after the first")
        });
        let memory = mebibytes(self.adapter_bytes);
        format!("{}{each}; {memory} of the adapter", about(self.picture_s))
    }
}
