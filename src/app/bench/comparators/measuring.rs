//! Measurement of systems in a scene, frame by frame.

use crate::{
    app::error::AppError,
    bench::{
        run::{FrameSeries, REFERENCE_BOUNCES, Subject},
        score::{Hits, PLANES, Reference, View},
        systems::{LeftOut, Row, SYSTEMS, SceneRows, System, SystemErrors, frames::FrameRow},
    },
    gpu::{Gpu, GpuError, ShaderLibrary},
    metric::{
        percentile,
        picture::{Pair, PictureError},
        temporal::{Change, Temporal},
    },
    render::{
        Picture, RenderError, passes, pipeline::instrument::Counts, renderer::stats::FrameStats,
        runtime::renderer_stage::RendererStage,
    },
    scene::desc::ReflectionDesc,
};

/// Number of reflective pixels with which a scene is measured at the size that was asked for.
pub(super) const ENOUGH_PX: usize = 1000;
/// Maximum number of times that the size of a scene is doubled.
pub(super) const MOST_DOUBLINGS: u32 = 2;

/// A system in a scene: its renderer, and its measurements until now.
struct Running<'a> {
    system: &'a System,
    renderer: RendererStage,
    settings: ReflectionDesc,
    /// Rows of the frames until now.
    frames: Vec<FrameRow>,
    /// Times of the present frame, milliseconds.
    times_ms: Vec<f64>,
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
    system.set(&mut settings);
    settings
}

/// Error of the renderer, with the built-in shaders.
fn explain(error: RenderError) -> AppError {
    AppError::from_render(error, false)
}

/// Renderer of the reference pictures.
fn reference_renderer(
    gpu: &Gpu,
    library: &ShaderLibrary,
    size: [u32; 2],
    subject: &Subject,
) -> Result<RendererStage, AppError> {
    let mut settings = subject.reflection;
    if let Some(rt) = System::named("rt") {
        rt.set(&mut settings);
    }
    let settings = ReflectionDesc {
        bounces: REFERENCE_BOUNCES,
        reuse_light: false,
        filter: false,
        ..settings
    };
    let truth = subject.renderer(gpu, library, &settings, size);
    truth.map_err(explain)
}

/// Size at which a scene is measured: `size`, doubled until the first frame has [`ENOUGH_PX`] reflective pixels to
/// score, at most [`MOST_DOUBLINGS`] times, and no further than the adapter allows.
///
/// # Errors
/// Frames that cannot be posed, errors of the renderer.
pub(super) fn scored_size(
    gpu: &Gpu,
    library: &ShaderLibrary,
    size: [u32; 2],
    series: &mut FrameSeries,
) -> Result<[u32; 2], AppError> {
    let frame = series.frames().next().unwrap_or(0);
    let subject = series.posed_at(frame).map_err(AppError::Scene)?;
    let px = |size: [u32; 2]| {
        let mut truth = reference_renderer(gpu, library, size, subject)?;
        let picture = picture(gpu, subject, &mut truth).map_err(explain)?;
        let reference = Reference::new(&picture).map_err(AppError::Internal)?;
        Ok::<_, AppError>(reference.mask.area())
    };
    let (mut found, mut found_px) = (size, px(size)?);
    // A frame without any reflective pixel has none at a larger size either.
    while (1..ENOUGH_PX).contains(&found_px) && found[0] < size[0] << MOST_DOUBLINGS {
        let larger = found.map(|side| 2 * side);
        let Ok(larger_px) = px(larger) else { break };
        (found, found_px) = (larger, larger_px);
    }
    Ok(found)
}

