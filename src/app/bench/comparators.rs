//! `bench comparators`: the document that sets other ways of finding reflections beside Reflet's own.

mod failures;

use std::path::Path;

use super::{args::ComparatorsArgs, create_folder, timeline::frame_series, write};
use crate::{
    app::{device, error::AppError, scene::load_scene, shaders},
    bench::{
        metric::temporal::{Change, Temporal},
        picture::{Pair, PictureError},
        run::{FrameSeries, REFERENCE_BOUNCES, Subject},
        score::{Errors, Hits, PLANES, Reference, View},
        systems::{
            LeftOut, Row, SYSTEMS, SceneRows, System, best, chart,
            document::{Conditions, document},
        },
    },
    gpu::{Gpu, GpuError, ShaderLibrary, adapter},
    render::{
        Picture, RenderError, passes, probe::Counts, runtime::renderer_stage::RendererStage,
        stats::FrameStats,
    },
    scene::desc::{Method, ReflectionDesc},
};

/// Number of systems in the chart over all scenes.
const BEST: usize = 5;
/// File name of the chart over all scenes.
const BEST_CHART: &str = "comparators-best.svg";

/// A system in a scene: its renderer, and what was measured until now.
struct Running<'a> {
    system: &'a System,
    renderer: RendererStage,
    settings: ReflectionDesc,
    times_ms: Vec<f64>,
    errors: Vec<Errors>,
    wrong: Vec<f64>,
    changes: Vec<Change>,
    temporal: Temporal,
    last: Option<FrameStats>,
    work: Counts,
    prepare_ms: f64,
}

/// Settings of the system in a scene; pictures are not smoothed, as in all benchmarks. A scene without probes gets a
/// grid of two along its longest edge.
fn settings(system: &System, subject: &Subject) -> ReflectionDesc {
    let mut settings = ReflectionDesc {
        filter: false,
        ..subject.reflection
    };
    if subject.world.probes.is_empty() && settings.probes.spacing_m.is_none() {
        let bounds = subject.world.static_bounds();
        let longest_m = (bounds.max - bounds.min).max_element();
        settings.probes.spacing_m = (longest_m > 0.0).then_some(0.5 * longest_m);
    }
    (system.set)(&mut settings);
    settings
}

/// Runs the command.
///
/// # Errors
/// Scenes that do not load, a folder that cannot be written to, errors of the renderer.
pub fn comparators(args: &ComparatorsArgs) -> Result<(), AppError> {
    create_folder(&args.output)?;
    let library = shaders::library(None)?;
    let gpu = device::open_gpu(args.adapter.as_deref(), true)?;
    let mut scenes = Vec::new();
    for path in &args.scenes {
        let loaded = load_scene(Some(path), &args.from, &[])?;
        let is_film = loaded.scene.timeline.is_some();
        let list = is_film.then_some(args.timeline.as_str());
        let name = path.display().to_string();
        let mut series = frame_series(loaded, name, None, list)?;
        let rows = measure(&gpu, &library, args, &mut series)?;
        reflet_base::error_line!("measured {}", rows.scene);
        scenes.push(rows);
    }
    for scene in &scenes {
        let svg = chart::of_scene(scene).map_err(AppError::Internal)?;
        write(&args.output.join(chart_name(&scene.scene)), svg.as_bytes())?;
    }
    let best = best(&scenes, BEST);
    let svg = chart::of_several(&best).map_err(AppError::Internal)?;
    write(&args.output.join(BEST_CHART), svg.as_bytes())?;
    let about = Conditions {
        command: command(args),
        adapter: adapter::name(&gpu.adapter_info),
        size: args.size,
        frames: args.frames,
        is_processor: gpu.is_software(),
    };
    let best_chart = format!("charts/{BEST_CHART}");
    let failures = failures::failures(&gpu, &library, args)?;
    let text = document(&about, &scenes, (&best, &best_chart), &failures, |scene| {
        format!("charts/{}", chart_name(&scene.scene))
    });
    write(&args.document, text.as_bytes())?;
    reflet_base::error_line!("wrote {}", args.document.display());
    Ok(())
}

