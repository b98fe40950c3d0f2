//! Render errors.

use std::path::Path;

use reflet_gpu::GpuError;
use reflet_scene::{desc::SceneDesc, diagnostic::Diagnostic};

/// Render errors.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// The scene cannot be rendered: too large, or broken geometry.
    #[error("{}", .0.message)]
    Scene(Box<Diagnostic>),
    /// GPU or shader error.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

impl RenderError {
    /// The error with its place in the text of the scene, if it is about a setting of it.
    pub fn located(self, scene: &SceneDesc) -> Self {
        match self {
            Self::Scene(error) => Self::Scene(Box::new(scene.located(*error))),
            Self::Gpu(error) => Self::Gpu(error),
        }
    }

    /// Converts to scene diagnostics.
    pub fn into_diagnostics(self) -> Vec<Diagnostic> {
        match self {
            Self::Scene(diagnostic) => vec![*diagnostic],
            Self::Gpu(error) => vec![Diagnostic::in_file(
                "gpu",
                Path::new("device"),
                error.to_string(),
            )],
        }
    }
}

impl From<Box<Diagnostic>> for RenderError {
    fn from(diagnostic: Box<Diagnostic>) -> Self {
        Self::Scene(diagnostic)
    }
}
