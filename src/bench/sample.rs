//! One timed frame with every setting and error: a row of `samples.csv`.

use std::any::Any;

use super::csv::{self, CsvError, Table};
use crate::render::{cause::Cause, passes, passes::counted_passes, probe::Counts};

mod cell;
mod check;
#[cfg(test)]
mod tests;

use cell::Cell;

macro_rules! sample {
    ($($(#[$doc:meta])* $name:ident: $kind:ty,)*) => {
        /// One timed frame. Errors and shares are those of its picture, which every repetition
        /// of a setting has in common; none means not measured or not measurable.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Sample {
            $($(#[$doc])* pub $name: $kind,)*
            /// Values of [`detail_columns`], in their order; 0 where there are none.
            pub detail: Vec<f64>,
        }

        /// Columns that every table of samples must have.
        const FIXED: &[&str] = &[$(stringify!($name)),*];

        impl Sample {
            /// The column of that name, where it holds a number that may be missing.
            pub fn number(&self, column: &str) -> Option<&Option<f64>> {
                match column {
                    $(stringify!($name) => (&self.$name as &dyn Any).downcast_ref(),)*
                    _ => None,
                }
            }

            /// The same, to be set.
            pub fn number_mut(&mut self, column: &str) -> Option<&mut Option<f64>> {
                match column {
                    $(stringify!($name) => (&mut self.$name as &mut dyn Any).downcast_mut(),)*
                    _ => None,
                }
            }

            fn fixed_cells(&self) -> Vec<String> {
                vec![$(self.$name.text()),*]
            }

            fn read(cell: &dyn Fn(&'static str) -> Result<String, String>) -> Result<Self, String> {
                Ok(Self {
                    $($name: read_cell(stringify!($name), &cell(stringify!($name))?)?,)*
                    detail: Vec::new(),
                })
            }
        }
    };
}

sample! {
    /// Of everything that decides the picture and its cost, hexadecimal.
    fingerprint: String,
    /// Scene file, or `the built-in atrium`.
    scene: String,
    /// Hash of the scene's text, its overrides and every file it names, hexadecimal.
    content: String,
    /// Camera of the scene.
    camera: String,
    /// Frame of an animation, 0 for a still scene.
    frame: u32,
    /// Pixels across, as shown.
    width: u32,
    /// Pixels down, as shown.
    height: u32,
    /// `ssr`, `hybrid` or `rt`.
    method: String,
    /// What the run turned: `nothing`, `own` for each method's own parameter, `rules` of acceptance, or one
    /// parameter for all.
    turn: String,
    /// What is turned; none for the scene's own settings.
    parameter: Option<String>,
    /// What it is turned to; none where the parameter does nothing for the method.
    value: Option<f64>,
    /// What `hybrid` accepts: `verified` or `threshold`.
    accept: String,
    /// How far a verified hit may lie from the pixel that shows it.
    edge_px: Option<f64>,
    /// Whether hits take from the picture which lights reach them; none where it was not known.
    reuse_light: Option<bool>,
    /// T, in U.
    threshold_u: f32,
    /// Most steps of the march.
    steps: u32,
    /// Ray length, in U.
    ray_length_u: f32,
    /// Most reflections in a row.
    bounces: u32,
    /// Side of the rendered picture over that of the shown one.
    scale: f64,
    /// Roughness below which `auto` materials reflect.
    roughness_cutoff: f32,
    /// U, meters.
    unit_m: f32,
    /// Whether reflections fade along the ray.
    fade: bool,
    /// Blur of the reflection, pixels.
    blur_px: f32,
    /// Sub-frames.
    samples: u32,
    /// Exposure, stops.
    exposure_ev: f32,
    /// Tone map.
    tone_map: String,
    /// Bounces of the reference, which is `rt`.
    reference_bounces: u32,
    /// Ray length of the reference, in U.
    reference_ray_length_u: f32,
    /// Untimed frames before the first.
    warm_up: u32,
    /// Which of the timed frames this is, from 0.
    repetition: u32,
    /// `ok`, or what failed.
    status: String,
    /// How passes were timed.
    timing: String,
    /// Wall time from the first submission to the last pixel done, milliseconds.
    frame_ms: Option<f64>,
    /// Sum of the passes, milliseconds.
    passes_ms: Option<f64>,
    /// The same of march, hits, tracing and blur.
    reflection_ms: Option<f64>,
    /// Processor time of the process in all passes, milliseconds; none on a GPU.
    passes_cpu_ms: Option<f64>,
    /// The same in march, hits, tracing and blur.
    reflection_cpu_ms: Option<f64>,
    /// The rays of the trace pass followed once more without shading, milliseconds; measured in a
    /// frame of its own right after this one, where it was asked for.
    traverse_ms: Option<f64>,
    /// Taking over moved instances, milliseconds on the CPU; none for a still scene.
    update_ms: Option<f64>,
    /// Building all trees, milliseconds; no part of a frame.
    tree_ms: f64,
    /// Rays traced from pixels.
    rays: u64,
    /// Looks at the depth buffer, of a counted frame; none where nothing was counted.
    march_steps: Option<u64>,
    /// Walks through the trees from their root, of all passes.
    traversals: Option<u64>,
    /// Nodes that they visited.
    visited_nodes: Option<u64>,
    /// Triangles that they tested.
    tested_triangles: Option<u64>,
    /// Bytes of all buffers and textures.
    bytes: u64,
    /// Pixels that reflect.
    reflective_px: u64,
    /// Reflective pixels found on screen, percent.
    screen_percent: f64,
    /// Traced ones.
    traced_percent: f64,
    /// Those that `ssr` leaves without reflection, where others trace.
    failed_percent: f64,
    /// Those with nothing in reach.
    none_percent: f64,
    /// Those too rough.
    rough_percent: f64,
    /// SSIM of the frame.
    ssim: Option<f64>,
    /// Mean FLIP of the frame.
    flip: Option<f64>,
    /// 95th percentile of FLIP.
    flip_p95: Option<f64>,
    /// 99th percentile of FLIP.
    flip_p99: Option<f64>,
    /// PSNR of the frame, dB; `inf` when equal.
    psnr_db: Option<f64>,
    /// relMSE of the frame.
    rel_mse: Option<f64>,
    /// Largest difference of a channel, of 255.
    max_difference: Option<f64>,
    /// Reflective pixels that are scored apart.
    mask_px: u64,
    /// SSIM inside the mask; none where it is too small.
    mask_ssim: Option<f64>,
    /// Mean FLIP inside the mask.
    mask_flip: Option<f64>,
    /// 95th percentile of FLIP inside the mask.
    mask_flip_p95: Option<f64>,
    /// 99th percentile of FLIP inside the mask.
    mask_flip_p99: Option<f64>,
    /// PSNR inside the mask.
    mask_psnr_db: Option<f64>,
    /// relMSE inside the mask.
    mask_rel_mse: Option<f64>,
    /// Largest difference inside the mask.
    mask_max_difference: Option<f64>,
    /// Answers that the march gave and a ray contradicts.
    false_accepts: Option<u64>,
    /// Crossings that the march refused, or had no steps left to reach, and a ray confirms.
    false_rejects: Option<u64>,
    /// The measured frame of the animation before this one; none for the first, and for a still
    /// scene.
    since_frame: Option<u32>,
    /// Mean |Δtest − Δreference| since that frame, in display code values.
    temporal_difference: Option<f64>,
    /// Mean |Δreference| since that frame.
    temporal_change: Option<f64>,
    /// Mean |Δtest − Δreference| inside the masks of both frames.
    mask_temporal_difference: Option<f64>,
    /// Mean |Δreference| there.
    mask_temporal_change: Option<f64>,
    /// Mean FLIP inside the mask, within 3 px of an edge of what the reference's rays meet.
    edge_flip: Option<f64>,
    /// Mean FLIP inside the mask, elsewhere.
    inner_flip: Option<f64>,
    /// Share of the pixels of reflected things 1 px thin that show them, percent.
    recall_1px_percent: Option<f64>,
    /// The same of things 2 px thin.
    recall_2px_percent: Option<f64>,
    /// The same of things 3 or 4 px thin.
    recall_4px_percent: Option<f64>,
    /// Mean step from marched to traced pixels beyond the reference's, display code values.
    seam_step: Option<f64>,
    /// Distance at which the autocorrelation of the signed error falls below 1 / e, pixels.
    error_length_px: Option<f64>,
    /// Largest autocorrelation of the signed error beyond its first zero.
    stripes: Option<f64>,
    /// Pixels of the mask that change between march and ray as the camera moves by 1e-4 U.
    source_changes_px: Option<u64>,
    /// Pixels of the mask whose ray, of the reference, then meets another instance.
    met_changes_px: Option<u64>,
    /// Adapter.
    adapter: String,
    /// Driver and its version.
    driver: String,
    /// Graphics API.
    backend: String,
    /// Whether the adapter is the CPU.
    software: bool,
    /// Operating system.
    os: String,
    /// Processor.
    cpu: String,
    /// Version of Reflet.
    version: String,
    /// Commit of Reflet.
    commit: String,
}

fn read_cell<T: Cell>(column: &str, text: &str) -> Result<T, String> {
    let cannot = || format!("column {column} cannot be \"{text}\"");
    let value = T::of(text).ok_or_else(cannot)?;
    check::cell(column, text).map_err(|expected| format!("{}; expected {expected}", cannot()))?;
    Ok(value)
}

/// Causes whose refusals can be judged: those for which there is a crossing.
pub const REFUSALS: [Cause; 5] = [
    Cause::Hidden,
    Cause::Unconfirmed,
    Cause::BackFace,
    Cause::Reflector,
    Cause::Steps,
];

/// The columns after the fixed ones: `pass_NAME_ms`, `cause_NAME_px`, `false_accept_NAME_px`,
/// `false_reject_NAME_px` and `PASS_COUNTED`, such as `trace_visited_nodes`.
pub fn detail_columns() -> Vec<String> {
    let passes = passes::ALL
        .iter()
        .map(|pass| format!("pass_{}_ms", pass.name));
    let causes = || {
        Cause::ALL
            .into_iter()
            .filter(|c| *c != Cause::NotReflective)
    };
    passes
        .chain(causes().map(|c| format!("cause_{}_px", c.name())))
        .chain([Cause::Hit, Cause::None].map(|c| format!("false_accept_{}_px", c.name())))
        .chain(REFUSALS.map(|c| format!("false_reject_{}_px", c.name())))
        .chain(counted_passes().flat_map(|pass| {
            let names = Counts::default().named();
            names.map(|(what, _)| format!("{}_{what}", pass.name))
        }))
        .collect()
}

/// The header of a table of samples.
pub fn header() -> String {
    let fixed = FIXED.iter().map(|name| (*name).to_owned());
    csv::line(fixed.chain(detail_columns()))
}

impl Sample {
    /// The sample as a line of the table.
    pub fn line(&self) -> String {
        let detail = self.detail.iter().map(f64::to_string);
        csv::line(self.fixed_cells().into_iter().chain(detail))
    }

    /// The values whose column starts with `prefix` and ends with `suffix`, with what is between.
    pub fn details(&self, prefix: &str, suffix: &str) -> Vec<(String, f64)> {
        let columns = detail_columns().into_iter().zip(&self.detail);
        let of = |(column, value): (String, &f64)| {
            let name = column.strip_prefix(prefix)?.strip_suffix(suffix)?;
            Some((name.to_owned(), *value))
        };
        columns.filter_map(of).collect()
    }

    /// Sets a detail, if there is a column for it.
    pub fn set_detail(&mut self, column: &str, value: f64) {
        if let Some(index) = detail_columns().iter().position(|name| name == column) {
            self.detail[index] = value;
        }
    }

    /// The value of a column of [`detail_columns`]; 0 where there is no such column.
    pub fn detail(&self, column: &str) -> f64 {
        let index = detail_columns().iter().position(|name| name == column);
        index.map_or(0.0, |index| self.detail[index])
    }

    /// Whether the frame was measured.
    pub fn is_ok(&self) -> bool {
        self.status == "ok"
    }
}

/// Reads a table of samples; the position of its columns is free, and others are ignored.
///
/// # Errors
/// A text that is no table, a missing column, a cell that cannot be, a frame that is there twice;
/// line and column are named.
pub fn read_samples(text: &str) -> Result<(Vec<Sample>, usize), CsvError> {
    let table = csv::parse(text)?;
    let details = detail_columns();
    let read = |(index, row): (usize, &Vec<String>)| {
        let line = index + 2;
        let failed = |message: String| CsvError { line, message };
        let mut sample = Sample::read(&|name| cell(&table, row, name)).map_err(failed)?;
        for name in &details {
            // A pass that did not exist when the table was written took no time.
            let text = cell(&table, row, name).unwrap_or_else(|_| "0".to_owned());
            sample.detail.push(read_cell(name, &text).map_err(failed)?);
        }
        check::whole(&sample).map_err(failed)?;
        Ok(sample)
    };
    let samples = table.rows.iter().enumerate().map(read);
    let samples = samples.collect::<Result<Vec<_>, _>>()?;
    check::repeated(&samples)?;
    Ok((samples, table.whole_bytes))
}

fn cell(table: &Table, row: &[String], name: &str) -> Result<String, String> {
    let index = table.columns.iter().position(|column| column == name);
    let absent = || check::NEWER.contains(&name).then(String::new);
    index
        .map(|i| row[i].clone())
        .or_else(absent)
        .ok_or_else(|| format!("there is no column {name}"))
}
