//! `bench reload`: time from a save to the new picture, split by its parts.

use std::{path::PathBuf, sync::Arc};

use clap::Args;
use serde::Serialize;

use super::{create_folder, progress::Progress, write_json};
use crate::{
    app::{
        args::{SceneArgs, parse_size},
        error::AppError,
        print_out,
        scene::{check_reports, load_scene},
    },
    bench::{host::Host, run::Observer as _},
    gpu::{Gpu, driver::open_gpu},
};
use reflet_preview::live::{InitialBuild, Live, ViewOverrides};

pub mod copy;
pub mod measure;
pub mod series;
#[cfg(feature = "serve")]
pub mod viewer;

use copy::{Edit, Edited, SceneCopy};
use measure::PREVIEW;
use series::{Measurement, Sample, Series, table};

/// Arguments of `bench reload`.
#[derive(Clone, Debug, Args)]
pub struct ReloadArgs {
    /// Scene file or model, which is copied and edited in the copy; without one, the built-in atrium
    pub scene: Option<PathBuf>,
    /// Changes to the scene
    #[command(flatten)]
    pub from: SceneArgs,
    /// Saves of each kind, 1 to 10000; from 20 on, percentiles are reported
    #[arg(long = "n", value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub saves: u32,
    /// Folder of shaders to copy in place of the built-in ones
    #[arg(long, value_name = "DIR")]
    pub shaders: Option<PathBuf>,
    /// Measure until a viewer of the preview's page has the picture (`preview --serve`)
    #[arg(long)]
    pub page: bool,
    /// Width and height of the preview's picture
    #[arg(long, value_name = "WxH", default_value = "320x180", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Folder for reload.json; created if it is missing
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    pub output: PathBuf,
    /// Use the adapter whose name contains this; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Contents of `reload.json`.
#[derive(Serialize)]
struct Report<'a> {
    host: &'a Host,
    scene: &'a str,
    size: [u32; 2],
    series: &'a [Series],
}

/// Runs the command `bench reload`.
///
/// # Errors
/// A scene or shaders that do not open, no usable GPU, a folder that cannot be written to.
pub fn reload(args: &ReloadArgs) -> Result<(), AppError> {
    create_folder(&args.output)?;
    let mut may_query = false;
    if let Some(scene) = &args.scene {
        let loaded = load_scene(Some(scene), &args.from, &[])?;
        check_reports(&args.output, &["reload.json"], Some(scene), &loaded)?;
        may_query = loaded.scene.reflection.may_query();
    }
    let gpu = Arc::new(open_gpu(args.adapter.as_deref(), may_query)?);
    let mut progress = Progress::new();
    match args.page {
        #[cfg(feature = "serve")]
        true => {
            let series = measure_page(&gpu, args, &mut progress)?;
            report(args, &gpu, &series, &viewer::PAGE)
        }
        #[cfg(not(feature = "serve"))]
        true => Err(AppError::Usage(
            "--page: this program was built without the preview's page".to_owned(),
        )),
        false => {
            let series = measure_all(&gpu, args, &mut progress)?;
            report(args, &gpu, &series, &PREVIEW)
        }
    }
}

/// Writes `reload.json` and prints the table.
fn report(
    args: &ReloadArgs,
    gpu: &Gpu,
    series: &[Series],
    what: &Measurement,
) -> Result<(), AppError> {
    let scene = (args.scene.as_ref()).map_or_else(
        || "the built-in atrium".to_owned(),
        |path| path.display().to_string(),
    );
    let host = Host::detect(gpu);
    let report = Report {
        host: &host,
        scene: &scene,
        size: args.size,
        series,
    };
    let path = args.output.join("reload.json");
    write_json(&path, &report)?;
    reflet_base::error_line!("wrote {}", path.display());
    let [width, height] = args.size;
    print_out(&format!(
        "{scene}, {} saves each, {width}x{height} on {}\n\n{}",
        args.saves,
        host.adapter,
        table(series, what)
    ))
}

/// Measures repeated saves of every kind of edit in a copy of the scene, until the preview has rendered each.
///
/// # Errors
/// Same errors as [`reload`].
pub fn measure_all(
    gpu: &Arc<Gpu>,
    args: &ReloadArgs,
    progress: &mut Progress,
) -> Result<Vec<Series>, AppError> {
    let view = ViewOverrides {
        size: Some(args.size),
        ..ViewOverrides::default()
    };
    each_edit(args, progress, &PREVIEW, |copy, edit, edited, progress| {
        let mut live = Live::open(
            gpu.clone(),
            copy.origin(),
            view.clone(),
            InitialBuild::Whole,
        )
        .map_err(|error| AppError::from_session(error, false))?;
        measure::saves(&mut live, args.saves, progress, edit, |i| edited.save(i))
    })
}

/// Measures them until a viewer of the page has the picture of each.
///
/// # Errors
/// Same errors as [`reload`].
#[cfg(feature = "serve")]
pub fn measure_page(
    gpu: &Arc<Gpu>,
    args: &ReloadArgs,
    progress: &mut Progress,
) -> Result<Vec<Series>, AppError> {
    each_edit(
        args,
        progress,
        &viewer::PAGE,
        |copy, _, edited, progress| {
            viewer::saves(gpu, copy.origin(), args.size, args.saves, progress, |i| {
                edited.save(i)
            })
        },
    )
}

/// Calls `measure` for every kind of edit that a copy of the scene can have.
fn each_edit(
    args: &ReloadArgs,
    progress: &mut Progress,
    what: &Measurement,
    mut measure: impl FnMut(&SceneCopy, Edit, &Edited, &mut Progress) -> Result<Vec<Sample>, AppError>,
) -> Result<Vec<Series>, AppError> {
    let copy = SceneCopy::new(args.scene.as_deref(), &args.from, args.shaders.as_deref())?;
    let mut all = Vec::new();
    let edits = [
        Edit::Text,
        Edit::Shader("tone.wgsl"),
        Edit::Shader("ssr.wgsl"),
        Edit::Shader("paths.wgsl"),
        // The script is last, for it may have to be added to the scene.
        Edit::Script,
    ];
    for edit in edits {
        let Some(edited) = copy.edited(edit)? else {
            continue;
        };
        progress.note(&format!(
            "{} {} edits of {}",
            args.saves,
            edit.name(),
            edited.name()
        ));
        let samples = measure(&copy, edit, &edited, progress)?;
        all.push(Series::new(edit, edited.name(), samples, what));
    }
    Ok(all)
}
