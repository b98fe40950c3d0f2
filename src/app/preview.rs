//! `preview`: the arguments of the window.

use std::{env, path::PathBuf};

use super::{args::PreviewArgs, error::AppError, viewed_scene::viewer};
use reflet_preview::window::{WindowError, check_display, show};

/// Opens the window and returns when it is closed.
///
/// # Errors
/// A missing scene, a camera that the scene does not have, no usable GPU, or no display.
pub fn preview(args: &PreviewArgs) -> Result<(), AppError> {
    let screenshots = match &args.screenshots {
        Some(folder) if folder.is_dir() => folder.clone(),
        Some(folder) => {
            let text = format!(
                "--screenshots {}: the folder does not exist",
                folder.display()
            );
            return Err(AppError::Usage(text));
        }
        None => env::current_dir().unwrap_or_else(|_| PathBuf::from(".")),
    };
    let refused = |error| match error {
        WindowError::Session(error) => AppError::from_session(error, args.shaders.is_some()),
        WindowError::Display(text) => AppError::Internal(text),
    };
    let size = (args.from).size(args.size.as_ref(), args.scene.as_deref())?;
    check_display().map_err(refused)?;
    let (gpu, options) = viewer(args, size.unwrap_or([1280, 800]))?;
    show(gpu, &options, screenshots).map_err(refused)
}
