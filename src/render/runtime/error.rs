//! Errors of sessions.

use crate::RenderError;
use reflet_gpu::{GpuError, ShaderError};
use reflet_scene::{
    diagnostic::{Diagnostic, render_all},
    suggest::{MOST_NAMES, hint},
};

/// Why a session cannot be opened, changed or rendered. Displays the full text with files, lines and columns.
#[derive(Clone, Debug, thiserror::Error)]
pub enum SessionError {
    /// Mistakes in the scene, its script or its files, or geometry past the limits of the adapter.
    #[error("{}", render_all(.0, false).trim_end())]
    Scene(Vec<Diagnostic>),
    /// A name that does not exist.
    #[error("there is no {kind} `{name}`{}", among(name, known))]
    UnknownName {
        /// Kind of thing that the name stands for: `AOV`, `camera`, `method` or `model`.
        kind: &'static str,
        /// Name as it was given.
        name: String,
        /// Names that exist.
        known: Vec<String>,
    },
    /// A frame outside of the timeline.
    #[error("there is no frame {frame}; the timeline has {first} to {last}")]
    Frame {
        /// Requested frame number.
        frame: u32,
        /// First frame of the timeline; 0 without one.
        first: u32,
        /// Last frame of the timeline; 0 without one.
        last: u32,
    },
    /// A pixel outside of the picture.
    #[error("there is no pixel {}, {}; the picture has {} x {}", at[0], at[1], size[0], size[1])]
    Pixel {
        /// Column and row, from the upper left corner.
        at: [u32; 2],
        /// Width and height of the picture.
        size: [u32; 2],
    },
    /// Vertices that do not fit a mesh.
    #[error("{0}")]
    Mesh(String),
    /// No usable adapter, a lost device, a picture or shadow maps past a limit, exhausted memory, or a shader that does
    /// not build.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// The name that is nearest to a wrong one, else the names that there are, at most 24 of them.
fn among(name: &str, known: &[String]) -> String {
    let known: Vec<&str> = known.iter().take(MOST_NAMES).map(String::as_str).collect();
    match known.is_empty() {
        true => String::new(),
        false => format!(
            "; {}",
            hint(name, &known, |word| format!("`{word}`"), "there are")
        ),
    }
}

impl From<Vec<Diagnostic>> for SessionError {
    fn from(diagnostics: Vec<Diagnostic>) -> Self {
        Self::Scene(diagnostics)
    }
}

impl From<ShaderError> for SessionError {
    fn from(error: ShaderError) -> Self {
        Self::Gpu(error.into())
    }
}

impl From<RenderError> for SessionError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Scene(diagnostic) => Self::Scene(vec![*diagnostic]),
            RenderError::Gpu(error) => Self::Gpu(error),
        }
    }
}
