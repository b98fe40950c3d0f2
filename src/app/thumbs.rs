//! `thumbs`: a small picture of every model, panorama and scene of a folder, by one process with one device.

use std::{
    fmt::Display,
    fs,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        mpsc::{Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};

use clap::Args;
use reflet_base::standard_error::{end_work, show_work};

use super::{
    args::{PictureArgs, RenderArgs, SizeArg, parse_time},
    cameras,
    error::AppError,
    folder::files_of,
    render::overrides,
    render_session::RenderSession,
    shaders, shutdown,
};
use crate::{
    files::Goal,
    gpu::{Gpu, GpuError, ShaderLibrary, driver::open_gpu},
    output::{picture_file::PictureFile, writable::inputs},
    runtime::{
        catch_panic::catch_panic,
        scene_text::{LoadedScene, SceneText},
    },
    scene::{
        dependencies::Dependencies,
        diagnostic::{Diagnostic, Severity, printable_lines},
    },
};

/// Width and height of the pictures without `--size`.
const SIDE_PX: u32 = 256;
/// Sub-frames of the pictures without `--samples`.
const SAMPLES: u32 = 8;
/// Maximum number of pictures that are made at a time.
const MOST_AT_ONCE: usize = 4;

/// Arguments of `thumbs`.
#[derive(Clone, Debug, Args)]
pub struct ThumbsArgs {
    /// Folder whose models, panoramas and scenes are shown, with the folders below; links to folders are not followed
    pub folder: PathBuf,
    /// Folder to write into: the picture of a/b.glb is a/b.glb.png
    #[arg(short, long, value_name = "DIR", value_hint = clap::ValueHint::DirPath)]
    pub output: Goal,
    /// Keep pictures that are newer than their file
    #[arg(long)]
    pub resume: bool,
    /// Time after which reading or rendering a file is given up, such as 90s or 2m
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = parse_time)]
    pub timeout: Duration,
    /// Settings of the pictures; without --size they have 256 x 256 pixels, without --samples 8 sub-frames
    #[command(flatten)]
    pub picture: PictureArgs,
}

/// A file to show.
struct Job {
    file: PathBuf,
    picture: Goal,
}

/// Renders a picture of each file.
///
/// # Errors
/// [`AppError::Usage`] for a folder without files to show, no usable adapter, a full disk, [`AppError::NoPicture`] after
/// all others where some files have none; each is reported when it fails.
pub fn thumbs(args: &ThumbsArgs) -> Result<(), AppError> {
    let mut picture = args.picture.clone();
    picture.lit(None)?; // its panorama is there
    if !picture.aov.is_empty() || picture.crop.is_some() || picture.turntable.is_some() {
        let text = "--aov, --crop and --turntable do not apply to thumbs";
        return Err(AppError::Usage(text.to_owned()));
    }
    picture.size.get_or_insert(SizeArg::Pixels([SIDE_PX; 2]));
    picture.samples.get_or_insert(SAMPLES);
    let library = shaders::library(picture.shaders.as_deref())?;
    let mut failed = 0;
    let mut jobs = jobs(args, &mut failed)?;
    let all = jobs.len() + failed;
    jobs.retain(|job| !is_kept(args, job));
    let kept = all - failed - jobs.len();
    fs::create_dir_all(&*args.output).map_err(|error| AppError::unwritten(&args.output, &error))?;
    shutdown::listen();
    let gpu = Mutex::new(open(&picture)?);
    let jobs = Mutex::new(jobs.into_iter());
    let at_once = thread::available_parallelism().map_or(1, |n| n.get().min(MOST_AT_ONCE));
    let show = |job: &Job, gpu: &Arc<Gpu>| {
        let loaded = read(job, &picture, args.timeout)?;
        render(gpu, args, &picture, loaded, job, &library)
    };
    let work = |results: Sender<(Job, Arc<Gpu>, Result<(), AppError>)>| {
        let next = || lock(&jobs).next().filter(|_| !shutdown::is_requested());
        while let Some(job) = next() {
            let gpu = lock(&gpu).clone();
            let shown = show(&job, &gpu);
            if results.send((job, gpu, shown)).is_err() {
                return; // the command has failed
            }
        }
    };
    let mut made = 0;
    thread::scope(|scope| {
        let (sender, results) = channel();
        for _ in 0..at_once {
            let sender = sender.clone();
            scope.spawn(|| work(sender));
        }
        drop(sender);
        for (job, used, mut shown) in results {
            let number = kept + failed + made + 1;
            show_work(format_args!("{number} of {all}: {}", job.file.display()));
            if let Err(AppError::Gpu(GpuError::Lost(_) | GpuError::OutOfMemory(_))) = shown {
                // Another file may have used up the device: this file is tried on a new device.
                let mut gpu = lock(&gpu);
                if Arc::ptr_eq(&gpu, &used) {
                    *gpu = open(&picture)?;
                }
                let new = gpu.clone();
                drop(gpu);
                shown = show(&job, &new);
            }
            end_work();
            match shown {
                Ok(()) => made += 1,
                Err(error @ AppError::Disk(_)) => return Err(error),
                Err(_) if shutdown::is_requested() => {}
                Err(error) => report(&job.file, &reason(&error), &mut failed),
            }
        }
        Ok(())
    })?;
    if shutdown::is_requested() {
        let text = format!("stopped after {made} pictures; --resume goes on with the others");
        return Err(AppError::Interrupted(text));
    }
    reflet_base::error_line!("wrote {made} of {all} pictures, kept {kept}");
    match failed {
        0 => Ok(()),
        failed => Err(AppError::NoPicture { failed, all }),
    }
}

