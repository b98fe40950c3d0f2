//! Frame sequences: the scene is loaded once, frames are posed and submitted in order; readback,
//! encoding and writing overlap with later frames.

use std::{
    borrow::Cow,
    sync::{Arc, Mutex, PoisonError},
    thread,
    time::Instant,
};

use super::{
    args::RenderArgs,
    encoder::{Encoders, Failures, Outcome, Rendered, Rendering, Target},
    error::AppError,
    progress::Progress,
    project::make_folder,
    render_session::RenderSession,
    shutdown, stats,
};
use crate::{
    files::{Goal, Inputs, sweep},
    gpu::GpuError,
    output::{
        denoise::window::{FrameError, KeptFrames},
        fingerprint::{self, RunSettings},
        format::Format,
        frame_name::Template,
        frames::FrameList,
        picture_file::PictureFile,
        stats::ReportContext,
        video::Film,
        writable::check_writable,
    },
    render::{PendingPicture, RenderError, picture::aov::Aov},
    scene::{desc::TimelineDesc, diagnostic::print_diagnostics, stages::Animator},
};

/// Whether a command renders a sequence of frames instead of one picture.
///
/// # Errors
/// Same errors as [`Template::new`]; [`AppError::Usage`] for an unknown extension, and a film with a frame
/// number.
pub fn is_sequence(args: &RenderArgs) -> Result<bool, AppError> {
    let template = Template::new(args.output())?;
    let format = Format::expect(args.output())?;
    if matches!(format, Format::Film(_)) && template.is_some() {
        return Err(AppError::Usage(format!(
            "--output {}: a film is one file, so its name has no frame number; for frames write such \
             as film.####.png",
            args.output().display()
        )));
    }
    Ok(args.frames.is_some() || template.is_some() || Format::is_film(args.output()))
}

/// The frames of a command, from its arguments and the timeline.
///
/// # Errors
/// [`AppError::Usage`] for frames outside of the timeline, or frames that share a file.
pub fn choose(args: &RenderArgs, timeline: Option<&TimelineDesc>) -> Result<FrameList, AppError> {
    let Some(timeline) = timeline else {
        return Err(AppError::Usage(
            "the scene has no [timeline], so it has no frames; write `[timeline]` with `end = 47`"
                .to_owned(),
        ));
    };
    let all = FrameList::parse(
        "--frames",
        args.frames.as_deref().unwrap_or("all"),
        timeline,
    )?;
    let frames = all.shard(args.shard);
    let in_one_file = Format::is_film(args.output());
    if in_one_file && (args.resume || args.shard.is_some()) {
        return Err(AppError::Usage(
            "--resume and --shard need one file per frame, such as film.####.png".to_owned(),
        ));
    }
    if in_one_file && !args.picture.aov.is_empty() {
        return Err(AppError::Usage(
            "--aov does not apply to a film; write frames".to_owned(),
        ));
    }
    if args.stats.is_some() && (frames.0.len() != 1 || args.resume) {
        let first = frames.0.first().unwrap_or(&timeline.start);
        return Err(AppError::Usage(format!(
            "--stats applies to one frame that is rendered; write --frames {first}, without --resume"
        )));
    }
    let has_number = in_one_file || Template::new(args.output())?.is_some();
    if !has_number && frames.0.len() > 1 {
        let shown = args.output().display();
        let stem = args.output().with_extension("").display().to_string();
        let ending = args.output().extension().unwrap_or_default().display();
        return Err(AppError::Usage(format!(
            "--output {shown}: {} frames would be written to one file; write {stem}.####.{ending}",
            frames.0.len()
        )));
    }
    Ok(frames)
}

/// Checks the output paths before rendering. The last folder of a path is created if missing.
///
/// # Errors
/// [`AppError::Usage`] for a path that cannot be written, one that leads to one of the `inputs`, and for an empty list
/// of frames.
pub fn check_output(
    args: &RenderArgs,
    frames: &FrameList,
    aovs: &[Aov],
    inputs: &Inputs,
) -> Result<(), AppError> {
    if Format::is_film(args.output()) {
        return Ok(check_writable(args.output(), inputs)?);
    }
    let Some(first) = frames.0.first() else {
        return Err(AppError::Usage(
            "--shard: there are no frames in this part; choose fewer parts".to_owned(),
        ));
    };
    let template = Template::new(args.output())?;
    if template.is_some() {
        make_folder(args.output())?;
    }
    // The largest frame number has the longest name.
    let last = frames.0.iter().max().unwrap_or(first);
    let name = |frame: u32| {
        let own = template.as_ref().map(|t| t.path(frame));
        own.map_or_else(|| args.output().clone(), |path| args.output().renamed(path))
    };
    let output = PictureFile::new(&name(*last))?;
    let mut frames = frames.0.iter();
    Ok(frames.try_for_each(|frame| output.renamed(name(*frame)).check_files(aovs, inputs))?)
}

