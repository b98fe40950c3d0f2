//! Many frames of one scene: loaded once, posed and rendered in turn, encoded on a thread while the
//! next one renders.

use std::{
    path::PathBuf,
    sync::mpsc::{Receiver, sync_channel},
    thread,
    time::Instant,
};

use super::{
    cli::RenderArgs,
    error::{AppError, print_diagnostics},
    film::{Film, is_film},
    fingerprint,
    frames::{FrameList, Template},
    output::{Output, check_writable},
    progress::Progress,
    render::{Studio, explain},
};
use crate::{
    files::sweep,
    gpu::GpuError,
    render::{Picture, RenderError},
    scene::{desc::TimelineDesc, motion::Motion},
};

/// Pictures that may wait for their encoder.
const WAITING: usize = 2;

/// Whether a command asks for frames of a film and not for one picture.
///
/// # Errors
/// As [`Template::new`].
pub fn is_wanted(args: &RenderArgs) -> Result<bool, AppError> {
    let template = Template::new(&args.output)?;
    Ok(args.frames.is_some() || template.is_some() || is_film(&args.output))
}

/// Where the frames go.
enum Target {
    /// A file for each.
    Files { output: Output, names: Vec<PathBuf> },
    /// All in one.
    Film(Box<Film>),
}

/// A rendered frame on its way to its file.
struct Finished {
    /// In the list of frames.
    index: usize,
    frame: u32,
    picture: Picture,
    mark: String,
    started: Instant,
}

/// What rendering and encoding leave behind.
type Failures = Vec<(u32, String)>;

/// The frames of a command, and the timeline that they are of.
///
/// # Errors
/// [`AppError::Usage`] for frames that the scene does not have, or that would share a file.
pub fn choose(args: &RenderArgs, timeline: Option<&TimelineDesc>) -> Result<FrameList, AppError> {
    let Some(timeline) = timeline else {
        return Err(AppError::Usage(
            "the scene has no [timeline], so it has no frames; write `[timeline]` with `end = 47`"
                .to_owned(),
        ));
    };
    let all = FrameList::parse(args.frames.as_deref().unwrap_or("all"), timeline)?;
    let frames = all.shard(args.shard);
    let in_one_file = is_film(&args.output);
    if in_one_file && (args.resume || args.shard.is_some()) {
        return Err(AppError::Usage(
            "--resume and --shard are for frames in files of their own, such as film.####.png"
                .to_owned(),
        ));
    }
    if in_one_file && !args.aov.is_empty() {
        return Err(AppError::Usage(
            "--aov does not go with a film; write frames".to_owned(),
        ));
    }
    if args.stats.is_some() {
        return Err(AppError::Usage("--stats is for one picture".to_owned()));
    }
    let has_number = in_one_file || Template::new(&args.output)?.is_some();
    if !has_number && frames.0.len() > 1 {
        let shown = args.output.display();
        let stem = args.output.with_extension("").display().to_string();
        let ending = args.output.extension().unwrap_or_default().display();
        return Err(AppError::Usage(format!(
            "--output {shown}: {} frames would go to one file; write {stem}.####.{ending}",
            frames.0.len()
        )));
    }
    Ok(frames)
}

/// Checks where the frames would go, before anything is rendered.
///
/// # Errors
/// [`AppError::Usage`] for a path that cannot be written.
pub fn check_output(args: &RenderArgs, frames: &FrameList) -> Result<(), AppError> {
    if is_film(&args.output) {
        return check_writable(&args.output);
    }
    let Some(first) = frames.0.first() else {
        return Ok(());
    };
    let template = Template::new(&args.output)?;
    Output::new(&template.map_or_else(|| args.output.clone(), |t| t.path(*first))).map(drop)
}

