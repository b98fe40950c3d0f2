//! `bench comparators`: the document that sets other ways of finding reflections beside Reflet's own.

mod failures;
mod measuring;
mod probe_seams;

use std::path::{Path, PathBuf};

use super::{args::ComparatorsArgs, create_folder, timeline::frame_series, write};
use crate::{
    app::{error::AppError, scene::load_scene, shaders},
    bench::systems::{
        SceneRows, chart,
        document::{Conditions, document},
        frames::{self, Curves},
        overall::best,
    },
    gpu::{adapter, driver},
};

pub(super) use measuring::measure;

/// Number of systems in the chart over all scenes.
const BEST: usize = 5;
/// Variable of the environment that sets the number of threads of Mesa's software adapters.
const THREADS: &str = "LP_NUM_THREADS";
/// File name of the chart over all scenes.
const BEST_CHART: &str = "comparators-best.svg";

/// Runs the command.
///
/// # Errors
/// Scenes that do not load, a folder that cannot be written to, errors of the renderer.
pub fn comparators(args: &ComparatorsArgs) -> Result<(), AppError> {
    create_folder(&args.output)?;
    let library = shaders::library(None)?;
    let gpu = driver::open_gpu(args.adapter.as_deref(), true)?;
    let mut scenes = Vec::new();
    for path in &args.scenes {
        let loaded = load_scene(Some(path), &args.from, &[])?;
        let is_film = loaded.scene.timeline.is_some();
        let list = is_film.then_some(args.timeline.as_str());
        let name = path.display().to_string();
        let mut series = frame_series(loaded, name, None, list)?;
        let is_moving = series.frames().count() > 1;
        let turns = if is_moving { 1 } else { args.frames };
        let size = measuring::scored_size(&gpu, &library, args.size, &mut series)?;
        let rows = measure(&gpu, &library, (size, turns), &mut series)?;
        reflet_base::error_line!("measured {}", rows.scene);
        scenes.push(rows);
    }
    for scene in &scenes {
        let svg = chart::of_scene(scene).map_err(AppError::Internal)?;
        let path = |ending: &str| args.output.join(chart_name(&scene.scene, ending));
        write(&path(""), svg.as_bytes())?;
        write_curves(scene, path)?;
    }
    let best = best(&scenes, BEST);
    let svg = chart::of_several(&best).map_err(AppError::Internal)?;
    write(&args.output.join(BEST_CHART), svg.as_bytes())?;
    let threads = std::env::var(THREADS).ok().filter(|_| gpu.is_software());
    let about = Conditions {
        command: command(args, threads.as_deref()),
        adapter: adapter::name(&gpu.adapter_info),
        size: args.size,
        frames: args.frames,
        is_processor: gpu.is_software(),
        threads,
        enough_px: measuring::ENOUGH_PX,
        most_doublings: measuring::MOST_DOUBLINGS,
    };
    let best_chart = format!("charts/{BEST_CHART}");
    let failures = failures::failures(&gpu, &library, args)?;
    let seams = probe_seams::rows(&gpu, &library, args.size)?;
    let text = document(
        &about,
        &scenes,
        (&best, &best_chart),
        (&failures, &seams),
        |scene, ending| format!("charts/{}", chart_name(&scene.scene, ending)),
    );
    write(&args.document, text.as_bytes())?;
    reflet_base::error_line!("wrote {}", args.document.display());
    Ok(())
}

/// File name of a scene's chart; those of a film's frames end by [`Curves::ALL`].
fn chart_name(scene: &str, ending: &str) -> String {
    let stem = Path::new(scene).file_stem().unwrap_or_default();
    format!("comparators-{}{ending}.svg", stem.to_string_lossy())
}

/// Writes the charts of a film's frames, each to the path that its ending gives; none for a still.
///
/// # Errors
/// A chart that cannot be drawn, a folder that cannot be written to.
pub(super) fn write_curves(
    scene: &SceneRows,
    path: impl Fn(&str) -> PathBuf,
) -> Result<(), AppError> {
    for (curves, ending) in Curves::ALL {
        if let Some(svg) = frames::draw(scene, curves).map_err(AppError::Internal)? {
            write(&path(ending), svg.as_bytes())?;
        }
    }
    Ok(())
}

/// The command line that writes the same document.
fn command(args: &ComparatorsArgs, threads: Option<&str>) -> String {
    let threads = threads.map_or(String::new(), |count| format!("{THREADS}={count} "));
    let scenes: Vec<String> = args
        .scenes
        .iter()
        .map(|p| p.display().to_string())
        .collect();
    let set: String = (args.from.set.iter())
        .map(|set| format!(" --set {set}"))
        .collect();
    // The folder's own path is of no use to a reader.
    let assets = if args.from.assets.is_empty() {
        ""
    } else {
        " --assets DIR"
    };
    format!(
        "{threads}reflet bench comparators {}{set}{assets} --size {}x{} --frames {} --timeline {} -o {} --document {}",
        scenes.join(" "),
        args.size[0],
        args.size[1],
        args.frames,
        args.timeline,
        args.output.display(),
        args.document.display()
    )
}
