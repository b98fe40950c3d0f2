//! The worst picture of each mode, by all methods.

use crate::{
    app::{
        bench::report_pictures::{Shot, gallery},
        error::AppError,
    },
    bench::{
        report::page::Gallery,
        run::FrameSeries,
        stability::{Against, Cell, Mode, Part, Place},
    },
    gpu::Gpu,
    scene::desc::{Accept, Method, ReflectionDesc},
};

/// Pictures of every mode that has a score: the one that `hybrid` has most wrong, of a run without it
/// the first method.
///
/// # Errors
/// What the renderer refuses.
pub fn galleries(
    gpu: &Gpu,
    modes: &[Mode],
    cells: &[Cell],
    all_series: &mut [FrameSeries],
) -> Result<Vec<Gallery>, AppError> {
    let mut galleries = Vec::new();
    for mode in modes {
        let Some(Place { frame, size }) = worst(mode, cells) else {
            continue;
        };
        let is_shown = |part: &&Part| shows(part, frame, size);
        let Some(part) = mode.parts.iter().find(is_shown) else {
            continue;
        };
        let series = all_series.iter_mut().find(|s| s.name() == part.scene);
        let Some(series) = series else { continue };
        let subject = series.at(frame).map_err(AppError::Scene)?;
        let (title, about) = mode.heading();
        let shown = gallery(gpu, subject, size, &shots(&subject.reflection))?;
        let at = if part.frames.len() > 1 {
            format!(" Frame {frame}.")
        } else {
            String::new()
        };
        galleries.push(Gallery {
            title,
            text: format!("{about}{at} {}", shown.text),
            figures: shown.figures,
        });
    }
    Ok(galleries)
}

fn shows(part: &Part, frame: u32, size: [u32; 2]) -> bool {
    part.against == Against::Rt && part.size == size && part.frames.contains(&frame)
}

fn worst(mode: &Mode, cells: &[Cell]) -> Option<Place> {
    let of_mode = || {
        let is_of = |c: &&Cell| c.mode == mode.name && c.against == Against::Rt;
        cells.iter().filter(is_of)
    };
    let cell = of_mode().find(|c| c.method == "hybrid");
    let scores = cell.or_else(|| of_mode().next())?.scores.as_ref();
    scores.ok().map(|scores| scores.worst)
}

fn shots(settings: &ReflectionDesc) -> Vec<Shot> {
    let with = |method, accept| ReflectionDesc {
        method,
        accept,
        ..*settings
    };
    let hybrid = with(Method::Hybrid, Accept::Verified);
    let threshold = with(Method::Hybrid, Accept::Threshold);
    vec![
        Shot::Picture(with(Method::Ssr, Accept::Threshold)),
        Shot::Picture(threshold),
        Shot::Picture(hybrid),
        Shot::Picture(with(Method::Rt, Accept::Verified)),
        Shot::Difference(threshold),
        Shot::Difference(hybrid),
        Shot::Source(hybrid),
    ]
}
