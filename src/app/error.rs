//! How a command fails: what people read, and the exit code that scripts read.

use std::{
    fmt,
    io::{self, IsTerminal as _},
    path::{Path, PathBuf},
};

use super::frame_spans::spans;
use crate::{
    gpu::{GpuError, ShaderError},
    render::RenderError,
    scene::diagnostic::{Diagnostic, render_all},
};

/// Why a command failed.
#[derive(Clone, Debug)]
pub enum AppError {
    /// The command line asks for something that cannot be: exit code 2.
    Usage(String),
    /// The scene or a file that it refers to is wrong: exit code 3.
    Scene(Vec<Diagnostic>),
    /// A picture to compare or a table of samples cannot be read or written: exit code 2.
    Picture(Vec<Diagnostic>),
    /// A comparison crossed a threshold, which it said on standard output: exit code 6.
    Threshold,
    /// Ctrl-C or SIGTERM stopped it; what was done until then is kept, and the text says where: exit
    /// code 130 or 143.
    Interrupted(String),
    /// No usable GPU (4), a shader of the user's own (2) or a bug (1).
    Gpu(GpuError),
    /// Some frames of a film have no picture: exit code 5.
    Frames(Vec<(u32, String)>),
    /// A frame of a film in one file has no picture, so there is no film: exit code 5.
    NoFilm {
        /// The film.
        goal: PathBuf,
        /// Frames that have no picture, and why.
        failures: Vec<(u32, String)>,
        /// Frames that were not rendered after that.
        untried: Vec<u32>,
    },
    /// The disk takes no more, and a film was ended by that: what was to be written, why not, and
    /// the frames without a file. Exit code 5.
    Unwritten {
        /// File and reason.
        why: String,
        /// Frames without a file.
        missing: Vec<u32>,
    },
    /// A full disk or one that cannot be written to, or an encoder of films that ends: exit code 1.
    Disk(String),
    /// Anything else: exit code 1.
    Internal(String),
}

impl AppError {
    /// 1 internal, 2 usage, 3 scene, 4 no usable GPU, 5 some frames failed, 6 threshold crossed, 130
    /// or 143 interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Picture(_) => 2,
            Self::Scene(_) => 3,
            Self::Frames(_) | Self::NoFilm { .. } | Self::Unwritten { .. } => 5,
            Self::Threshold => 6,
            Self::Interrupted(_) => super::shutdown::exit_code(),
            Self::Gpu(GpuError::NoAdapter(_) | GpuError::OutOfMemory(_) | GpuError::Lost(_)) => 4,
            // The scene, or the picture that it asks for, is too large.
            Self::Gpu(GpuError::Limit { .. }) => 3,
            Self::Gpu(_) | Self::Disk(_) | Self::Internal(_) => 1,
        }
    }

    /// Writes the message to standard error.
    pub fn print(&self) {
        match self {
            Self::Usage(text) | Self::Disk(text) | Self::Internal(text) => {
                eprintln!("error: {text}");
            }
            Self::Unwritten { why, missing } => {
                let (is, frames) = match missing.len() {
                    1 => ("is", "1 frame".to_owned()),
                    n => ("are", format!("{n} frames")),
                };
                let list = spans(missing);
                eprintln!("error: {why}");
                eprintln!("{frames} {is} missing: {list}; make room and add --resume to go on");
            }
            Self::Interrupted(text) => eprintln!("{text}"),
            Self::Gpu(error) => eprintln!("error: {error}"),
            Self::Scene(diagnostics) | Self::Picture(diagnostics) => {
                print_diagnostics(diagnostics);
            }
            Self::Frames(failed) => print_failures(failed),
            Self::NoFilm {
                goal,
                failures,
                untried,
            } => {
                print_failures(failures);
                let rest = match untried.len() {
                    0 => String::new(),
                    1 => format!("; 1 frame was not tried: {}", spans(untried)),
                    n => format!("; {n} frames were not tried: {}", spans(untried)),
                };
                eprintln!("there is no film {}{rest}", goal.display());
            }
            Self::Threshold => {}
        }
    }

    /// A file that cannot be written: whether others may still be depends on why.
    pub fn unwritten(path: &Path, error: &io::Error) -> Self {
        use io::ErrorKind::{QuotaExceeded, ReadOnlyFilesystem, StorageFull};
        let text = format!("cannot write {}: {error}", path.display());
        match error.kind() {
            StorageFull | QuotaExceeded | ReadOnlyFilesystem => Self::Disk(text),
            _ => Self::Internal(text),
        }
    }

    /// What keeps a picture from being rendered; `own_shaders` are those of the user.
    pub fn from_render(error: RenderError, own_shaders: bool) -> Self {
        match error {
            RenderError::Gpu(GpuError::Shader(error)) if own_shaders => {
                Self::from_user_shader(&error)
            }
            RenderError::Gpu(error) => Self::Gpu(error),
            RenderError::Scene(diagnostic) => Self::Scene(vec![*diagnostic]),
        }
    }

    /// A shader of a folder that the user named is the user's to mend; a built-in one is a bug.
    pub fn from_user_shader(error: &ShaderError) -> Self {
        Self::Usage(format!("--shaders: {error}"))
    }
}

fn print_failures(failed: &[(u32, String)]) {
    let plural = if failed.len() == 1 { "" } else { "s" };
    eprintln!("error: {} frame{plural} failed:", failed.len());
    for (frame, why) in failed {
        eprintln!("  {frame}: {why}");
    }
}

/// In one line.
impl fmt::Display for AppError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(text)
            | Self::Disk(text)
            | Self::Internal(text)
            | Self::Interrupted(text) => f.write_str(text),
            Self::Unwritten { why, .. } => f.write_str(why),
            Self::Gpu(error) => error.fmt(f),
            Self::Scene(all) | Self::Picture(all) => {
                f.write_str(all.first().map_or("", |first| first.message.as_str()))
            }
            Self::Frames(failed) => write!(f, "{} frames failed", failed.len()),
            Self::NoFilm { goal, .. } => write!(f, "there is no film {}", goal.display()),
            Self::Threshold => f.write_str("a threshold was crossed"),
        }
    }
}

impl From<GpuError> for AppError {
    fn from(error: GpuError) -> Self {
        Self::Gpu(error)
    }
}

/// Writes diagnostics to standard error, in color on a terminal.
pub fn print_diagnostics(diagnostics: &[Diagnostic]) {
    let wants_color = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let color = wants_color && std::io::stderr().is_terminal();
    if !diagnostics.is_empty() {
        eprint!("{}", render_all(diagnostics, color));
    }
}
