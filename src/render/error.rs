//! Why there is no picture.

use std::fmt;

use crate::{gpu::GpuError, scene::diagnostic::Diagnostic};

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq)]
pub enum RenderError {
    /// The scene cannot be rendered: too large, or broken geometry.
    Scene(Box<Diagnostic>),
    /// The GPU or a shader refused.
    Gpu(GpuError),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) => f.write_str(&diagnostic.message),
            Self::Gpu(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RenderError {}

impl From<GpuError> for RenderError {
    fn from(error: GpuError) -> Self {
        Self::Gpu(error)
    }
}

impl From<Box<Diagnostic>> for RenderError {
    fn from(diagnostic: Box<Diagnostic>) -> Self {
        Self::Scene(diagnostic)
    }
}
