//! Steps along seams between probes, in scenes made to provoke them.

use std::path::Path;

use super::measuring::explain;
use crate::{
    app::{bench::timeline::frame_series, error::AppError, scene::load_scene},
    bench::{
        run::{FrameSeries, REFERENCE_BOUNCES, Subject},
        score::{self, Reference, View},
        seams::{self, Looked},
        systems::probe_seams::SeamRow,
    },
    gpu::{Gpu, ShaderLibrary},
    render::{Picture, runtime::renderer_stage::RendererStage},
    scene::desc::{Method, ProbesDesc, ReflectionDesc, SelectBy},
};
use reflet_render::maps::probe_choice::MOST_BLENDED;

/// Scenes, in the order of the table: a floor of several objects, and one object that moves.
const SCENES: [&str; 2] = [
    "scenes/fail/30-probe-seams.toml",
    "scenes/fail/29-probe-borders.toml",
];

/// Measures the seams of all scenes. Those that are not below the current folder are left out, with a note.
///
/// # Errors
/// Scenes that do not load, errors of the renderer.
pub(super) fn rows(
    gpu: &Gpu,
    library: &ShaderLibrary,
    size: [u32; 2],
) -> Result<Vec<SeamRow>, AppError> {
    let mut rows = Vec::new();
    for scene in SCENES {
        let path = Path::new(scene);
        if !path.is_file() {
            reflet_base::error_line!("note: {scene} is not here: its seams are left out");
            continue;
        }
        let loaded = load_scene(Some(path), &<_>::default(), &[])?;
        let list = loaded.scene.timeline.is_some().then_some("all");
        let mut series = frame_series(loaded, scene.to_owned(), None, list)?;
        rows.extend(of_scene(gpu, library, size, &mut series)?);
    }
    Ok(rows)
}

/// Rows of a scene, one for each point by which probes are chosen.
fn of_scene(
    gpu: &Gpu,
    library: &ShaderLibrary,
    size: [u32; 2],
    series: &mut FrameSeries,
) -> Result<Vec<SeamRow>, AppError> {
    let frames: Vec<u32> = series.frames().collect();
    let first = series.at(frames[0]).map_err(AppError::Scene)?;
    let own = ReflectionDesc {
        filter: false,
        ..first.reflection
    };
    let reference = ReflectionDesc {
        method: Method::Rt,
        bounces: REFERENCE_BOUNCES,
        ..own
    };
    let start = |settings: &ReflectionDesc| {
        let renderer = first.renderer(gpu, library, settings, size);
        renderer.map_err(explain)
    };
    let mut truth = start(&reference)?;
    let by = [SelectBy::Pixel, SelectBy::Instance].map(|select| looking_up(&own, select, 1));
    let mut renderers = [start(&by[0])?, start(&by[1])?];
    let selects = by.map(|settings| settings.probes.select);
    let mut steps: [[Vec<f64>; MOST_BLENDED]; 2] = Default::default();
    for frame in frames {
        let subject = series.at(frame).map_err(AppError::Scene)?;
        let picture = picture(gpu, subject, &mut truth)?;
        let reference = Reference::new(&picture).map_err(AppError::Internal)?;
        for ((select, renderer), steps) in selects.iter().zip(&mut renderers).zip(&mut steps) {
            for (nearest, steps) in (1..).zip(steps) {
                let settings = looking_up(&own, *select, nearest);
                steps.extend(step(gpu, subject, &settings, renderer, &reference)?);
            }
        }
    }
    let mean = |of: Vec<f64>| (!of.is_empty()).then(|| of.iter().sum::<f64>() / of.len() as f64);
    let rows = selects
        .into_iter()
        .zip(steps)
        .map(|(select, steps)| SeamRow {
            scene: series.name().to_owned(),
            select,
            steps: steps.map(mean),
        });
    Ok(rows.collect())
}

/// Settings that look up in so many probes.
fn looking_up(own: &ReflectionDesc, select: SelectBy, nearest: u32) -> ReflectionDesc {
    ReflectionDesc {
        method: Method::Probe,
        probes: ProbesDesc {
            select,
            nearest,
            ..own.probes
        },
        ..*own
    }
}

fn picture(
    gpu: &Gpu,
    subject: &Subject,
    renderer: &mut RendererStage,
) -> Result<Picture, AppError> {
    let planes = [&score::PLANES[..], &seams::PLANES].concat();
    renderer.update(gpu, &subject.world).map_err(explain)?;
    let picture = renderer.picture(gpu, &subject.camera, &planes);
    picture.map_err(explain)
}

/// Step along the seams of a picture by these settings.
fn step(
    gpu: &Gpu,
    subject: &Subject,
    settings: &ReflectionDesc,
    renderer: &mut RendererStage,
    reference: &Reference,
) -> Result<Option<f64>, AppError> {
    renderer.set_reflection_parameters(settings);
    let picture = picture(gpu, subject, renderer)?;
    let view = View::new(&picture, picture.size).map_err(|e| AppError::Internal(e.to_string()))?;
    let looked = Looked {
        world: &subject.world,
        camera: &subject.camera,
        settings,
        picture: &picture,
    };
    Ok(looked.seam_step(&view, reference))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scenes_are_shipped() {
        for scene in SCENES {
            assert!(Path::new(scene).is_file(), "{scene}");
        }
    }
}
