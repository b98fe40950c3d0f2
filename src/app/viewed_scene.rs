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
        denoiser: denoiser(args)?,
    };
    Ok((gpu, options))
}

/// Filter of pictures at rest, if `--denoise` asks for it.
///
/// # Errors
/// [`AppError::Usage`] if Open Image Denoise is not installed.
fn denoiser(args: &PreviewArgs) -> Result<Option<PictureFilter>, AppError> {
    let denoiser = args.denoise.then(|| Denoiser::new(&[])).transpose()?;
    Ok(denoiser.map(|denoiser| {
        PictureFilter::new(move |picture| denoiser.apply(picture).map_err(|e| e.to_string()))
    }))
}

/// Whether a scene asks for ray queries; not, where it has mistakes, which the window shows.
fn may_query(source: &SceneSource) -> bool {
    let (none, texts) = (ParameterOverrides::default(), Dependencies::default());
    let read = read::read(source, &none, &texts, 0);
    read.is_ok_and(|read| read.scene().desc.reflection.may_query())
}
