//! Measurement of systems in a scene, frame by frame.

use crate::{
    app::error::AppError,
    bench::{
        metric::temporal::{Change, Temporal},
        picture::{Pair, PictureError},
        run::{FrameSeries, REFERENCE_BOUNCES, Subject},
        score::{Hits, PLANES, Reference, View},
        systems::{LeftOut, Row, SYSTEMS, SceneRows, System, frames::FrameRow},
    },
    gpu::{Gpu, GpuError, ShaderLibrary},
    render::{
        Picture, RenderError, instrument::Counts, passes, runtime::renderer_stage::RendererStage,
        stats::FrameStats,
    },
    scene::desc::{Method, ReflectionDesc},
};

/// A system in a scene: its renderer, and what was measured until now.
struct Running<'a> {
    system: &'a System,
    renderer: RendererStage,
    settings: ReflectionDesc,
    /// Rows of the frames until now.
    frames: Vec<FrameRow>,
    /// Times of the present frame, milliseconds.
    times_ms: Vec<f64>,
    flip_p99: f64,
    changes: Vec<Change>,
    temporal: Temporal,
    last: Option<FrameStats>,
    work: Counts,
    prepare_ms: f64,
}

/// Settings of the system in a scene; pictures are not smoothed, as in all benchmarks. A scene without probes gets a
/// grid of two along its longest edge.
pub(super) fn settings(system: &System, subject: &Subject) -> ReflectionDesc {
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

/// Error of the renderer, with the built-in shaders.
pub(super) fn explain(error: RenderError) -> AppError {
    AppError::from_render(error, false)
}

/// Measures all systems in a scene, frame by frame, taking turns; each picture is timed so many times.
///
/// # Errors
/// Frames that cannot be posed, errors of the renderer.
pub(in crate::app::bench) fn measure(
    gpu: &Gpu,
    library: &ShaderLibrary,
    (size, turns): ([u32; 2], u32),
    series: &mut FrameSeries,
) -> Result<SceneRows, AppError> {
    let frames: Vec<u32> = series.frames().collect();
    let first = series.at(frames[0]).map_err(AppError::Scene)?;
    let reference = ReflectionDesc {
        method: Method::Rt,
        bounces: REFERENCE_BOUNCES,
        reuse_light: false,
        filter: false,
        rate: 1,
        skip_px: 0.0,
        ..first.reflection
    };
    let truth = first.renderer(gpu, library, &reference, size);
    let mut truth = truth.map_err(explain)?;
    let (mut running, mut left_out) = (Vec::new(), Vec::new());
    for system in SYSTEMS {
        match start(gpu, library, size, first, system) {
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
        for _ in 0..turns {
            for system in &mut running {
                time(gpu, subject, system).map_err(explain)?;
            }
        }
        for system in &mut running {
            let median_ms = median(std::mem::take(&mut system.times_ms));
            if let Some(row) = system.frames.last_mut() {
                row.ms = median_ms;
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
pub(super) fn picture(
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
    size: [u32; 2],
    subject: &Subject,
    system: &'a System,
) -> Result<Running<'a>, RenderError> {
    let settings = settings(system, subject);
    let mut renderer = subject.renderer(gpu, library, &settings, size)?;
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
        frames: Vec::new(),
        times_ms: Vec::new(),
        flip_p99: 0.0,
        changes: Vec::new(),
        temporal: Temporal::new(),
        prepare_ms: prepared(&stats).map_or(0.0, |(_, ms)| ms),
        last: Some(stats),
        work: work.fold(Counts::default(), Counts::plus),
    })
}

/// Scores a system's picture of a frame, the first after the scene has moved.
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
    let answers = system.settings.method.answers_all();
    let errors = reference.errors(&view, hits.as_ref(), answers);
    let errors = errors.map_err(internal)?;
    let scores = errors.mask.as_ref().unwrap_or(&errors.frame);
    let wrong = hits.map_or(0.0, |hits| reference.wrong_share(&hits, answers));
    system.frames.push(FrameRow {
        frame: subject.frame,
        ms: 0.0,
        update_ms: picture.stats.prepared_ms(),
        flip: scores.flip_mean,
        ssim: scores.ssim,
        wrong_percent: 100.0 * wrong,
    });
    system.flip_p99 = system.flip_p99.max(scores.flip_p99);
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

/// The median, of an even number the larger one in the middle; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Measurements of a system over all frames.
fn row(system: Running<'_>) -> Row {
    let frames = system.frames;
    let of = |value: fn(&FrameRow) -> f64| frames.iter().map(value).collect::<Vec<_>>();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let reference = most(&mut system.changes.iter().map(|c| c.reference));
    let difference = most(&mut system.changes.iter().map(|c| c.difference));
    let ssim: Option<Vec<f64>> = frames.iter().map(|frame| frame.ssim).collect();
    let stats = system.last.as_ref();
    Row {
        system: system.system.name,
        ms: median(of(|frame| frame.ms)),
        flip: mean(&of(|frame| frame.flip)),
        flip_p99: system.flip_p99,
        ssim: ssim.map(|values| mean(&values)),
        wrong_percent: mean(&of(|frame| frame.wrong_percent)),
        popping: (reference > 0.0).then(|| difference / reference),
        nodes: system.work.visited_nodes,
        steps: system.work.march_steps,
        bytes: stats.map_or(0, |s| s.bytes.iter().map(|(_, bytes)| bytes).sum()),
        prepared_bytes: stats.and_then(prepared).map_or(0, |(bytes, _)| bytes),
        prepare_ms: system.prepare_ms,
        update_ms: median(of(|frame| frame.update_ms)),
        frames,
    }
}

/// Bytes of what is made apart from a frame, and the time that it took, milliseconds; `None` where that is nothing.
fn prepared(stats: &FrameStats) -> Option<(u64, f64)> {
    let structures = || Some((stats.structure_bytes()?, stats.structures_ms));
    stats.captured().or_else(structures)
}
