//! `preview`: the adapter, scene and denoiser that its arguments name, for the window and for the page.

use std::sync::Arc;

use super::{args::PreviewArgs, error::AppError};
use crate::{
    gpu::{Gpu, driver::open_gpu},
    output::denoise::Denoiser,
    runtime::{SceneSource, parameters::ParameterOverrides, read},
    scene::dependencies::Dependencies,
};
#[cfg(feature = "serve")]
use reflet_preview::serve::{Port, ServeError, serve};
use reflet_preview::viewer::{opening::ViewerOptions, picture_filter::PictureFilter};
#[cfg(feature = "window")]
use reflet_preview::window::{WindowError, check_display, show};

/// Opens the window and returns when it is closed.
///
/// # Errors
/// A missing scene, a camera that the scene does not have, no usable GPU, or no display.
#[cfg(feature = "window")]
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
        None => std::env::current_dir().unwrap_or_else(|_| ".".into()),
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

/// Serves the page until Ctrl-C or SIGTERM.
///
/// # Errors
/// A missing scene, a camera that the scene does not have, no usable GPU, or an address that cannot be listened at.
#[cfg(feature = "serve")]
pub fn page(args: &PreviewArgs) -> Result<(), AppError> {
    let refused = |error| match error {
        ServeError::Session(error) => AppError::from_session(error, args.shaders.is_some()),
        ServeError::Address(text) => AppError::Usage(format!("--serve: {text}")),
    };
    let size = (args.from).size(args.size.as_ref(), args.scene.as_deref())?;
    let address = args.serve.as_deref().filter(|address| !address.is_empty());
    if let (None, Some(path)) = (
        &args.scene,
        address.filter(|a| std::path::Path::new(a).is_file()),
    ) {
        return Err(AppError::Usage(format!(
            "--serve takes an address, and {path} is a file: write it first, as in `reflet preview {path} --serve`"
        )));
    }
    let port = Port::listen(address).map_err(refused)?;
    let (gpu, options) = viewer(args, size.unwrap_or([960, 600]))?;
    super::shutdown::listen();
    if port.is_open {
        reflet_base::error_line!(
            "warning: other machines can reach this port; whoever has the address with its token sees the scene and \
             can change its text, and the connection is not encrypted"
        );
    }
    super::print_out(&format!("{}\n", port.url))?;
    serve(gpu, &options, port, &super::shutdown::is_requested).map_err(refused)
}

/// The adapter of the arguments, and the options of their viewer, of this size in pixels.
///
/// # Errors
/// No usable GPU, and no Open Image Denoise for `--denoise`.
fn viewer(args: &PreviewArgs, size: [u32; 2]) -> Result<(Arc<Gpu>, ViewerOptions), AppError> {
    let source = SceneSource {
        path: args.scene.clone(),
        options: args.from.options(),
        shaders: args.shaders.clone(),
        text: None,
    };
    let gpu = Arc::new(open_gpu(args.adapter.as_deref(), may_query(&source))?);
    let options = ViewerOptions {
        source,
        camera: args.camera.clone(),
        method: args.method,
        size,
        denoiser: denoiser(args, &gpu)?,
    };
    Ok((gpu, options))
}

/// Filter of pictures at rest, where Open Image Denoise is installed.
///
/// # Errors
/// [`AppError::Usage`] if `--denoise` asks for it, and it is not installed.
fn denoiser(args: &PreviewArgs, gpu: &Arc<Gpu>) -> Result<Option<PictureFilter>, AppError> {
    if args.no_denoise {
        return Ok(None);
    }
    let denoiser = match Denoiser::new(&[]) {
        Err(missing) if args.denoise => return Err(missing.into()),
        Err(missing) if Denoiser::has_named_folder() => {
            reflet_base::error_line!("note: pictures are shown with their noise: {missing}");
            None
        }
        installed => installed.ok(),
    };
    let gpu = gpu.clone();
    Ok(denoiser.map(|denoiser| {
        let denoiser = denoiser.stopped_by(move || gpu.check_interrupt().is_err());
        PictureFilter::new(move |picture| denoiser.apply(picture).map_err(|e| e.to_string()))
    }))
}

/// Whether a scene asks for ray queries; not, where it has mistakes, which the window shows.
fn may_query(source: &SceneSource) -> bool {
    let (none, texts) = (ParameterOverrides::default(), Dependencies::default());
    let read = read::read(source, &none, &texts, 0);
    read.is_ok_and(|read| read.scene().desc.reflection.may_query())
}
