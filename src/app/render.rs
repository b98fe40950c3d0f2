//! `render`: renders a scene to pictures or a film.

use std::{path::Path, time::Instant};

use super::{
    args::{PictureArgs, RenderArgs},
    cameras,
    error::AppError,
    lint::Lint,
    progress::PictureProgress,
    project::{make_folder, with_output},
    relight::{TURNTABLE, turntable},
    render_session::RenderSession,
    scene::load_followed,
    sequence, shaders, still,
};
use crate::{
    gpu::adapter::slow_mesa,
    output::{
        picture_file::PictureFile,
        writable::{inputs, lacks_last_folder},
    },
    render::picture::aov::Aov,
    runtime::scene_text::{LoadedScene, SceneText},
    scene::{dependencies::Dependencies, diagnostic::print_diagnostics, suggest},
    world::World,
};

/// Renders one picture, or the frames of a film, for each camera.
///
/// # Errors
/// The first fatal error; no partial file is left. Failed frames of one camera do not stop other cameras.
pub fn render(args: &RenderArgs) -> Result<(), AppError> {
    render_once(args, &Dependencies::default())
}

/// Renders as [`render`] does, and adds the files of the scene to `files`, also on errors.
///
/// # Errors
/// Same errors as [`render`].
pub fn render_once(args: &RenderArgs, files: &Dependencies) -> Result<(), AppError> {
    let started = Instant::now();
    let args = &RenderArgs {
        picture: turned(&args.picture, args.scene.as_deref())?,
        ..args.clone()
    };
    // Cheap checks first, before rendering.
    if args.output.is_some() {
        check_kind(args)?;
    }
    check_aovs(&args.picture.aov)?;
    let library = shaders::library(args.picture.shaders.as_deref())?;
    let load_started = Instant::now();
    let mut reading = Some(PictureProgress::new(args));
    let loaded = load_followed(
        args.scene.as_deref(),
        &args.picture.from,
        &overrides(&args.picture, args.scene.as_deref())?,
        files,
    )?;
    (loaded.world.files.iter()).for_each(|file| files.add(file.clone()));
    let aovs = choose_aovs(&args.picture.aov, &loaded.world)?;
    let args = &with_output(args, &loaded)?;
    let many = check_kind(args)?;
    let load_ms = load_started.elapsed().as_secs_f64() * 1e3;
    hint_at_mistakes(args.scene.as_deref(), &loaded);
    let inputs = inputs(args.scene.as_deref(), &loaded);
    let mut failed = None;
    let runs = cameras::runs(args, &loaded)?;
    // The last run takes the scene itself.
    let copies = std::iter::repeat_n((loaded, aovs), runs.len());
    for ((camera, args), (loaded, aovs)) in runs.into_iter().zip(copies) {
        let rendered = if many {
            let frames = sequence::choose(&args, loaded.scene.timeline.as_ref())?;
            sequence::check_output(&args, &frames, &aovs, &inputs)?;
            let session = RenderSession::new(&args, loaded, camera, aovs, &library)?;
            note_old_driver(&session, frames.0.len());
            reading = None; // frames are reported
            sequence::render(&args, session, &frames, load_ms, started)
        } else {
            make_folder(args.output())?;
            let output = PictureFile::new(args.output())?;
            output.check_files(&aovs, &inputs)?;
            let session = RenderSession::new(&args, loaded, camera, aovs, &library)?;
            note_old_driver(&session, 1);
            let progress = reading.take();
            let progress = progress.unwrap_or_else(|| PictureProgress::new(&args));
            still::render(&args, session, &output, &progress, load_ms, started)
        };
        match rendered {
            Err(error @ AppError::Frames(_)) => {
                if let Some(earlier) = failed.replace(error) {
                    earlier.print();
                }
            }
            rendered => rendered?,
        }
    }
    failed.map_or(Ok(()), Err)
}

/// Settings of pictures with light and turntable as overrides of the scene.
///
/// # Errors
/// Errors of the scene, where it is turned; same errors as [`PictureArgs::lit`] and [`turntable`].
pub fn turned(picture: &PictureArgs, scene: Option<&Path>) -> Result<PictureArgs, AppError> {
    let mut picture = picture.lit(scene)?;
    if let Some(time) = picture.turntable.take() {
        let mut options = picture.from.options();
        options.set.extend(overrides(&picture, scene)?);
        let text = SceneText::read(scene, &options).map_err(AppError::Scene)?;
        let name = text.name();
        let opened = text.open(&[], &Dependencies::default());
        let loaded = opened.and_then(|opened| opened.load(name));
        let values = turntable(&loaded.map_err(AppError::Scene)?, time)?;
        picture.from.set.extend(values);
        picture.camera = Some(TURNTABLE.to_owned());
    }
    Ok(picture)
}