/// Renders the frames.
///
/// # Errors
/// [`AppError::Frames`] with those that failed; the others are there.
pub fn render(args: &RenderArgs, mut studio: Studio, frames: &FrameList) -> Result<(), AppError> {
    let run = fingerprint::of_run(args, &studio.loaded, &studio.gpu)?;
    let mut progress = Progress::new(frames.0.len(), args.progress);
    let mut target = target(args, &studio, frames)?;
    if let (true, Target::Files { names, .. }) = (args.resume, &target) {
        sweep(names);
    }
    let planes: Vec<_> = studio.aovs.iter().map(|aov| aov.name()).collect();
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
    let (sender, receiver) = sync_channel(WAITING);
    let in_one_file = matches!(target, Target::Film(_));
    let desc = studio.loaded.desc.clone();
    let motion = Motion::new(&desc);
    let mut failures = thread::scope(|scope| {
        let target = &mut target;
        let encoder = scope.spawn(move || encode(target, &receiver, progress));
        let mut failures = Failures::new();
        for (index, frame, mark) in wanted {
            let started = Instant::now();
            match picture(&mut studio, &motion, frame) {
                Ok(picture) => {
                    let finished = Finished {
                        index,
                        frame,
                        picture,
                        mark,
                        started,
                    };
                    if sender.send(finished).is_err() {
                        break; // the encoder has failed, and says so
                    }
                }
                Err((why, fatal)) => {
                    failures.push((frame, why));
                    if fatal || in_one_file {
                        break;
                    }
                }
            }
        }
        drop(sender);
        let encoded = encoder
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        failures.extend(encoded);
        failures
    });
    failures.sort();
    if !failures.is_empty() {
        return Err(AppError::Frames(failures));
    }
    if let Target::Film(film) = target {
        eprintln!("wrote {}", film.finish()?.display());
    }
    Ok(())
}

fn target(args: &RenderArgs, studio: &Studio, frames: &FrameList) -> Result<Target, AppError> {
    let desc = &studio.loaded.desc;
    if is_film(&args.output) {
        let fps = desc.timeline.as_ref().map_or(24.0, |t| t.fps);
        let film = Film::new(&args.output, desc.image.size, fps, frames.0.len())?;
        return Ok(Target::Film(Box::new(film)));
    }
    let template = Template::new(&args.output)?;
    let name = |frame: &u32| {
        let own = template.as_ref().map(|t| t.path(*frame));
        own.unwrap_or_else(|| args.output.clone())
    };
    let names: Vec<_> = frames.0.iter().map(name).collect();
    let first = names.first().unwrap_or(&args.output);
    Ok(Target::Files {
        output: Output::new(first)?,
        names,
    })
}

/// Writes frames as they come.
fn encode(target: &mut Target, receiver: &Receiver<Finished>, mut progress: Progress) -> Failures {
    let mut failures = Failures::new();
    for finished in receiver {
        let Finished {
            index,
            frame,
            picture,
            mark,
            started,
        } = finished;
        let result = match target {
            Target::Film(film) => film
                .add(&picture.display)
                .map(|()| ("added to", film.goal().to_owned())),
            Target::Files { output, names } => {
                let name = names[index].clone();
                let own = output.renamed(name.clone());
                own.write_marked(&picture, Some(&mark))
                    .map(|_| ("wrote", name))
            }
        };
        match result {
            Ok((verb, path)) => {
                progress.done(frame, verb, &path, started.elapsed().as_secs_f64());
            }
            Err(error) => {
                failures.push((frame, error.to_string()));
                if matches!(target, Target::Film(_)) {
                    break;
                }
            }
        }
    }
    failures
}

/// One frame's picture; else why not, and whether no other will do better.
fn picture(studio: &mut Studio, motion: &Motion, frame: u32) -> Result<Picture, (String, bool)> {
    let wrong_scene = |errors: Vec<crate::scene::diagnostic::Diagnostic>| {
        print_diagnostics(&errors);
        let first = errors.first().map(|e| e.message.clone());
        (first.unwrap_or_default(), false)
    };
    let state = motion.pose(frame).map_err(wrong_scene)?;
    for line in &state.log {
        eprintln!("frame {frame}: {line}");
    }
    studio.loaded.world.apply(&state).map_err(wrong_scene)?;
    studio.picture().map_err(|error| {
        let fatal = matches!(
            error,
            RenderError::Gpu(GpuError::Lost(_) | GpuError::OutOfMemory(_))
        );
        (explain(error, studio.own_shaders).to_string(), fatal)
    })
}
