//! Why a bench cannot go on.

use std::fmt;

use crate::{render::RenderError, scene::diagnostic::Diagnostic};

/// Why nothing more could be measured.
#[derive(Clone, Debug)]
pub enum BenchError {
    /// The renderer or the GPU refused.
    Render(RenderError),
    /// A file cannot be read or written, or holds something else.
    File(Box<Diagnostic>),
    /// A frame cannot be posed.
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