/// Choices of a command beside its scene.
fn run_settings(args: &RenderArgs, session: &RenderSession) -> RunSettings {
    RunSettings {
        built_from: env!("REFLET_BUILT_FROM"),
        camera: args.picture.camera.clone().unwrap_or_default(),
        crop: args.picture.crop,
        denoise: args.picture.denoise,
        window: session.window,
        aovs: args.picture.aov.clone(),
        own_shaders: session.own_shaders,
    }
}

/// Renders the frames; `load_ms` and the start of the command are for statistics.
///
/// # Errors
/// [`AppError::Frames`] with the failed frames; all others are written. [`AppError::Unwritten`] for
/// a full disk. For a video file [`AppError::NoFilm`] and [`AppError::Disk`] instead.
pub fn render(
    args: &RenderArgs,
    mut session: RenderSession,
    frames: &FrameList,
    load_ms: f64,
    command: Instant,
) -> Result<(), AppError> {
    session.denoise_over(args.picture.denoise_window);
    let run = fingerprint::of_run(&run_settings(args, &session), &session.scene)?;
    let mut progress = Progress::new(frames.0.len(), args.progress);
    let target = target(args, &session, frames)?;
    let planes: Vec<_> = session.aovs.iter().map(|aov| aov.plane_name()).collect();
    sweep(&files_of(&target, args, &planes));
    let mut wanted = Vec::new();
    for (index, frame) in frames.0.iter().enumerate() {
        let mark = fingerprint::of_frame(run, *frame);
        match &target {
            Target::Files { output, names }
                if args.resume && output.renamed(names[index].clone()).is_done(&planes, &mark) =>
            {
                progress.keep(*frame, &names[index]);
            }
            _ => wanted.push((index, *frame, mark)),
        }
    }
    shutdown::listen();
    let gpu = Arc::clone(session.scene.gpu());
    let denoiser = session.denoiser.clone();
    let encoders = Encoders::new(&gpu, &target, progress, denoiser, session.crop);
    let scene = Arc::clone(&session.scene.scene().scene);
    let animator = Animator::new(&scene);
    let has_color = matches!(&target, Target::Files { output, .. } if output.has_color());
    let asked: Vec<u32> = wanted.iter().map(|(_, frame, _)| *frame).collect();
    let failures = thread::scope(|scope| {
        let sender = encoders.spawn(scope);
        let mut failures = Failures::new();
        let mut kept = KeptFrames::default();
        for (index, frame, mark) in wanted {
            if shutdown::is_requested() || encoders.is_full() {
                break;
            }
            let started = Instant::now();
            let begin = |session: &mut RenderSession, frame| {
                begin_frame(session, &animator, frame, has_color, &encoders)
            };
            match rendering(&mut session, &mut kept, frame, &begin) {
                Ok(picture) => {
                    let rendered = Rendered {
                        index,
                        frame,
                        picture,
                        mark,
                        started,
                    };
                    if sender.send(rendered).is_err() {
                        break; // the encoders have failed and report it
                    }
                }
                Err((why, fatal)) => {
                    encoders.failed(frame, &why);
                    failures.push((frame, why));
                    if fatal || matches!(target, Target::Film(_)) {
                        break;
                    }
                }
            }
        }
        failures
    });
    let mut outcome = encoders.finish();
    let last = outcome.last.take();
    check_outcome(outcome, &target, failures, asked, frames.0.len())?;
    if let Target::Film(film) = target {
        let film = film.into_inner();
        let film = film.map_err(|_| AppError::Internal("the encoder has failed".to_owned()))?;
        let path = film.finish(shutdown::is_requested)?;
        reflet_base::error_line!("wrote {}", path.display());
    }
    let context = ReportContext {
        load_ms,
        first_picture_ms: command.elapsed().as_secs_f64() * 1e3,
    };
    last.map_or(Ok(()), |last| {
        stats::print(args, &mut session, last, context)
    })
}

