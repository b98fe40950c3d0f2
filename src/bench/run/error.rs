//! Errors that end a bench.

use std::fmt;

use reflet_render::RenderError;
use reflet_scene::diagnostic::Diagnostic;

/// Reason why a bench cannot go on.
#[derive(Clone, Debug)]
pub enum BenchError {
    /// Error of the renderer or the GPU.
    Render(RenderError),
    /// A file that cannot be read or written, or has the wrong contents.
    File(Box<Diagnostic>),
    /// A frame that cannot be posed.
    Scene(Vec<Diagnostic>),
}

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Render(error) => error.fmt(f),
            Self::File(diagnostic) => f.write_str(&diagnostic.message),
            Self::Scene(diagnostics) => {
                let first = diagnostics.first().map(|d| d.message.as_str());
                f.write_str(first.unwrap_or("a frame cannot be posed"))
            }
        }
    }
}

impl std::error::Error for BenchError {}

impl<E: Into<RenderError>> From<E> for BenchError {
    fn from(error: E) -> Self {
        Self::Render(error.into())
    }
}
