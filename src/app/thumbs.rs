//! `thumbs`: a small picture of every model, panorama and scene of a folder. A process shows many files by one device; the
//! command starts it, and starts another one where a file ends it or does not end.

mod process;
mod worker;

use std::{
    collections::VecDeque,
    fmt::Display,
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

use clap::Args;
use reflet_base::standard_error::{end_work, show_work};

use self::process::Event;
use super::{
    args::{PictureArgs, SizeArg, parse_time},
    error::AppError,
    folder::files_of,
    shaders, shutdown,
};
use crate::{
    files::{Goal, sweep},
    scene::diagnostic::printable_lines,
};

/// Width and height of the pictures without `--size`.
const SIDE_PX: u32 = 256;
/// Sub-frames of the pictures without `--samples`.
const SAMPLES: u32 = 8;
/// Maximum length of the paths of a process, which are its arguments, bytes: Windows takes 32 KiB of them.
const MOST_BYTES: usize = 24_000;

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
    /// Time after which a file is given up, such as 90s or 2m
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = parse_time)]
    pub timeout: Duration,
    /// Files of a process that the command starts
    #[arg(long = "file", hide = true)]
    pub files: Vec<PathBuf>,
    /// Settings of the pictures; without --size they have 256 x 256 pixels, without --samples 8 sub-frames
    #[command(flatten)]
    pub picture: PictureArgs,
}

/// Renders a picture of each file.
///
/// # Errors
/// [`AppError::Usage`] for a folder without files to show, no usable adapter, a full disk, [`AppError::NoPicture`] after
/// all others where some files have none; each is reported when it fails.
pub fn thumbs(args: &ThumbsArgs) -> Result<(), AppError> {
    let mut args = args.clone();
    let picture = &mut args.picture;
    picture.lit(None)?; // its panorama is there
    if !picture.aov.is_empty() || picture.crop.is_some() || picture.turntable.is_some() {
        let text = "--aov, --crop and --turntable do not apply to thumbs";
        return Err(AppError::Usage(text.to_owned()));
    }
    picture.size.get_or_insert(SizeArg::Pixels([SIDE_PX; 2]));
    picture.samples.get_or_insert(SAMPLES);
    let library = shaders::library(picture.shaders.as_deref())?;
    shutdown::listen();
    if !args.files.is_empty() {
        return worker::work(&args, &library);
    }
    let mut failed = 0;
    let mut files = files(&args, &mut failed)?;
    let all = files.len() + failed;
    files.retain(|file| !is_kept(&args, file));
    let kept = all - failed - files.len();
    fs::create_dir_all(&*args.output).map_err(|error| AppError::unwritten(&args.output, &error))?;
    let mut made = 0;
    let mut waiting = VecDeque::from(files);
    // Files whose process did not end well while it showed others too: which of them is the reason, is not known.
    let mut doubtful = Vec::new();
    while !shutdown::is_requested() {
        let mut bytes = 0;
        let fits = |file: &&PathBuf| {
            bytes += file.as_os_str().len() + "--file= ".len();
            bytes <= MOST_BYTES
        };
        let count = waiting.iter().take_while(fits).count();
        let count = count.max(waiting.len().min(1));
        let batch: Vec<PathBuf> = match count {
            0 => doubtful.pop().into_iter().collect(),
            _ => waiting.drain(..count).collect(),
        };
        if batch.is_empty() {
            break;
        }
        let shown = process::show(&batch, args.timeout, &mut |file, event| match event {
            Event::Begun => {
                let number = kept + made + failed + 1;
                show_work(format_args!("{number} of {all}: {}", file.display()));
            }
            Event::Made => made += 1,
            Event::Failed(why) => report(file, &why, &mut failed),
            Event::DiskFull(_) => {} // an error of the process
        });
        end_work();
        let shown = shown?;
        let pictures = shown.unfinished.iter();
        let pictures = pictures.map(|file| picture_of(&args, file));
        sweep(&pictures.collect::<Vec<_>>());
        if shutdown::is_requested() {
            break;
        }
        match batch.as_slice() {
            [file] if !shown.unfinished.is_empty() => report(file, &shown.why, &mut failed),
            _ => doubtful.extend(shown.unfinished),
        }
        for file in shown.untried.into_iter().rev() {
            waiting.push_front(file);
        }
    }
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

/// Names a file that has no picture, with the reason.
fn report(file: &Path, error: &dyn Display, failed: &mut usize) {
    let text = printable_lines(&format!("{}: {error}", file.display())).replace('\n', " ");
    reflet_base::error_line!("error: {text}");
    *failed += 1;
}

/// The files of the folder in order of their paths; folders that cannot be read are reported.
fn files(args: &ThumbsArgs, failed: &mut usize) -> Result<Vec<PathBuf>, AppError> {
    if args.folder.is_file() {
        let file = args.folder.display();
        let text = format!(
            "{file} is a file: write the folder that has it, or `reflet render {file} -o picture.png`"
        );
        return Err(AppError::Usage(text));
    }
    files_of(&args.folder, &mut |file, why| report(file, why, failed))
}

/// The picture of a file.
fn picture_of(args: &ThumbsArgs, file: &Path) -> Goal {
    let below = file.strip_prefix(&args.folder).unwrap_or(file);
    let mut picture = args.output.join(below).into_os_string();
    picture.push(".png");
    args.output.renamed(picture.into())
}

/// Whether the picture of a file is newer than it, and such pictures are kept.
fn is_kept(args: &ThumbsArgs, file: &Path) -> bool {
    let time = |path: &Path| fs::metadata(path).and_then(|found| found.modified()).ok();
    let picture = args.resume.then(|| time(&picture_of(args, file))).flatten();
    picture.is_some_and(|picture| Some(picture) > time(file))
}

fn late(timeout: Duration) -> String {
    format!(
        "it takes longer than {} s (--timeout)",
        timeout.as_secs_f64()
    )
}