/// File name of a scene's chart.
fn chart_name(scene: &str) -> String {
    let stem = Path::new(scene).file_stem().unwrap_or_default();
    format!("comparators-{}.svg", stem.to_string_lossy())
}

/// The command line that writes the same document.
fn command(args: &ComparatorsArgs) -> String {
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
        "reflet bench comparators {}{set}{assets} --size {}x{} --frames {} --timeline {} -o {} --document {}",
        scenes.join(" "),
        args.size[0],
        args.size[1],
        args.frames,
        args.timeline,
        args.output.display(),
        args.document.display()
    )
}

/// Error of the renderer, with the built-in shaders.
fn explain(error: RenderError) -> AppError {
    AppError::from_render(error, false)
}

/// Measures all systems in a scene, frame by frame, taking turns.
fn measure(
    gpu: &Gpu,
    library: &ShaderLibrary,
    args: &ComparatorsArgs,
    series: &mut FrameSeries,
) -> Result<SceneRows, AppError> {
    let frames: Vec<u32> = series.frames().collect();
    let first = series.at(frames[0]).map_err(AppError::Scene)?;
    let reference = ReflectionDesc {
        method: Method::Rt,
        bounces: REFERENCE_BOUNCES,
        reuse_light: false,
        filter: false,
        skip_px: 0.0,
        ..first.reflection
    };
    let truth = first.renderer(gpu, library, &reference, args.size);
    let mut truth = truth.map_err(explain)?;
    let (mut running, mut left_out) = (Vec::new(), Vec::new());
    for system in SYSTEMS {
        match start(gpu, library, args, first, system) {
            Ok(started) => running.push(started),
            Err(error) => left_out.push(LeftOut {
                system: system.name,
                why: refusal(error)?,
            }),
        }
    }
    let mut mask_px = usize::MAX;
    for frame in &frames {
        let subject = series.at(*frame).map_err(AppError::Scene)?;
        let picture = picture(gpu, subject, &mut truth).map_err(explain)?;
        let reference = Reference::new(&picture).map_err(AppError::Internal)?;
        mask_px = mask_px.min(reference.mask.area());
        for system in &mut running {
            judge(gpu, subject, &reference, system)?;
        }
        let timed = if frames.len() > 1 { 1 } else { args.frames };
        for _ in 0..timed {
            for system in &mut running {
                time(gpu, subject, system).map_err(explain)?;
            }
        }
    }
    let probes = running.iter().filter_map(|r| r.last.as_ref()?.probes);
    Ok(SceneRows {
        scene: series.name().to_owned(),
        frames: frames.len(),
        mask_px,
        probes: probes.map(|p| p.probes).max().unwrap_or(0),
        rows: running.into_iter().map(row).collect(),
        left_out,
    })
}

/// Why the adapter or the scene refuses a system.
///
/// # Errors
/// Any other error of the renderer.
fn refusal(error: RenderError) -> Result<String, AppError> {
    match error {
        RenderError::Scene(_) | RenderError::Gpu(GpuError::Limit { .. }) => Ok(error.to_string()),
        other => Err(explain(other)),
    }
}

/// Picture of a subject with the planes that are scored.
fn picture(
    gpu: &Gpu,
    subject: &Subject,
    renderer: &mut RendererStage,
) -> Result<Picture, RenderError> {
    renderer.update(gpu, &subject.world)?;
    renderer.picture(gpu, &subject.world, &subject.camera, &PLANES)
}

/// Builds a system, renders its first picture, in which drivers compile, and times a capture.
fn start<'a>(
    gpu: &Gpu,
    library: &ShaderLibrary,
    args: &ComparatorsArgs,
    subject: &Subject,
    system: &'a System,
) -> Result<Running<'a>, RenderError> {
    let settings = settings(system, subject);
    let mut renderer = subject.renderer(gpu, library, &settings, args.size)?;
    renderer.set_reflection_parameters(&settings);
    renderer.render(gpu, &subject.world, &subject.camera)?;
    renderer.recapture_probes();
    let stats = renderer.render(gpu, &subject.world, &subject.camera)?;
    let counted = renderer.counts(gpu, &subject.world, &subject.camera)?;
    let found = counted.iter().filter(|pass| finds(pass.pass));
    let work = found.map(|pass| pass.counts);
    Ok(Running {
        system,
        renderer,
        settings,
        times_ms: Vec::new(),
        errors: Vec::new(),
        wrong: Vec::new(),
        changes: Vec::new(),
        temporal: Temporal::new(),
        prepare_ms: prepared(&stats).map_or(0.0, |(_, ms)| ms),
        last: Some(stats),
        work: work.fold(Counts::default(), Counts::plus),
    })
}