/// Files to write, AOVs included.
fn files_of(target: &Target, args: &RenderArgs, planes: &[Cow<'static, str>]) -> Vec<Goal> {
    match target {
        Target::Film(_) => vec![args.output().clone()],
        Target::Files { output, names } => {
            let files = names.iter().cloned().map(|name| output.renamed(name));
            files.flat_map(|file| file.files(planes)).collect()
        }
    }
}

/// Checks that every frame was written; `failures` could not be rendered, `asked` were requested,
/// of `total`.
fn check_outcome(
    outcome: Outcome,
    target: &Target,
    mut failures: Failures,
    asked: Vec<u32>,
    total: usize,
) -> Result<(), AppError> {
    failures.extend(outcome.failures);
    failures.sort();
    if let Some(why) = outcome.full {
        if matches!(target, Target::Film(_)) {
            return Err(AppError::Disk(why));
        }
        if !failures.is_empty() {
            AppError::Frames(failures).print();
        }
        let mut missing = asked;
        missing.retain(|frame| !outcome.written.contains(frame));
        missing.sort_unstable();
        return Err(AppError::Unwritten { why, missing });
    }
    if shutdown::is_requested() && outcome.done < total {
        return Err(stopped(target, outcome.done, total, failures));
    }
    match target {
        _ if failures.is_empty() => Ok(()),
        Target::Files { .. } => Err(AppError::Frames(failures)),
        Target::Film(film) => {
            let mut untried = asked;
            let failed = |frame| failures.iter().any(|(failed, _)| *failed == frame);
            untried.retain(|frame| !outcome.written.contains(frame) && !failed(*frame));
            untried.sort_unstable();
            let film = film.lock().unwrap_or_else(PoisonError::into_inner);
            let path = film.path().to_owned();
            Err(AppError::NoFilm {
                path,
                failures,
                untried,
            })
        }
    }
}

/// Error of an interrupted command.
fn stopped(target: &Target, done: usize, total: usize, failures: Failures) -> AppError {
    if !failures.is_empty() {
        // Scene errors first: they matter more than the interruption.
        AppError::Frames(failures).print();
    }
    AppError::Interrupted(match target {
        Target::Film(_) => format!("stopped after {done} of {total} frames; no film was written"),
        Target::Files { .. } => {
            format!("stopped: {done} of {total} frames are written; add --resume to continue")
        }
    })
}

/// Destination of the frames, checked.
fn target(
    args: &RenderArgs,
    session: &RenderSession,
    frames: &FrameList,
) -> Result<Target, AppError> {
    let desc = &session.scene.scene().scene;
    if let Format::Film(format) = Format::expect(args.output())? {
        let fps = desc.timeline.as_ref().map_or(24.0, |t| t.fps);
        let size = session.crop.map_or(desc.image.size, |crop| crop.size);
        let film = Film::new(args.output(), format, size, fps, frames.0.len())?;
        if desc.image.alpha {
            reflet_base::error_line!(
                "warning: a film is opaque, so that `image.alpha` makes its background black; write frames (film.####.png)"
            );
        }
        return Ok(Target::Film(Box::new(Mutex::new(film))));
    }
    let template = Template::new(args.output())?;
    let name = |frame: &u32| {
        let own = template.as_ref().map(|t| t.path(*frame));
        own.map_or_else(|| args.output().clone(), |path| args.output().renamed(path))
    };
    let names: Vec<_> = frames.0.iter().map(name).collect();
    let first = names.first().unwrap_or(args.output());
    Ok(Target::Files {
        output: PictureFile::new(first)?,
        names,
    })
}

/// Starts rendering a frame and the frames that it is denoised with.
fn rendering(
    session: &mut RenderSession,
    kept: &mut KeptFrames,
    frame: u32,
    begin: &dyn Fn(&mut RenderSession, u32) -> Result<PendingPicture, FrameError>,
) -> Result<Rendering, FrameError> {
    if session.window == 0 {
        return Ok(Rendering::Alone(Box::new(begin(session, frame)?)));
    }
    let window = kept.around(frame, session.window_of(frame), |frame| {
        let picture = begin(session, frame)?;
        Ok((picture, session.frame_pose()))
    })?;
    Ok(Rendering::Window(window))
}

/// Starts rendering a frame; the error says whether it is fatal for all frames.
fn begin_frame(
    session: &mut RenderSession,
    animator: &Animator,
    frame: u32,
    has_color: bool,
    encoders: &Encoders,
) -> Result<PendingPicture, FrameError> {
    let scene_error = |errors: Vec<crate::scene::diagnostic::Diagnostic>| {
        encoders.print_above(|| print_diagnostics(&errors));
        let first = errors.first().map(|e| e.message.clone());
        (first.unwrap_or_default(), false)
    };
    let state = animator.pose(frame).map_err(scene_error)?;
    for line in &state.log {
        encoders.print_above(|| reflet_base::error_line!("frame {frame}: {line}"));
    }
    let posed = session.scene.apply(frame, Some(state), &|_| ());
    posed.map_err(scene_error)?;
    let empty = session.warn_of_empty();
    encoders.print_above(|| print_diagnostics(&empty));
    let picture = session.begin(has_color, None).map_err(|error| {
        let fatal = matches!(
            error,
            RenderError::Gpu(GpuError::Lost(_) | GpuError::OutOfMemory(_))
        );
        (
            AppError::from_render(error, session.own_shaders.is_some()).to_string(),
            fatal,
        )
    })?;
    if let Some((sentence, false)) = session.samples_taken(picture.stats()) {
        encoders.print_above(|| reflet_base::error_line!("frame {frame}: {sentence}"));
    }
    Ok(picture)
}