/// Checks the name of the output; returns whether it is for many frames.
fn check_kind(args: &RenderArgs) -> Result<bool, AppError> {
    let many = sequence::is_sequence(args)?;
    if !many {
        if args.resume || args.shard.is_some() {
            let text = "--resume and --shard need --frames";
            return Err(AppError::Usage(text.to_owned()));
        }
        // A scene that is refused leaves no folder.
        if !lacks_last_folder(args.output()) {
            PictureFile::new(args.output())?;
        }
    } else if args.keep_partial || args.write_every.is_some() {
        let text = "--keep-partial and --write-every are for one picture; a film keeps its finished frames";
        return Err(AppError::Usage(text.to_owned()));
    }
    Ok(many)
}

/// Names likely mistakes of a scene, which `check` explains, on standard error, and warns of slow parts.
fn hint_at_mistakes(scene: Option<&Path>, loaded: &LoadedScene) {
    let first = &loaded.first_frame();
    print_diagnostics(&Lint::slow(&loaded.scene, first));
    let names = Lint::names_at_first(&loaded.scene, first);
    if let (false, Some(path)) = (names.is_empty(), scene) {
        let (path, names) = (path.display(), names.join(", "));
        reflet_base::error_line!(
            "note: likely mistakes ({names}): `reflet check {path}` explains them"
        );
    }
}

/// Number of pixels of all sub-frames and frames from which a render takes a processor half a minute and more.
const LONG_RENDER: u64 = 1 << 23;

/// Says before a long render what an old driver costs.
fn note_old_driver(session: &RenderSession, frames: usize) {
    let image = &session.scene.scene().scene.image;
    let pixels = image.size.map(u64::from).iter().product::<u64>();
    let pixels = pixels * u64::from(image.samples.count()) * frames as u64;
    let slow = slow_mesa(&session.scene.gpu().adapter_info);
    if let Some(slow) = slow.filter(|_| pixels >= LONG_RENDER) {
        reflet_base::error_line!("note: {slow}");
    }
}

/// Checks a list of AOVs as far as that can be done without the scene.
///
/// # Errors
/// [`AppError::Usage`] for an unknown name.
pub fn check_aovs(names: &[String]) -> Result<(), AppError> {
    let is_known = |name: &str| name.starts_with("light:") || Aov::from_name(name).is_some();
    let unknown = names.iter().find(|name| !is_known(name.trim()));
    unknown.map_or(Ok(()), |name| Err(no_such_aov(name, &World::default())))
}

/// The AOVs of a list.
///
/// # Errors
/// [`AppError::Usage`] for a name that the scene lacks.
pub fn choose_aovs(names: &[String], world: &World) -> Result<Vec<Aov>, AppError> {
    let mut aovs = Vec::new();
    for name in names {
        let named = Aov::named(name.trim(), world).ok_or_else(|| no_such_aov(name, world))?;
        for aov in named {
            if !aovs.contains(&aov) {
                aovs.push(aov);
            }
        }
    }
    Ok(aovs)
}

fn no_such_aov(name: &str, world: &World) -> AppError {
    let known = Aov::names_in(world).join(", ");
    let names = Aov::names_in(world);
    let meant = suggest::nearest(name.trim(), names.iter().map(String::as_str));
    let meant = meant.map_or_else(String::new, |meant| format!("did you mean {meant}? "));
    let (why, meant) = match name.trim().strip_prefix("light:") {
        Some(group) => (
            format!("no light has `light_group = \"{group}\"`"),
            String::new(),
        ),
        None => ("no such AOV".to_owned(), meant),
    };
    AppError::Usage(format!("--aov {name}: {why}; {meant}choose from {known}"))
}

/// Flags for scene values as overrides; they win over `--set`.
///
/// # Errors
/// Same errors as [`SceneArgs::size`](super::args::SceneArgs::size).
pub fn overrides(args: &PictureArgs, scene: Option<&Path>) -> Result<Vec<String>, AppError> {
    let size = args.from.size(args.size.as_ref(), scene)?;
    let size = size.map(|[w, h]| format!("image.size=[{w}, {h}]"));
    let samples = args
        .samples
        .map(|samples| format!("image.samples={samples}"));
    let method = args
        .method
        .map(|method| format!("reflection.method=\"{}\"", method.name()));
    Ok([size, samples, method].into_iter().flatten().collect())
}