/// Scores a system's picture of a frame.
fn judge(
    gpu: &Gpu,
    subject: &Subject,
    reference: &Reference,
    system: &mut Running<'_>,
) -> Result<(), AppError> {
    let picture = picture(gpu, subject, &mut system.renderer).map_err(explain)?;
    let internal = |error: PictureError| AppError::Internal(error.to_string());
    let view = View::new(&picture, picture.size).map_err(internal)?;
    let hits = Hits::of(&picture.planes);
    let answers = system.settings.method != Method::Ssr;
    let errors = reference.errors(&view, hits.as_ref(), answers);
    system.errors.push(errors.map_err(internal)?);
    let wrong = hits.map_or(0.0, |hits| reference.wrong_share(&hits, answers));
    system.wrong.push(wrong);
    let pair = Pair::new(&view.linear, &reference.view.linear).map_err(internal)?;
    let change = system.temporal.push(&pair, Some(&reference.mask));
    system.changes.extend(change.map_err(internal)?);
    Ok(())
}

/// Whether the pass of this name finds reflections.
fn finds(name: &str) -> bool {
    passes::named(name).is_some_and(|p| p.group.finds_reflections())
}

/// Times a system's passes in one picture.
fn time(gpu: &Gpu, subject: &Subject, system: &mut Running<'_>) -> Result<(), RenderError> {
    let stats = (system.renderer).render(gpu, &subject.world, &subject.camera)?;
    let passes = match stats.processor_ms.as_slice() {
        [] => &stats.passes_ms,
        passes => passes,
    };
    let found = passes.iter().filter(|(name, _)| finds(name));
    system.times_ms.push(found.map(|(_, ms)| ms).sum());
    system.last = Some(stats);
    Ok(())
}

/// Measurements of a system over all frames.
fn row(mut system: Running<'_>) -> Row {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let scores: Vec<_> = system
        .errors
        .iter()
        .map(|e| e.mask.as_ref().unwrap_or(&e.frame))
        .collect();
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let reference = most(&mut system.changes.iter().map(|c| c.reference));
    let difference = most(&mut system.changes.iter().map(|c| c.difference));
    let ssim: Option<Vec<f64>> = scores.iter().map(|s| s.ssim).collect();
    system.times_ms.sort_by(f64::total_cmp);
    let stats = system.last.as_ref();
    Row {
        system: system.system.name,
        ms: system
            .times_ms
            .get(system.times_ms.len() / 2)
            .copied()
            .unwrap_or(0.0),
        flip: mean(&scores.iter().map(|s| s.flip_mean).collect::<Vec<_>>()),
        flip_p99: most(&mut scores.iter().map(|s| s.flip_p99)),
        ssim: ssim.map(|values| mean(&values)),
        wrong_percent: 100.0 * mean(&system.wrong),
        popping: (reference > 0.0).then(|| difference / reference),
        nodes: system.work.visited_nodes,
        steps: system.work.march_steps,
        bytes: stats.map_or(0, |s| s.bytes.iter().map(|(_, bytes)| bytes).sum()),
        prepared_bytes: stats.and_then(prepared).map_or(0, |(bytes, _)| bytes),
        prepare_ms: system.prepare_ms,
    }
}

/// Bytes of what is made apart from a frame, and the time that it took, milliseconds; `None` where that is nothing.
fn prepared(stats: &FrameStats) -> Option<(u64, f64)> {
    let structures = || {
        let is_theirs = |(name, _): &&(String, u64)| name == "ray_structures";
        let bytes = stats.bytes.iter().find(is_theirs).map_or(0, |(_, b)| *b);
        (stats.structures_ms > 0.0).then_some((bytes, stats.structures_ms))
    };
    stats.captured().or_else(structures)
}
