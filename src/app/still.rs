//! `render` of one picture: its progress, its state on request, and its files.

use std::{
    cell::{Cell, RefCell},
    time::Instant,
};

use super::{
    args::RenderArgs, error::AppError, progress::PictureProgress, render_session::RenderSession,
    shutdown, stats,
};
use crate::{
    files::sweep,
    gpu::GpuError,
    output::{picture_file::PictureFile, stats::ReportContext},
    render::{Crop, Picture, RenderError, SoFar},
    scene::diagnostic::print_diagnostics,
};

/// Renders one picture, whose progress has begun; `load_ms` and the start of the command are for its statistics.
///
/// # Errors
/// Errors of the scene at its first frame, of rendering and of writing; [`AppError::Interrupted`] by a signal.
pub fn render(
    args: &RenderArgs,
    mut session: RenderSession,
    output: &PictureFile,
    progress: &PictureProgress,
    load_ms: f64,
    started: Instant,
) -> Result<(), AppError> {
    let planes: Vec<_> = session.aovs.iter().map(|aov| aov.plane_name()).collect();
    sweep(&output.files(&planes));
    let frame = session.scene.scene().scene.first_frame();
    let log = session.scene.pose(frame);
    for line in
        &log.map_err(|error| AppError::from_session(error, session.own_shaders.is_some()))?
    {
        reflet_base::error_line!("{line}");
    }
    print_diagnostics(&session.warn_of_empty());
    let samples = session.scene.scene().scene.image.samples;
    let partial = Partial::new(args, &session, output, progress);
    progress.begin(session.pictures(), samples);
    let pending = session.begin(output.has_color(), Some(&|so_far| partial.sample(so_far)));
    let picture = pending.and_then(|pending| pending.take(session.scene.gpu()));
    progress.end();
    let mut picture = match picture {
        Ok(picture) => picture,
        Err(error) => return Err(partial.error(error, session.own_shaders.is_some())),
    };
    if let Some(denoiser) = &session.denoiser {
        denoiser.apply(&mut picture)?;
    }
    if let Some(crop) = session.crop {
        picture = picture.cropped(crop);
    }
    if picture.stats.exhausted_rays > 0 {
        reflet_base::error_line!(
            "warning: {} rays visited too many nodes or surfaces and count as misses: too many of them overlap",
            picture.stats.exhausted_rays
        );
    }
    if let Some((sentence, _)) = session.samples_taken(&picture.stats) {
        reflet_base::error_line!("{sentence}");
    }
    let context = ReportContext {
        load_ms,
        first_picture_ms: started.elapsed().as_secs_f64() * 1e3,
    };

    let timeline = session.scene.scene().scene.timeline.as_ref();
    let part = timeline.map_or(String::new(), |timeline| {
        let count = timeline.end - timeline.start + 1;
        format!(" (frame {frame} of {count}; all with --frames all)")
    });
    for path in output.write(&picture)? {
        reflet_base::error_line!("wrote {}{part}", path.display());
    }
    progress.wrote(frame, args.output());
    stats::print(args, &mut session, picture.stats, context)
}

/// Writer of a picture while it is rendered.
struct Partial<'a> {
    args: &'a RenderArgs,
    output: &'a PictureFile,
    progress: &'a PictureProgress,
    crop: Option<Crop>,
    /// Time at which the picture was written, or begun.
    written: Cell<Instant>,
    /// The finished picture of fewer samples, where an error bound asks for one of more.
    before: RefCell<Option<Picture>>,
    /// Reason why the picture ends early.
    ended: RefCell<Option<AppError>>,
}

impl<'a> Partial<'a> {
    fn new(
        args: &'a RenderArgs,
        session: &RenderSession,
        output: &'a PictureFile,
        progress: &'a PictureProgress,
    ) -> Self {
        if args.keep_partial {
            shutdown::listen();
        }
        Self {
            args,
            output,
            progress,
            crop: session.crop,
            written: Cell::new(Instant::now()),
            before: RefCell::default(),
            ended: RefCell::default(),
        }
    }

    /// Reports a sample, and writes the picture so far where that is due.
    fn sample(&self, so_far: &SoFar<'_>) -> Result<(), RenderError> {
        self.progress.sample(so_far);
        let is_own = so_far.light.is_none();
        let every = self.args.write_every;
        if is_own && so_far.done == so_far.samples {
            if self.args.keep_partial || every.is_some() {
                self.before.replace(Some(so_far.picture()?));
            }
            return Ok(());
        }
        let is_stopped = self.args.keep_partial && shutdown::is_requested();
        let is_due = every.is_some_and(|every| self.written.get().elapsed() >= every);
        if !is_stopped && !is_due {
            return Ok(());
        }
        let newest = is_own.then(|| so_far.picture()).transpose()?;
        let before = self.before.borrow();
        let all = newest.iter().chain(before.iter());
        let Some(best) = all.max_by_key(|picture| picture.stats.samples) else {
            return Ok(()); // light groups come after the picture
        };
        let written = self.write(best);
        let done = best.stats.samples;
        self.written.set(Instant::now());
        let ended = match written {
            Err(error) => error,
            Ok(()) if is_stopped => {
                let (path, of) = (self.args.output().display(), so_far.samples);
                let picture = &self.args.picture;
                let lacks = match picture.denoise || !picture.aov.is_empty() {
                    true => ", without AOVs and not denoised",
                    false => "",
                };
                let text = format!("stopped: wrote {path} after {done} of {of} samples{lacks}");
                AppError::Interrupted(text)
            }
            Ok(()) => return Ok(()),
        };
        self.ended.replace(Some(ended));
        Err(GpuError::Interrupted.into())
    }

    fn write(&self, picture: &Picture) -> Result<(), AppError> {
        let cropped = self.crop.map(|crop| picture.clone().cropped(crop));
        self.output.write(cropped.as_ref().unwrap_or(picture))?;
        Ok(())
    }

    /// Error of a picture that has failed or was ended.
    fn error(self, error: RenderError, own_shaders: bool) -> AppError {
        let ended = self.ended.into_inner();
        ended.unwrap_or_else(|| AppError::from_render(error, own_shaders))
    }
}
