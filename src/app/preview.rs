//! `preview`: the arguments of the window.

use std::{env, path::PathBuf, sync::Arc};

use super::{
    args::PreviewArgs, denoise::Denoiser, device::open_gpu, error::AppError, plan_file::costs,
};
use crate::{
    runtime::{SceneSource, parameters::ParameterOverrides, read},
    scene::{dependencies::Dependencies, desc::Method},
};
use reflet_preview::{
    viewer::picture_filter::PictureFilter,
    window::{WindowError, WindowOptions, check_display, show},
};

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
    let source = SceneSource {
        path: args.scene.clone(),
        options: args.from.options(),
        shaders: args.shaders.clone(),
    };
    let gpu = Arc::new(open_gpu(args.adapter.as_deref(), may_query(&source))?);
    let denoiser = args.denoise.then(|| Denoiser::new(&[])).transpose()?;
    let plan = args.plan.as_deref();
    let options = WindowOptions {
        source,
        camera: args.camera.clone(),
        method: args.method.map(Method::from),
        costs: plan.map(|path| costs(path, &gpu)).transpose()?,
        size: size.unwrap_or([1280, 800]),
        screenshots,
        denoiser: denoiser.map(|denoiser| {
            PictureFilter::new(move |picture| denoiser.apply(picture).map_err(|e| e.to_string()))
        }),
    };
    show(gpu, &options).map_err(refused)
}

/// Whether a scene asks for ray queries; not, where it has mistakes, which the window shows.
fn may_query(source: &SceneSource) -> bool {
    let (none, texts) = (ParameterOverrides::default(), Dependencies::default());
    let read = read::read(source, &none, &texts, 0);
    read.is_ok_and(|read| read.scene().desc.reflection.may_query())
}
