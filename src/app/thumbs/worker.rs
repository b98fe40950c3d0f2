//! A process that shows files by one device.

use std::{
    io::{self, Write as _},
    path::Path,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Instant,
};

use super::{ThumbsArgs, late, picture_of, process::Event};
use crate::{
    app::{
        AppError, args::RenderArgs, cameras, render::overrides, render_session::RenderSession,
        shutdown,
    },
    gpu::{Gpu, GpuError, ShaderLibrary, driver::open_gpu},
    output::{picture_file::PictureFile, writable::inputs},
    runtime::{
        catch_panic::catch_panic,
        scene_text::{LoadedScene, SceneText},
    },
    scene::{
        dependencies::Dependencies,
        diagnostic::{Diagnostic, Severity},
    },
};

/// Maximum number of pictures that are made at a time.
const MOST_AT_ONCE: usize = 4;

/// Shows the files of the arguments, and says on standard output what becomes of each. A file that fails by the device, which
/// others may have used up, ends the process without a word about it.
///
/// # Errors
/// No usable adapter, a closed standard output.
pub fn work(args: &ThumbsArgs, library: &ShaderLibrary) -> Result<(), AppError> {
    let gpu = Arc::new(open_gpu(args.picture.adapter.as_deref(), false)?);
    let files = Mutex::new(args.files.iter().enumerate());
    let is_over = AtomicBool::new(false);
    let next = || {
        let is_over = is_over.load(Ordering::Relaxed) || shutdown::is_requested();
        let mut files = files.lock().unwrap_or_else(PoisonError::into_inner);
        files.next().filter(|_| !is_over)
    };
    let work = || {
        while let Some((index, file)) = next() {
            say(index, &Event::Begun)?;
            match show(&gpu, args, file, library) {
                Ok(()) => say(index, &Event::Made)?,
                Err(AppError::Disk(text)) => {
                    is_over.store(true, Ordering::Relaxed);
                    say(index, &Event::DiskFull(text))?;
                }
                Err(AppError::Gpu(GpuError::Lost(_) | GpuError::OutOfMemory(_)))
                    if args.files.len() > 1 =>
                {
                    is_over.store(true, Ordering::Relaxed);
                }
                Err(_) if shutdown::is_requested() => {}
                Err(error) => say(index, &Event::Failed(reason(&error)))?,
            }
        }
        Ok(())
    };
    let at_once = thread::available_parallelism().map_or(1, |n| n.get().min(MOST_AT_ONCE));
    thread::scope(|scope| {
        let threads: Vec<_> = (0..at_once).map(|_| scope.spawn(work)).collect();
        let ends = threads.into_iter().map(|thread| thread.join());
        let ends: Vec<_> = ends
            .map(|end| end.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect();
        ends.into_iter().collect()
    })
}

/// Says an event of a file to the process that started this process.
fn say(index: usize, event: &Event) -> Result<(), AppError> {
    let line = serde_json::json!([index, event]);
    let said = writeln!(io::stdout().lock(), "{line}");
    said.map_err(|error| AppError::Internal(format!("standard output: {error}")))
}

/// The first error of a scene with its place and help, or the message of another error.
fn reason(error: &AppError) -> String {
    let messages = match error {
        AppError::Scene(messages) => messages.as_slice(),
        _ => &[],
    };
    let is_error = |message: &&Diagnostic| message.severity == Severity::Error;
    let Some(first) = messages.iter().find(is_error) else {
        return error.to_string();
    };
    let source = first
        .span
        .source
        .as_ref()
        .filter(|source| !source.generated);
    let place = source.and_then(|_| first.span.in_words());
    let place = place.map_or(String::new(), |place| format!(", at {place}"));
    let help = first
        .help
        .as_ref()
        .map_or(String::new(), |help| format!("; {help}"));
    format!("{}{place}{help}", first.message)
}

/// Reads, renders and writes the picture of a file, unless that takes longer than the timeout.
fn show(
    gpu: &Arc<Gpu>,
    thumbs: &ThumbsArgs,
    file: &Path,
    library: &ShaderLibrary,
) -> Result<(), AppError> {
    let began = Instant::now();
    let is_late = || began.elapsed() > thumbs.timeout;
    let loaded = read(thumbs, file)?;
    let picture = &thumbs.picture;
    let camera = cameras::first(&loaded, picture.camera.as_deref())?;
    let args = RenderArgs::for_pictures(Some(file), picture);
    let inputs = inputs([file], &loaded);
    let mut session = RenderSession::with_gpu(gpu, &args, loaded, camera, Vec::new(), library)?;
    let first = session.scene.scene().scene.first_frame();
    let shown = session.picture(
        first,
        Some(&|_| match is_late() || shutdown::is_requested() {
            true => Err(GpuError::Interrupted.into()),
            false => Ok(()),
        }),
    );
    let shown = shown.map_err(|error| match is_late() {
        true => AppError::Usage(late(thumbs.timeout)),
        false => error,
    })?;
    let goal = picture_of(thumbs, file);
    goal.make_folders()
        .map_err(|error| AppError::unwritten(&goal, &error))?;
    let output = PictureFile::new(&goal)?;
    output.check_files(&[], &inputs)?;
    output.write(&shown)?;
    Ok(())
}

/// Reads a file, without a word about its warnings.
fn read(args: &ThumbsArgs, file: &Path) -> Result<LoadedScene, AppError> {
    let picture = args.picture.lit(Some(file))?;
    let more = overrides(&picture, Some(file))?;
    let loaded = catch_panic(file, || {
        let text = SceneText::read(Some(file), &picture.from.options())?;
        let name = text.name();
        text.open(&more, &Dependencies::default())?.load(name)
    });
    loaded.map_err(AppError::Scene)
}
