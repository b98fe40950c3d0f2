//! `sheet`: a contact sheet of the cameras, variants and frames of a scene.

mod page;

use std::path::PathBuf;

use clap::Args;

use self::page::{MOST_PX, Page};
use super::{
    args::{PictureArgs, RenderArgs, SceneArgs},
    cameras,
    error::AppError,
    render::{overrides, turned},
    render_session::RenderSession,
    scene::load_scene,
    shaders, shutdown,
};
use crate::{
    files::{Goal, write_whole},
    gpu::ShaderLibrary,
    output::{
        format::{Format, PictureFormat},
        frames::FrameList,
        picture_file::PictureFile,
        writable::inputs,
    },
    render::picture::png_file,
    runtime::scene_text::{LoadedScene, SceneText},
};

/// Width and height of the pictures where `--size` is not given: the scene's, at most this wide.
const CELL_PX: u32 = 320;

/// Arguments of `sheet`.
#[derive(Clone, Debug, Args)]
pub struct SheetArgs {
    /// Scene file or model
    pub scene: PathBuf,
    /// Picture to write, .png
    #[arg(short, long, value_name = "FILE", value_hint = clap::ValueHint::AnyPath)]
    pub output: Goal,
    /// Variants to show, each by itself: all, which begins with the plain scene, or a list
    #[arg(long, value_name = "LIST", conflicts_with = "variant")]
    pub variants: Option<String>,
    /// Frames to show, in the syntax of render --frames; without it the first
    #[arg(long, value_name = "LIST")]
    pub frames: Option<String>,
    /// Number of pictures of a row
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub columns: Option<u32>,
    /// Settings of the pictures; without --size they are as the scene's, at most 320 pixels wide
    #[command(flatten)]
    pub picture: PictureArgs,
}

/// Pictures of a variant of the scene.
struct Take {
    /// Name of the variant; `None` where none is asked for.
    variant: Option<String>,
    loaded: LoadedScene,
    cameras: Vec<usize>,
    frames: Vec<u32>,
}

/// Renders all pictures and writes the sheet.
///
/// # Errors
/// Errors of the scene, [`AppError::Usage`] for names that it does not have and a sheet that is too large, and a file
/// that cannot be written; nothing is written then.
pub fn sheet(args: &SheetArgs) -> Result<(), AppError> {
    if Format::expect(&args.output)? != Format::Picture(PictureFormat::Png) {
        let output = args.output.display();
        return Err(AppError::Usage(format!(
            "--output {output}: a sheet is a .png file"
        )));
    }
    if !args.picture.aov.is_empty() {
        return Err(AppError::Usage(
            "--aov does not apply to a sheet".to_owned(),
        ));
    }
    let args = &SheetArgs {
        picture: turned(&args.picture, Some(&args.scene))?,
        ..args.clone()
    };
    let output = PictureFile::new(&args.output)?;
    let library = shaders::library(args.picture.shaders.as_deref())?;
    let takes = takes(args)?;
    for take in &takes {
        output.check_files(&[], &inputs([args.scene.as_path()], &take.loaded))?;
    }
    let count: usize = takes
        .iter()
        .map(|take| take.cameras.len() * take.frames.len())
        .sum();
    let columns = args.columns.unwrap_or_else(|| columns_of(&takes, count));
    let cell = match args.picture.crop {
        Some(crop) => crop.size,
        None => takes[0].loaded.scene.image.size,
    };
    let page = u32::try_from(count)
        .ok()
        .and_then(|count| Page::new(cell, count, columns));
    let mut page = page.ok_or_else(|| {
        AppError::Usage(format!(
            "{count} pictures of {} x {} pixels: a sheet has at most {MOST_PX} pixels on each side; choose fewer, a \
             smaller --size, or other --columns",
            cell[0], cell[1]
        ))
    })?;
    shutdown::listen();
    render_all(args, &library, &takes, &mut page, count)?;
    let png = png_file::encode(page.size, &page.pixels, &[]);
    let png = png.map_err(AppError::Internal)?;
    write_whole(&args.output, &png).map_err(|error| AppError::unwritten(&args.output, &error))?;
    reflet_base::error_line!("wrote {}", args.output.display());
    Ok(())
}

