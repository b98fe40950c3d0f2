//! `render`: a scene becomes picture files.

use std::{path::Path, time::Instant};

use super::{
    cli::{RenderArgs, StatsForm},
    error::AppError,
    output::Output,
    print_json, print_out,
    scene::{LoadedScene, load_scene},
    stats::{Around, Report},
};
use crate::{
    gpu::{Gpu, GpuError, GpuOptions, ShaderLibrary},
    render::{RenderError, RenderOptions, Renderer, aov::Aov},
    scene::desc::{CameraDesc, Entry, Method},
};

/// Renders one picture.
///
/// # Errors
/// Whatever stops it; no file is left half written.
pub fn render(args: &RenderArgs) -> Result<(), AppError> {
    let started = Instant::now();
    // Cheap checks first: a typo must not cost a minute of rendering.
    let output = Output::new(&args.output)?;
    let aovs = choose_aovs(&args.aov)?;
    let library = shader_library(args.shaders.as_deref())?;
    let load_started = Instant::now();
    let loaded = load_scene(args.scene.as_deref(), &args.from, &overrides(args))?;
    let load_ms = load_started.elapsed().as_secs_f64() * 1e3;
    let (_, camera) = choose_camera(&loaded, args.camera.as_deref())?;

    let gpu = Gpu::new(&GpuOptions {
        adapter_filter: args.adapter.clone(),
    })?;
    let options = RenderOptions {
        reflection: loaded.desc.reflection,
        image: loaded.desc.image,
        general: false,
    };
    let failed = |error| explain(error, args.shaders.is_some());
    let world = &loaded.world;
    let mut renderer = Renderer::new(&gpu, &library, world, &options).map_err(failed)?;
    let picture = renderer
        .picture(&gpu, world, &camera, &aovs)
        .map_err(failed)?;
    let around = Around {
        load_ms,
        first_picture_ms: started.elapsed().as_secs_f64() * 1e3,
    };

    for path in output.write(&picture)? {
        eprintln!("wrote {}", path.display());
    }
    let report = Report::new(&gpu, picture.stats, around);
    match args.stats {
        Some(StatsForm::Text) => print_out(&report.table()),
        Some(StatsForm::Json) => print_json(&report),
        None => Ok(()),
    }
}

/// What a failed render means for the user.
pub fn explain(error: RenderError, own_shaders: bool) -> AppError {
    match error {
        RenderError::Gpu(GpuError::Shader(error)) if own_shaders => {
            AppError::from_user_shader(&error)
        }
        RenderError::Gpu(error) => AppError::Gpu(error),
        RenderError::Scene(diagnostic) => AppError::Scene(vec![*diagnostic]),
    }
}

/// The AOVs of a comma-separated list.
fn choose_aovs(names: &[String]) -> Result<Vec<Aov>, AppError> {
    let find = |name: &String| {
        Aov::from_name(name.trim()).ok_or_else(|| {
            let known: Vec<&str> = Aov::ALL.iter().map(|aov| aov.name()).collect();
            AppError::Usage(format!(
                "--aov {name}: there is no such picture; choose from {}",
                known.join(", ")
            ))
        })
    };
    let mut aovs = Vec::new();
    for aov in names.iter().map(find) {
        let aov = aov?;
        if !aovs.contains(&aov) {
            aovs.push(aov);
        }
    }
    Ok(aovs)
}

/// The flags that are scene values, as overrides: one mechanism, and they win over `--set`.
fn overrides(args: &RenderArgs) -> Vec<String> {
    let size = args.size.map(|[w, h]| format!("image.size=[{w}, {h}]"));
    let samples = args
        .samples
        .map(|samples| format!("image.samples={samples}"));
    let method = args.method.map(|method| {
        let word = match method.into() {
            Method::Ssr => "ssr",
            Method::Rt => "rt",
            Method::Hybrid => "hybrid",
        };
        format!("reflection.method=\"{word}\"")
    });
    [size, samples, method].into_iter().flatten().collect()
}

fn shader_library(folder: Option<&Path>) -> Result<ShaderLibrary, AppError> {
    match folder {
        None => Ok(ShaderLibrary::embedded()),
        Some(folder) => {
            ShaderLibrary::from_dir(folder).map_err(|error| AppError::from_user_shader(&error))
        }
    }
}

/// The named camera with its name; without one `main`, else the first.
///
/// # Errors
/// [`AppError::Usage`] with the names that exist.
pub fn choose_camera(
    loaded: &LoadedScene,
    name: Option<&str>,
) -> Result<(String, CameraDesc), AppError> {
    let cameras = &loaded.world.cameras;
    let named = |name: &str| cameras.iter().find(|camera| camera.name == name);
    let found = match name {
        Some(name) => named(name),
        None => named("main").or(cameras.first()),
    };
    let named = |camera: &Entry<CameraDesc>| (camera.name.clone(), camera.value.clone());
    found.map(named).ok_or_else(|| {
        let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        AppError::Usage(format!(
            "--camera {}: {} has no such camera; it has: {}",
            name.unwrap_or_default(),
            loaded.name,
            names.join(", ")
        ))
    })
}
