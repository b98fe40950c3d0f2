//! Opening scenes, and overrides of their content.

use std::{
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
    time::Instant,
};

use pyo3::{prelude::*, types::PyMapping};

use crate::{
    errors::{Failure, argument_error, warn},
    scene_value::{kind, names, scene_text, settings_of},
    session::Session,
    view::{integers, of_argument},
    work,
};
use reflet_base::cache::private_folder;
use reflet_gpu::driver::{PIPELINES, driver_variables};
use reflet_render::runtime::{
    SceneSource, Session as Runtime, SessionOptions, scene_text::SceneOptions,
};
use reflet_scene::project::ProjectChoice;

/// Name in messages of a scene that is given as text.
const OF_TEXT: &str = "<text>";
/// Name in messages of a scene that is given as a dict.
const OF_DICT: &str = "<dict>";

/// Open a scene at its first frame, on a graphics adapter.
///
/// `scene` is a scene file, a model (`.gltf`, `.glb`; USD with `reflet[usd]`), which gets daylight
/// and a camera, or a dict with the keys of scene text. `text` is scene text, in place of the file
/// at `scene` if that is given too. Without both it is the built-in scene.
///
/// `folder` is where files that a dict or a text names are searched from; without it the current
/// one. `assets` are folders to search after the scene's own. `set` has values to change by their
/// path, such as `{"image.samples": 16, "params.height": 2.0}`, and `variant` the names of variants
/// to lay over it. `project` is False for a scene of no project, or the path of one, in place of
/// the `reflet.toml` that is found in its folder or above. `lenient` loads glTF files without
/// references to nodes and meshes that they lack, and `strict` refuses models with wrong parts that
/// are else left out with a warning; not both.
///
/// `camera`, `size` (pixels), `samples` and `method` hold for all pictures. `adapter` is a part of
/// an adapter's name, and `shaders` a folder of shaders in place of the built-in ones.
///
/// Warnings about the scene are given as `reflet.SceneWarning`. Ctrl-C is answered when the scene
/// is open.
///
/// Raises `SceneError` for mistakes, with file, line and column; `UnknownNameError` for a camera
/// that the scene lacks; `NoAdapterError`; `DeviceError`; `ForkError` in a process that was forked
/// from one that used Reflet.
#[pyfunction]
#[pyo3(signature = (
    scene=None, *, text=None, folder=None, assets=None, set=None, variant=None, project=None, lenient=false,
    strict=false, camera=None, size=None, samples=None, method=None, adapter=None, shaders=None
))]
pub fn open(
    py: Python<'_>,
    scene: Option<Bound<'_, PyAny>>,
    text: Option<String>,
    folder: Option<PathBuf>,
    assets: Option<Vec<PathBuf>>,
    set: Option<Bound<'_, PyMapping>>,
    variant: Option<Bound<'_, PyAny>>,
    project: Option<Bound<'_, PyAny>>,
    lenient: bool,
    strict: bool,
    camera: Option<String>,
    size: Option<Bound<'_, PyAny>>,
    samples: Option<i64>,
    method: Option<String>,
    adapter: Option<String>,
    shaders: Option<PathBuf>,
) -> PyResult<Session> {
    work::check_fork(py)?;
    let variables = driver_variables();
    py.import("reflet.environment")?
        .call_method1("prepare", (variables,))?;
    let mut settings = Vec::new();
    if let Some(set) = set {
        settings = settings_of(&set)?;
    }
    if lenient && strict {
        return Err(argument_error(
            py,
            "`lenient` and `strict` exclude each other",
        ));
    }
    let size = integers(size.as_ref()).map_err(|error| of_argument(py, "size", &error))?;
    settings
        .extend(size.map(|[width, height]: [i64; 2]| format!("image.size=[{width}, {height}]")));
    settings.extend(samples.map(|samples| format!("image.samples={samples}")));
    settings.extend(method.map(|method| format!("reflection.method={method:?}")));
    let options = SceneOptions {
        set: settings,
        variant: variant.map_or(Ok(Vec::new()), |variant| names(&variant, "variant"))?,
        assets: assets.unwrap_or_default(),
        lenient,
        strict,
        project: project_choice(project)?,
        ..SceneOptions::default()
    };
    let (path, text) = source_of(py, scene, text, folder)?;
    let source = SceneSource {
        path,
        text: text.map(Arc::from),
        options,
        shaders,
    };
    let options = SessionOptions {
        camera: camera.clone(),
        adapter,
        pipelines: private_folder(PIPELINES),
        ..SessionOptions::default()
    };
    let started = Instant::now();
    let (done, raised) = work::run(py, &AtomicBool::new(false), None, move || {
        Runtime::open_source(source, &options)
    });
    raised?;
    let opened = done.and_then(|opened| opened.map_err(Failure::from));
    let opened = opened.map_err(|failure| failure.into_py(py))?;
    warn(py, opened.warnings())?;
    let load_ms = started.elapsed().as_secs_f64() * 1e3;
    Ok(Session::new(opened, camera, load_ms))
}

/// Path and text of the scene that is given as a path, a text, a dict, or a text in place of the file at a path.
fn source_of(
    py: Python<'_>,
    scene: Option<Bound<'_, PyAny>>,
    text: Option<String>,
    folder: Option<PathBuf>,
) -> PyResult<(Option<PathBuf>, Option<String>)> {
    let named = |name: &str| Some(folder.clone().unwrap_or_default().join(name));
    let Some(scene) = scene else {
        return match text {
            Some(text) => Ok((named(OF_TEXT), Some(text))),
            None if folder.is_some() => Err(argument_error(py, "folder= needs text= or a dict")),
            None => Ok((None, None)),
        };
    };
    if let Ok(scene) = scene.cast::<PyMapping>() {
        return match text {
            None => Ok((named(OF_DICT), Some(scene_text(scene)?))),
            Some(_) => Err(argument_error(py, "a scene is either a dict or text=")),
        };
    }
    let Ok(path) = scene.extract::<PathBuf>() else {
        let text = format!("a scene is a path, a dict or text=, not {}", kind(&scene));
        return Err(argument_error(py, &text));
    };
    match folder {
        None => Ok((Some(path), text)),
        Some(_) => Err(argument_error(
            py,
            "folder= needs text= or a dict; a file has its own folder",
        )),
    }
}

fn project_choice(project: Option<Bound<'_, PyAny>>) -> PyResult<ProjectChoice> {
    let Some(project) = project else {
        return Ok(ProjectChoice::Search);
    };
    match project.extract::<bool>() {
        Ok(true) => Ok(ProjectChoice::Search),
        Ok(false) => Ok(ProjectChoice::None),
        Err(_) => project.extract().map(ProjectChoice::Named),
    }
}