/// Measures all systems in a scene, frame by frame, taking turns; each picture is timed so many times.
///
/// # Errors
/// Frames that cannot be posed, errors of the renderer.
pub(super) fn measure(
    gpu: &Gpu,
    library: &ShaderLibrary,
    size: [u32; 2],
    turns: u32,
    series: &mut FrameSeries,
) -> Result<SceneRows, AppError> {
    let frames: Vec<u32> = series.frames().collect();
    let first = series.posed_at(frames[0]).map_err(AppError::Scene)?;
    let mut truth = reference_renderer(gpu, library, size, first)?;
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
    let mut scored_px = Vec::new();
    for frame in &frames {
        let subject = series.posed_at(*frame).map_err(AppError::Scene)?;
        let picture = picture(gpu, subject, &mut truth).map_err(explain)?;
        let reference = Reference::new(&picture).map_err(AppError::Internal)?;
        if reference.mask.is_scorable() {
            scored_px.push(reference.mask.area());
        }
        for system in &mut running {
            judge(gpu, subject, &reference, system)?;
        }
        for _ in 0..turns {
            for system in &mut running {
                time(gpu, subject, system).map_err(explain)?;
            }
        }
        for system in &mut running {
            let median_ms = percentile(&mut std::mem::take(&mut system.times_ms), 0.5);
            if let Some(row) = system.frames.last_mut() {
                row.ms = median_ms;
            }
        }
    }
    let probes = running
        .iter()
        .filter_map(|r| r.last.as_ref()?.maps.as_ref()?.facts.count("probes"));
    Ok(SceneRows {
        scene: series.name().to_owned(),
        size,
        frames: frames.len(),
        scored_px,
        probes: probes.max().unwrap_or(0) as u32,
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
    renderer.picture(gpu, &subject.camera, &PLANES)
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
    renderer.render(gpu, &subject.camera)?;
    renderer.recapture_maps();
    let stats = renderer.render(gpu, &subject.camera)?;
    let counted = renderer.counts(gpu, &subject.camera)?;
    let found = counted
        .iter()
        .filter(|pass| passes::finds_reflections(pass.pass));
    let work = found.map(|pass| pass.counts);
    Ok(Running {
        system,
        renderer,
        settings,
        frames: Vec::new(),
        times_ms: Vec::new(),
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
    let hits = Hits::from_planes(&picture.planes);
    let answers = system.settings.method.answers_all();
    let errors = reference.errors(&view, hits.as_ref(), answers);
    let errors = errors.map_err(internal)?;
    let wrong = hits.map_or(0.0, |hits| reference.wrong_share(&hits, answers));
    system.frames.push(FrameRow {
        frame: subject.frame,
        ms: 0.0,
        update_ms: picture.stats.prepared_ms(),
        errors: errors.mask.map(|scores| SystemErrors {
            flip: scores.flip_mean,
            flip_p99: scores.flip_p99,
            ssim: scores.ssim,
            wrong_percent: 100.0 * wrong,
        }),
    });
    let pair = Pair::new(&view.linear, &reference.view.linear).map_err(internal)?;
    let change = system.temporal.push(&pair, Some(&reference.mask));
    let change = change.map_err(internal)?;
    system
        .changes
        .extend(change.filter(|_| reference.mask.is_scorable()));
    Ok(())
}

/// Times a system's passes in one picture.
fn time(gpu: &Gpu, subject: &Subject, system: &mut Running<'_>) -> Result<(), RenderError> {
    let stats = (system.renderer).render(gpu, &subject.camera)?;
    system
        .times_ms
        .push(passes::reflection_ms(stats.costs_ms()));
    system.last = Some(stats);
    Ok(())
}

/// Measurements of a system over all frames.
fn row(system: Running<'_>) -> Row {
    let frames = system.frames;
    let of = |value: fn(&FrameRow) -> f64| frames.iter().map(value).collect::<Vec<_>>();
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let reference = most(&mut system.changes.iter().map(|c| c.reference));
    let difference = most(&mut system.changes.iter().map(|c| c.difference));
    let stats = system.last.as_ref();
    Row {
        system: system.system.name,
        ms: percentile(&mut of(|frame| frame.ms), 0.5),
        errors: errors_over(&frames),
        popping: (reference > 0.0).then(|| difference / reference),
        nodes: system.work.visited_nodes,
        steps: system.work.march_steps,
        bytes: stats.map_or(0, |s| s.bytes.iter().map(|(_, bytes)| bytes).sum()),
        prepared_bytes: stats.and_then(prepared).map_or(0, |(bytes, _)| bytes),
        prepare_ms: system.prepare_ms,
        update_ms: percentile(&mut of(|frame| frame.update_ms), 0.5),
        frames,
    }
}

/// Errors over the frames that are scored; none where none is.
fn errors_over(frames: &[FrameRow]) -> Option<SystemErrors> {
    let scored: Vec<SystemErrors> = frames.iter().filter_map(|frame| frame.errors).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let of = |value: fn(&SystemErrors) -> f64| scored.iter().map(value).collect::<Vec<_>>();
    let ssim: Option<Vec<f64>> = scored.iter().map(|errors| errors.ssim).collect();
    (!scored.is_empty()).then(|| SystemErrors {
        flip: mean(&of(|errors| errors.flip)),
        flip_p99: of(|errors| errors.flip_p99).into_iter().fold(0.0, f64::max),
        ssim: ssim.map(|values| mean(&values)),
        wrong_percent: mean(&of(|errors| errors.wrong_percent)),
    })
}

/// Bytes and build time, in milliseconds, of structures that are made apart from a frame; `None` without any.
fn prepared(stats: &FrameStats) -> Option<(u64, f64)> {
    let structures = || Some((stats.structure_bytes()?, stats.structures_ms));
    stats.captured().or_else(structures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_without_enough_reflective_pixels_have_no_share_in_errors() {
        let frame = |flip: Option<f64>| FrameRow {
            frame: 0,
            ms: 1.0,
            update_ms: 0.0,
            errors: flip.map(|flip| SystemErrors {
                flip,
                flip_p99: 2.0 * flip,
                ..SystemErrors::default()
            }),
        };
        let frames = [Some(0.1), None, Some(0.3)].map(frame);
        let errors = errors_over(&frames).expect("two frames are scored");
        assert_eq!((errors.flip, errors.flip_p99), (0.2, 0.6));
        assert_eq!(errors_over(&frames[1..2]), None);
    }
}
