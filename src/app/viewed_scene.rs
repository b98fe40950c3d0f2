//! Adapter, scene and denoiser that the arguments of `preview` name, for the window and for the page.

use std::sync::Arc;

use super::{args::PreviewArgs, error::AppError};
use crate::{
    gpu::{Gpu, driver::open_gpu},
    output::denoise::Denoiser,
    runtime::{SceneSource, parameters::ParameterOverrides, read},
    scene::dependencies::Dependencies,
};
use reflet_preview::viewer::{opening::ViewerOptions, picture_filter::PictureFilter};

/// The adapter of the arguments, and the options of their viewer, of this size in pixels.
///
/// # Errors
/// No usable GPU, and no Open Image Denoise for `--denoise`.
pub fn viewer(args: &PreviewArgs, size: [u32; 2]) -> Result<(Arc<Gpu>, ViewerOptions), AppError> {
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