/// The device of all pictures.
fn open(picture: &PictureArgs) -> Result<Arc<Gpu>, AppError> {
    Ok(Arc::new(open_gpu(picture.adapter.as_deref(), false)?))
}

/// Names a file that has no picture, with the reason.
fn report(file: &Path, error: &dyn Display, failed: &mut usize) {
    let text = printable_lines(&format!("{}: {error}", file.display())).replace('\n', " ");
    reflet_base::error_line!("error: {text}");
    *failed += 1;
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

fn late(timeout: Duration) -> AppError {
    let seconds = timeout.as_secs_f64();
    AppError::Usage(format!("it takes longer than {seconds} s (--timeout)"))
}

/// The files of the folder in order of their paths; folders that cannot be read are reported.
fn jobs(args: &ThumbsArgs, failed: &mut usize) -> Result<Vec<Job>, AppError> {
    if args.folder.is_file() {
        let file = args.folder.display();
        let text = format!(
            "{file} is a file: write the folder that has it, or `reflet render {file} -o picture.png`"
        );
        return Err(AppError::Usage(text));
    }
    let files = files_of(&args.folder, &mut |file, why| report(file, why, failed))?;
    let job = |file: PathBuf| {
        let below = file.strip_prefix(&args.folder).unwrap_or(&file);
        let mut picture = args.output.join(below).into_os_string();
        picture.push(".png");
        let picture = args.output.renamed(picture.into());
        Job { file, picture }
    };
    Ok(files.into_iter().map(job).collect())
}

/// Whether the picture of a job is newer than its file, and such pictures are kept.
fn is_kept(args: &ThumbsArgs, job: &Job) -> bool {
    let time = |path: &Path| fs::metadata(path).and_then(|found| found.modified()).ok();
    args.resume && time(&job.picture).is_some_and(|picture| Some(picture) > time(&job.file))
}

/// Reads the file of a job, without a word about its warnings; a thread that reads for longer than the timeout is left
/// alone.
fn read(job: &Job, picture: &PictureArgs, timeout: Duration) -> Result<LoadedScene, AppError> {
    let (sender, loaded) = channel();
    let (file, picture) = (job.file.clone(), picture.clone());
    thread::spawn(move || {
        let loaded = picture.lit(Some(&file)).and_then(|picture| {
            let more = overrides(&picture, Some(&file))?;
            let loaded = catch_panic(&file, || {
                let text = SceneText::read(Some(&file), &picture.from.options())?;
                let name = text.name();
                text.open(&more, &Dependencies::default())?.load(name)
            });
            loaded.map_err(AppError::Scene)
        });
        let _ = sender.send(loaded); // nobody waits for it any more
    });
    (loaded.recv_timeout(timeout)).unwrap_or_else(|_| Err(late(timeout)))
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Renders and writes the picture of a scene, unless rendering takes longer than the timeout.
fn render(
    gpu: &Arc<Gpu>,
    thumbs: &ThumbsArgs,
    picture: &PictureArgs,
    loaded: LoadedScene,
    job: &Job,
    library: &ShaderLibrary,
) -> Result<(), AppError> {
    let began = Instant::now();
    let camera = cameras::first(&loaded, picture.camera.as_deref())?;
    let args = RenderArgs::for_pictures(Some(&job.file), picture);
    let inputs = inputs([job.file.as_path()], &loaded);
    let mut session = RenderSession::with_gpu(gpu, &args, loaded, camera, Vec::new(), library)?;
    let first = session.scene.scene().scene.first_frame();
    let is_late = || began.elapsed() > thumbs.timeout;
    let shown = session.picture(
        first,
        Some(&|_| match is_late() || shutdown::is_requested() {
            true => Err(GpuError::Interrupted.into()),
            false => Ok(()),
        }),
    );
    let late = |error| {
        if is_late() {
            late(thumbs.timeout)
        } else {
            error
        }
    };
    let shown = shown.map_err(late)?;
    let unwritten = |error| AppError::unwritten(&job.picture, &error);
    job.picture.make_folders().map_err(unwritten)?;
    let output = PictureFile::new(&job.picture)?;
    output.check_files(&[], &inputs)?;
    output.write(&shown)?;
    Ok(())
}
