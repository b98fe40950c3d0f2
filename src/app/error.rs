//! How a command fails: what people read, and the exit code that scripts read.

use std::io::IsTerminal as _;

use crate::{
    gpu::{GpuError, ShaderError},
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
    /// Ctrl-C stopped it; what was done until then is kept, and the text says where: exit code 130.
    Interrupted(String),
    /// No usable GPU (4), a shader of the user's own (2) or a bug (1).
    Gpu(GpuError),
    /// Anything else, such as a full disk: exit code 1.
    Internal(String),
}

impl AppError {
    /// 1 internal, 2 usage, 3 scene, 4 no usable GPU, 6 threshold crossed, 130 interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Picture(_) => 2,
            Self::Scene(_) => 3,
            Self::Threshold => 6,
            Self::Interrupted(_) => super::bench::progress::INTERRUPTED,
            Self::Gpu(GpuError::NoAdapter(_) | GpuError::OutOfMemory(_) | GpuError::Lost(_)) => 4,
            // The scene, or the picture that it asks for, is too large.
            Self::Gpu(GpuError::Limit { .. }) => 3,
            Self::Gpu(_) | Self::Internal(_) => 1,
        }
    }

    /// Writes the message to standard error.
    pub fn print(&self) {
        match self {
            Self::Usage(text) | Self::Internal(text) => eprintln!("error: {text}"),
            Self::Interrupted(text) => eprintln!("{text}"),
            Self::Gpu(error) => eprintln!("error: {error}"),
            Self::Scene(diagnostics) | Self::Picture(diagnostics) => {
                print_diagnostics(diagnostics);
            }
            Self::Threshold => {}
        }
    }

    /// A shader of a folder that the user named is the user's to mend; a built-in one is a bug.
    pub fn from_user_shader(error: &ShaderError) -> Self {
        Self::Usage(format!("--shaders: {error}"))
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
