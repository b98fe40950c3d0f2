//! `info --frame`: the passes that render a scene, with the data that they leave for each other.

use std::fmt::Write as _;

use serde::Serialize;

use super::trees_of;
use crate::{
    app::error::AppError,
    render::{
        buffers::textures::Layers,
        decide::decide,
        passes::{RecordedPass, recorded_passes},
        plan::{Dropped, Plan},
        settings::precision::Precision,
    },
    runtime::{ViewOverrides, scene_text::LoadedScene},
};

/// A frame as one kind of adapter renders it, with the settings that are decided for this kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedFrame {
    /// Adapters that render this frame.
    pub adapters: String,
    /// Name of the method that finds reflections.
    pub method: &'static str,
    /// Passes in their order.
    pub passes: Vec<RecordedPass>,
    /// Features that the frame leaves out, and why the picture stays the same.
    pub left_out: Vec<Dropped>,
}

/// Frames of a scene: one for each kind of adapter, or a single one where all render the same.
///
/// # Errors
/// [`AppError::Scene`] when its trees cannot be built; [`AppError::Gpu`] for a built-in shader with an error.
pub fn planned_frames(loaded: &LoadedScene) -> Result<Vec<PlannedFrame>, AppError> {
    let world = &loaded.first_frame();
    let options = ViewOverrides::default().options(loaded);
    let trees = trees_of(world, &options)?;
    let layers = Layers::for_world(world);
    let frame = |adapters: &str, is_software: bool| {
        let options = decide(world, &trees, &options, is_software)
            .options
            .settled();
        let plan = Plan::for_world(world, &trees, &layers, &options);
        let full = Precision::for_world(world, &options).full;
        let passes = recorded_passes(&plan, &options, full);
        Ok::<_, AppError>(PlannedFrame {
            adapters: adapters.to_owned(),
            method: options.reflection.method.name(),
            passes: passes.map_err(|error| AppError::Gpu(error.into()))?,
            left_out: plan.dropped,
        })
    };
    let frames = [frame("GPUs", false)?, frame("software adapters", true)?];
    let [gpu, software] = &frames;
    Ok(
        match (&gpu.passes, gpu.method, &gpu.left_out)
            == (&software.passes, software.method, &software.left_out)
        {
            true => vec![PlannedFrame {
                adapters: "all adapters".to_owned(),
                ..gpu.clone()
            }],
            false => frames.to_vec(),
        },
    )
}

/// Tables of the frames, a line for each pass.
pub fn table(frames: &[PlannedFrame]) -> String {
    let mut out = String::new();
    for frame in frames {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "frame on {}, method {}", frame.adapters, frame.method);
        let rows: Vec<[String; 5]> = (frame.passes.iter())
            .map(|pass| {
                let names = |names: &[&str]| match names.is_empty() {
                    true => "-".to_owned(),
                    false => names.join(" "),
                };
                let [reads, writes] = [&pass.reads, &pass.writes].map(|n| names(n));
                [
                    pass.pass.to_owned(),
                    pass.group.name().to_owned(),
                    format!(
                        "{} / {}",
                        pass.read_bytes_per_pixel, pass.written_bytes_per_pixel
                    ),
                    writes,
                    reads,
                ]
            })
            .collect();
        let heads = [
            "pass",
            "group",
            "bytes a pixel: read / written",
            "writes",
            "reads",
        ]
        .map(str::to_owned);
        let widths = [0, 1, 2, 3].map(|column| {
            let cells = rows.iter().chain([&heads]).map(|row| row[column].len());
            cells.max().unwrap_or(0)
        });
        for [pass, group, bytes, writes, reads] in [&heads].into_iter().chain(&rows) {
            let [a, b, c, d] = widths;
            let _ = writeln!(
                out,
                "  {pass:<a$}  {group:<b$}  {bytes:<c$}  {writes:<d$}  {reads}"
            );
        }
    }
    out
}
