//! Errors of commands: messages and exit codes.

use std::{
    io,
    path::{Path, PathBuf},
};

use crate::{
    gpu::{GpuError, ShaderError},
    output::{OutputError, frames::spans},
    render::RenderError,
    runtime::SessionError,
    scene::diagnostic::{Diagnostic, print_diagnostics, printable_lines},
};

/// Writes a line to standard error; what could control a terminal is replaced, as messages quote names of files.
macro_rules! say {
    ($($part:tt)*) => {
        reflet_base::error_line!("{}", printable_lines(&format!($($part)*)))
    };
}

/// Error of a command. It displays its message in one line.
#[derive(Clone, Debug, thiserror::Error)]
pub enum AppError {
    /// Invalid arguments: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// Errors in the scene or its files: exit code 3.
    #[error("{}", first_message(.0))]
    Scene(Vec<Diagnostic>),
    /// A picture to compare or a table of samples cannot be read or written: exit code 2.
    #[error("{}", first_message(.0))]
    Picture(Vec<Diagnostic>),
    /// Reported before, with this exit code.
    #[error("reported before")]
    Told(u8),
    /// Interrupted by Ctrl-C or SIGTERM; finished files stay, as the text says: exit code 130 or
    /// 143.
    #[error("{0}")]
    Interrupted(String),
    /// No usable GPU (4), a shader of the user's own (2) or a bug (1).
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// Failed frames of a sequence: exit code 5.
    #[error("{} frames failed", .0.len())]
    Frames(Vec<(u32, String)>),
    /// A failed frame of a video file, which is therefore not written: exit code 5.
    #[error("there is no film {}", path.display())]
    NoFilm {
        /// Path of the film.
        path: PathBuf,
        /// Failed frames, each with its error.
        failures: Vec<(u32, String)>,
        /// Frames that were not tried.
        untried: Vec<u32>,
    },
    /// Files of a folder without a picture, which were reported when they failed: exit code 5.
    #[error("{failed} of {all} files have no picture")]
    NoPicture {
        /// Number of files without a picture.
        failed: usize,
        /// Number of all files.
        all: usize,
    },
    /// A full disk ended a sequence: exit code 5.
    #[error("{why}")]
    Unwritten {
        /// File and error.
        why: String,
        /// Frames without a file.
        missing: Vec<u32>,
    },
    /// A full or read-only disk, or a failed video encoder: exit code 1.
    #[error("{0}")]
    Disk(String),
    /// Anything else: exit code 1.
    #[error("{0}")]
    Internal(String),
}

impl AppError {
    /// A comparison crossed a threshold, as reported on standard output: exit code 6.
    pub const THRESHOLD: Self = Self::Told(6);

    /// 1 internal, 2 usage, 3 scene, 4 no usable GPU, 5 some frames failed, 6 threshold crossed, 130
    /// or 143 interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Picture(_) => 2,
            Self::Scene(_) => 3,
            Self::Frames(_)
            | Self::NoFilm { .. }
            | Self::NoPicture { .. }
            | Self::Unwritten { .. } => 5,
            Self::Told(code) => *code,
            Self::Interrupted(_) => super::shutdown::exit_code(),
            Self::Gpu(GpuError::NoAdapter(_) | GpuError::OutOfMemory(_) | GpuError::Lost(_)) => 4,
            // The scene or its picture is too large.
            Self::Gpu(GpuError::Limit { .. }) => 3,
            Self::Gpu(_) | Self::Disk(_) | Self::Internal(_) => 1,
        }
    }

    /// Writes the message to standard error.
    pub fn print(&self) {
        match self {
            Self::Usage(text) | Self::Disk(text) | Self::Internal(text) => {
                say!("error: {text}");
            }
            Self::Unwritten { why, missing } => {
                let (is, frames) = match missing.len() {
                    1 => ("is", "1 frame".to_owned()),
                    n => ("are", format!("{n} frames")),
                };
                let list = spans(missing);
                say!("error: {why}");
                say!("{frames} {is} missing: {list}; free disk space and add --resume to continue");
            }
            Self::NoPicture { .. } => say!("error: {self}"),
            Self::Interrupted(text) => say!("{text}"),
            Self::Gpu(error) => say!("error: {error}"),
            Self::Scene(diagnostics) | Self::Picture(diagnostics) => {
                print_diagnostics(diagnostics);
            }
            Self::Frames(failed) => print_failures(failed),
            Self::NoFilm {
                path,
                failures,
                untried,
            } => {
                print_failures(failures);
                let rest = match untried.len() {
                    0 => String::new(),
                    1 => format!("; 1 frame was not tried: {}", spans(untried)),
                    n => format!("; {n} frames were not tried: {}", spans(untried)),
                };
                say!("there is no film {}{rest}", path.display());
            }
            Self::Told(_) => {}
        }
    }

    /// See [`OutputError::unwritten`].
    pub fn unwritten(path: &Path, error: &io::Error) -> Self {
        OutputError::unwritten(path, error).into()
    }

    /// Render error; `own_shaders` if the shaders come from the user.
    pub fn from_render(error: RenderError, own_shaders: bool) -> Self {
        Self::from_session(error.into(), own_shaders)
    }

    /// Error of a session; `own_shaders` if the shaders come from the user.
    pub fn from_session(error: SessionError, own_shaders: bool) -> Self {
        match error {
            SessionError::Gpu(GpuError::Shader(error)) if own_shaders => {
                Self::from_user_shader(&error)
            }
            SessionError::Gpu(error) => Self::Gpu(error),
            SessionError::Scene(errors) => Self::Scene(errors),
            error => Self::Usage(error.to_string()),
        }
    }

    /// Shader error: a usage error for a user's folder, a bug for built-in shaders.
    pub fn from_user_shader(error: &ShaderError) -> Self {
        Self::Usage(format!("--shaders: {error}"))
    }
}

fn first_message(diagnostics: &[Diagnostic]) -> &str {
    diagnostics.first().map_or("", |first| &first.message)
}

fn print_failures(failed: &[(u32, String)]) {
    let plural = if failed.len() == 1 { "" } else { "s" };
    say!("error: {} frame{plural} failed:", failed.len());
    for (frame, why) in failed {
        say!("  {frame}: {why}");
    }
}

impl From<OutputError> for AppError {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Usage(text) => Self::Usage(text),
            OutputError::Disk(text) => Self::Disk(text),
            OutputError::Internal(text) => Self::Internal(text),
            stopped @ OutputError::Stopped => Self::Interrupted(stopped.to_string()),
        }
    }
}
