//! Scene and denoiser that the arguments of `preview` name, for the window and for the page.

use super::{args::PreviewArgs, error::AppError};
use crate::{
    output::denoise::Denoiser,
    runtime::{SceneSource, parameters::ParameterOverrides, read},
    scene::dependencies::Dependencies,
};
use reflet_preview::viewer::picture_filter::PictureFilter;

/// The scene of the arguments.
pub fn source(args: &PreviewArgs) -> SceneSource {
    SceneSource {
        path: args.scene.clone(),
        options: args.from.options(),
        shaders: args.shaders.clone(),
        text: None,
    }
}

/// Filter of pictures at rest, if `--denoise` asks for it.
///
/// # Errors
/// [`AppError::Usage`] if Open Image Denoise is not installed.
pub fn denoiser(args: &PreviewArgs) -> Result<Option<PictureFilter>, AppError> {
    let denoiser = args.denoise.then(|| Denoiser::new(&[])).transpose()?;
    Ok(denoiser.map(|denoiser| {
        PictureFilter::new(move |picture| denoiser.apply(picture).map_err(|e| e.to_string()))
    }))
}

/// Whether a scene asks for ray queries; not, where it has mistakes, which the window shows.
pub fn may_query(source: &SceneSource) -> bool {
    let (none, texts) = (ParameterOverrides::default(), Dependencies::default());
    let read = read::read(source, &none, &texts, 0);
    read.is_ok_and(|read| read.scene().desc.reflection.may_query())
}
