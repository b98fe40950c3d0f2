//! Shaders of `--shaders`, else the built-in ones.

use std::path::Path;

use super::error::AppError;
use crate::gpu::ShaderLibrary;

/// Shader library of a folder; without one, the built-in shaders.
///
/// # Errors
/// [`AppError::Usage`] with the file that is missing or cannot be read.
pub fn library(folder: Option<&Path>) -> Result<ShaderLibrary, AppError> {
    match folder {
        None => Ok(ShaderLibrary::embedded()),
        Some(folder) => {
            ShaderLibrary::from_dir(folder).map_err(|error| AppError::from_user_shader(&error))
        }
    }
}
