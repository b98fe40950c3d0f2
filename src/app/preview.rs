//! `preview`: the arguments of the window.

use std::{env, path::PathBuf, sync::Arc};

use super::{
    args::PreviewArgs,
    error::AppError,
    plan_file::costs,
    viewed_scene::{denoiser, may_query, source},
};
use crate::{gpu::driver::open_gpu, scene::desc::Method};
use reflet_preview::window::{WindowError, WindowOptions, check_display, show};

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
    let source = source(args);
    let gpu = Arc::new(open_gpu(args.adapter.as_deref(), may_query(&source))?);
    let plan = args.plan.as_deref();
    let options = WindowOptions {
        source,
        camera: args.camera.clone(),
        method: args.method.map(Method::from),
        costs: plan.map(|path| costs(path, &gpu)).transpose()?,
        size: size.unwrap_or([1280, 800]),
        screenshots,
        denoiser: denoiser(args)?,
    };
    show(gpu, &options).map_err(refused)
}