/// Renders all pictures into their places.
fn render_all(
    args: &SheetArgs,
    library: &ShaderLibrary,
    takes: &[Take],
    page: &mut Page,
    count: usize,
) -> Result<(), AppError> {
    let names = [
        takes.len() > 1 || args.variants.is_some(),
        count > takes.len(),
    ];
    let mut index = 0;
    for take in takes {
        for &camera in &take.cameras {
            let render = RenderArgs::for_pictures(Some(&args.scene), &args.picture);
            let name = take.loaded.world.cameras[camera].name.clone();
            let loaded = take.loaded.clone();
            let mut session =
                RenderSession::new(&render, loaded, Some(camera), Vec::new(), library)?;
            for &frame in &take.frames {
                if shutdown::is_requested() {
                    let text = "stopped; no sheet was written".to_owned();
                    return Err(AppError::Interrupted(text));
                }
                let label = label(take, &name, frame, names);
                page.put(index, &session.picture(frame, None)?.display, &label);
                index += 1;
                reflet_base::error_line!("{index} of {count}: {label}");
            }
        }
    }
    Ok(())
}

/// Caption of a picture: of variant, camera and frame, whatever differs on the sheet.
fn label(take: &Take, camera: &str, frame: u32, [has_variants, has_more]: [bool; 2]) -> String {
    let mut parts = Vec::new();
    if has_variants {
        parts.push(take.variant.clone().unwrap_or_else(|| "plain".to_owned()));
    }
    if take.cameras.len() > 1 || !has_variants && !has_more {
        parts.push(camera.to_owned());
    }
    if take.frames.len() > 1 {
        parts.push(format!("frame {frame}"));
    }
    parts.join(" / ")
}

/// Number of columns: the frames of a row, else the cameras, else about as many as rows.
fn columns_of(takes: &[Take], count: usize) -> u32 {
    const MOST: usize = 12;
    let [cameras, frames] = [takes[0].cameras.len(), takes[0].frames.len()];
    let fit = |n: usize| (2..=MOST).contains(&n) && n < count;
    let columns = match () {
        () if fit(frames) => frames,
        () if frames == 1 && fit(cameras) => cameras,
        () => (count as f64).sqrt().ceil() as usize,
    };
    columns as u32
}

/// The scene with each of the variants, loaded.
fn takes(args: &SheetArgs) -> Result<Vec<Take>, AppError> {
    let from = &args.picture.from;
    let text = SceneText::read(Some(&args.scene), &from.options()).map_err(AppError::Scene)?;
    let own = text.variants();
    let variants: Vec<Option<String>> = match args.variants.as_deref() {
        None => vec![None],
        Some("all") => std::iter::once(None)
            .chain(own.into_iter().map(Some))
            .collect(),
        Some(list) => list
            .split(',')
            .map(|name| Some(name.trim().to_owned()))
            .collect(),
    };
    let mut takes: Vec<Take> = Vec::new();
    for variant in variants {
        let from = SceneArgs {
            variant: match (&args.variants, &variant) {
                (None, _) => from.variant.clone(),
                (Some(_), None) => vec![String::new()],
                (Some(_), Some(name)) => vec![name.clone()],
            },
            ..from.clone()
        };
        let loaded = loaded(args, &from)?;
        let size = loaded.scene.image.size;
        if let Some(other) = takes.first().map(|take| take.loaded.scene.image.size)
            && other != size
        {
            let text = "variants have pictures of several sizes; give one by --size";
            return Err(AppError::Usage(text.to_owned()));
        }
        let cameras = cameras::choose(&loaded, args.picture.camera.as_deref())?;
        let frames = match (&args.frames, loaded.scene.timeline.as_ref()) {
            (None, _) => vec![loaded.scene.first_frame()],
            (Some(list), Some(timeline)) => FrameList::parse("--frames", list, timeline)?.0,
            (Some(_), None) => {
                let text = "--frames: the scene has no [timeline], so it has no frames";
                return Err(AppError::Usage(text.to_owned()));
            }
        };
        takes.push(Take {
            variant,
            loaded,
            cameras,
            frames,
        });
    }
    Ok(takes)
}

/// The scene, with pictures of the size of the sheet.
fn loaded(args: &SheetArgs, from: &SceneArgs) -> Result<LoadedScene, AppError> {
    let scene = Some(args.scene.as_path());
    let mut more = overrides(&args.picture, scene)?;
    let loaded = load_scene(scene, from, &more)?;
    let [width, height] = loaded.scene.image.size;
    if args.picture.size.is_some() || args.picture.crop.is_some() || width <= CELL_PX {
        return Ok(loaded);
    }
    let height = (u64::from(height) * u64::from(CELL_PX) / u64::from(width)).max(1);
    more.push(format!("image.size=[{CELL_PX}, {height}]"));
    load_scene(scene, from, &more)
}
