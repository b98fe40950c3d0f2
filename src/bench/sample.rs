//! One timed frame with every setting and error: a row of `samples.csv`.

mod check;
pub mod curve;
#[cfg(test)]
mod tests;

use std::any::Any;

use super::{
    cell::{Cell as _, FromCell},
    csv::{self, CsvError, Table},
};
use reflet_render::{
    passes::{self, counted_passes},
    pipeline::{
        cause::Cause,
        instrument::Counts,
        pass::{Pass, PassGroup},
    },
};

macro_rules! sample {
    ($($(#[$doc:meta])* $name:ident: $kind:ty,)*) => {
        /// One timed frame. Errors and shares belong to its picture, which all repetitions of a setting share; none
        /// means not measured or not measurable.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Sample {
            $($(#[$doc])* pub $name: $kind,)*
            /// Values of [`detail_columns`], in their order; 0 where a detail was not measured.
            pub detail: Vec<f64>,
        }

        /// Columns that every table of samples must have.
        const FIXED: &[&str] = &[$(stringify!($name)),*];

        impl Sample {
            /// Value of the column with that name, if it is a number that may be missing.
            pub fn number(&self, column: &str) -> Option<&Option<f64>> {
                match column {
                    $(stringify!($name) => (&self.$name as &dyn Any).downcast_ref(),)*
                    _ => None,
                }
            }

            /// Mutable value of the column with that name, if it is a number that may be missing.
            pub fn number_mut(&mut self, column: &str) -> Option<&mut Option<f64>> {
                match column {
                    $(stringify!($name) => (&mut self.$name as &mut dyn Any).downcast_mut(),)*
                    _ => None,
                }
            }

            fn fixed_cells(&self) -> Vec<String> {
                vec![$(self.$name.text()),*]
            }

            fn read(table: &Table, row: &[String]) -> Result<Self, String> {
                Ok(Self {
                    $($name: read_cell(stringify!($name), cell(table, row, stringify!($name)))?,)*
                    detail: Vec::new(),
                })
            }
        }
    };
}

sample! {
    /// Hash of everything that decides the picture and its cost, hexadecimal.
    fingerprint: String,
    /// Scene file, or `the built-in atrium`.
    scene: String,
    /// Hash of the scene's text, its overrides and every file it names, hexadecimal.
    content: String,
    /// Camera of the scene.
    camera: String,
    /// Frame of an animation, 0 for a still scene.
    frame: u32,
    /// Width of the shown picture, pixels.
    width: u32,
    /// Height of the shown picture, pixels.
    height: u32,
    /// Method, one of [`compared_methods`](curve::compared_methods).
    method: String,
    /// Sweep of the run: `nothing`, `own` for each method's own parameter, `rules` of acceptance, or one
    /// parameter for all.
    turn: String,
    /// Varied parameter; none for the scene's own settings.
    parameter: Option<String>,
    /// Value of the parameter; none where it has no effect on the method.
    value: Option<f64>,
    /// Rule of acceptance of `hybrid`: `verified` or `threshold`.
    accept: String,
    /// Largest distance of a verified hit from the pixel that shows it, pixels.
    edge_px: Option<f64>,
    /// Whether hits read from the picture which lights reach them; none in tables that lack the column.
    reuse_light: Option<bool>,
    /// Depth threshold T, in U.
    threshold_u: f32,
    /// Largest number of march steps.
    steps: u32,
    /// Number of depth layers of the march; none in tables that lack the column.
    layers: Option<u32>,
    /// Least distance of the second layer behind the first, meters; none with one layer.
    separation_m: Option<f64>,
    /// Number of rays of which one is traced first; none in tables that lack the column.
    rate: Option<u32>,
    /// Tolerance of undersampled rays; none with all rays.
    similarity: Option<f64>,
    /// Ray length, in U.
    ray_length_u: f32,
    /// Largest number of reflections in a row; [`reflet_scene::desc::Bounces::LIMIT`] for `"auto"`.
    bounces: u32,
    /// Side of the rendered picture divided by the side of the shown picture.
    scale: f64,
    /// Roughness below which `auto` materials reflect.
    roughness_cutoff: f32,
    /// Length of U, meters.
    unit_m: f32,
    /// Whether reflections fade along the ray.
    fade: bool,
    /// Blur radius of the reflection, pixels.
    blur_px: f32,
    /// Number of sub-frames.
    samples: u32,
    /// Exposure, stops.
    exposure_ev: f32,
    /// Tone map.
    tone_map: String,
    /// Bounces of the reference, which is `rt`.
    reference_bounces: u32,
    /// Ray length of the reference, in U.
    reference_ray_length_u: f32,
    /// Number of untimed frames before the first timed one.
    warm_up: u32,
    /// Index of the timed frame, from 0.
    repetition: u32,
    /// Status: `ok`, or the reason of the failure.
    status: String,
    /// Timing method of passes, see `Host::timing`.
    timing: String,
    /// Wall time from the first submission to the last finished pixel, milliseconds.
    frame_ms: Option<f64>,
    /// Sum of all passes, milliseconds.
    passes_ms: Option<f64>,
    /// Sum of march, hits, tracing and blur, milliseconds.
    reflection_ms: Option<f64>,
    /// Processor time of the process in all passes, milliseconds; none on a GPU.
    passes_cpu_ms: Option<f64>,
    /// Processor time in march, hits, tracing and blur, milliseconds; none on a GPU.
    reflection_cpu_ms: Option<f64>,
    /// Time of the trace pass's rays without shading, milliseconds, in a frame of its own (`--split-trace`).
    traverse_ms: Option<f64>,
    /// CPU time to update moved instances, milliseconds; none for a still scene.
    update_ms: Option<f64>,
    /// CPU time to build all BVHs, milliseconds; not part of a frame.
    tree_ms: f64,
    /// Number of rays traced from pixels.
    rays: u64,
    /// Number of depth reads of the march, in a counted frame; none where nothing was counted.
    march_steps: Option<u64>,
    /// Number of BVH traversals from the root, in all passes.
    traversals: Option<u64>,
    /// Number of visited BVH nodes.
    visited_nodes: Option<u64>,
    /// Number of tested triangles.
    tested_triangles: Option<u64>,
    /// Bytes of all buffers and textures.
    bytes: u64,
    /// Number of pixels that reflect.
    reflective_px: u64,
    /// Share of reflective pixels found on screen, percent.
    screen_percent: f64,
    /// Share of reflective pixels that were traced, percent.
    traced_percent: f64,
    /// Share of reflective pixels that were looked up in probes or found in maps of far things, percent.
    probe_percent: Option<f64>,
    /// Bytes of the maps of probes or of far things; none for methods without them.
    probe_bytes: Option<u64>,
    /// Time of the last capture of these maps, processor time on software adapters; not part of a frame, milliseconds.
    capture_ms: Option<f64>,
    /// Bytes of the structures of ray queries, where the driver tells them; none without queries.
    structure_bytes: Option<u64>,
    /// Time in which these were built, processor time on software adapters; not part of a frame, milliseconds.
    structures_ms: Option<f64>,
    /// Time of their update for the frame's pose, likewise; 0 where nothing moved.
    structures_update_ms: Option<f64>,
    /// Share of reflective pixels that `ssr` leaves without reflection, where other methods trace, percent.
    failed_percent: f64,
    /// Share of reflective pixels with nothing in reach, percent.
    none_percent: f64,
    /// Share of reflective pixels that are too rough, percent.
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
    /// Largest difference of a channel of the frame, out of 255.
    max_difference: Option<f64>,
    /// Share of the frame's pixels that are specks, 0 to 1; see [`reflet_metric::specks`].
    specks: Option<f64>,
    /// Number of reflective pixels inside the mask.
    mask_px: u64,
    /// SSIM inside the mask; none where it is too small.
    mask_ssim: Option<f64>,
    /// Mean FLIP inside the mask.
    mask_flip: Option<f64>,
    /// 95th percentile of FLIP inside the mask.
    mask_flip_p95: Option<f64>,
    /// 99th percentile of FLIP inside the mask.
    mask_flip_p99: Option<f64>,
    /// PSNR inside the mask, dB.
    mask_psnr_db: Option<f64>,
    /// relMSE inside the mask.
    mask_rel_mse: Option<f64>,
    /// Largest difference of a channel inside the mask, out of 255.
    mask_max_difference: Option<f64>,
    /// Share of the pixels inside the mask that are specks, 0 to 1.
    mask_specks: Option<f64>,
    /// Number of answers of the march that a ray contradicts.
    false_accepts: Option<u64>,
    /// Number of crossings that the march refused, or had no steps left to reach, and a ray confirms.
    false_rejects: Option<u64>,
    /// Number of the previous measured frame of the animation; none for the first and in still scenes.
    since_frame: Option<u32>,
    /// Mean |Δtest − Δreference| since that frame, in display code values.
    temporal_difference: Option<f64>,
    /// Mean |Δreference| since that frame.
    temporal_change: Option<f64>,
    /// Mean |Δtest − Δreference| inside the masks of both frames.
    mask_temporal_difference: Option<f64>,
    /// Mean |Δreference| inside the masks of both frames.
    mask_temporal_change: Option<f64>,
    /// Mean FLIP inside the mask, within 3 px of an edge in the reference's reflections.
    edge_flip: Option<f64>,
    /// Mean FLIP inside the mask, away from such edges.
    inner_flip: Option<f64>,
    /// Share of the pixels of reflected objects 1 px thin that show the object, percent.
    recall_1px_percent: Option<f64>,
    /// Share of the pixels of reflected objects 2 px thin that show the object, percent.
    recall_2px_percent: Option<f64>,
    /// Share of the pixels of reflected objects 3 or 4 px thin that show the object, percent.
    recall_4px_percent: Option<f64>,
    /// Mean luma step from marched to traced pixels minus the reference's step, display code values.
    seam_step: Option<f64>,
    /// Mean step along the borders between probes minus the reference's, display code values; see [`crate::seams`].
    probe_seam_step: Option<f64>,
    /// Distance at which the autocorrelation of the signed error falls below 1 / e, pixels.
    error_length_px: Option<f64>,
    /// Largest autocorrelation of the signed error beyond its first zero.
    stripes: Option<f64>,
    /// Number of mask pixels that change between march and ray as the camera moves by 1e-4 U.
    source_changes_px: Option<u64>,
    /// Number of mask pixels whose ray in the reference then hits another instance.
    met_changes_px: Option<u64>,
    /// Name of the adapter.
    adapter: String,
    /// Driver and its version.
    driver: String,
    /// Graphics API.
    backend: String,
    /// Whether the adapter renders on the CPU.
    software: bool,
    /// Operating system and architecture.
    os: String,
    /// Processor, with its number of threads.
    cpu: String,
    /// Version of Reflet.
    version: String,
    /// Commit of Reflet.
    commit: String,
}

/// Value of a cell; the text is `None` where the table lacks the column.
fn read_cell<T: FromCell>(column: &str, text: Option<&str>) -> Result<T, String> {
    let absent = || (T::MAY_LACK || check::NEWER.contains(&column)).then_some("");
    let text = text.or_else(absent);
    let text = text.ok_or_else(|| format!("there is no column {column}"))?;
    let cannot = || format!("column {column} cannot be \"{text}\"");
    let value = T::parse(text).ok_or_else(cannot)?;
    check::cell(column, text).map_err(|expected| format!("{}; expected {expected}", cannot()))?;
    Ok(value)
}

/// Header of a table of samples.
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

    /// Share of the reflective pixels that were marched in screen space, percent.
    pub fn marched_percent(&self) -> f64 {
        let unmarched = [Cause::Rough, Cause::Unmarched, Cause::EdgeOn].map(Cause::name);
        let causes = self.details("cause_", "_px");
        let sum = |of: &dyn Fn(&str) -> bool| -> f64 {
            let counted = causes.iter().filter(|(name, _)| of(name));
            counted.map(|(_, pixels)| pixels).sum()
        };
        100.0 * sum(&|name| !unmarched.contains(&name)) / sum(&|_| true).max(1.0)
    }

    /// Values whose column starts with `prefix` and ends with `suffix`, with the part of the name between them.
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
        if let Some(index) = detail_index(column) {
            self.detail[index] = value;
        }
    }

    /// The value of a column of [`detail_columns`]; 0 where there is no such column.
    pub fn detail(&self, column: &str) -> f64 {
        detail_index(column).map_or(0.0, |index| self.detail[index])
    }

    /// Milliseconds of a pass.
    pub fn pass_ms(&self, pass: &Pass) -> f64 {
        self.detail(&pass_column(pass.name))
    }

    /// Milliseconds of the passes of a group.
    pub fn group_ms(&self, group: PassGroup) -> f64 {
        passes::of_group(group).map(|pass| self.pass_ms(pass)).sum()
    }

    /// Whether the frame was measured and scored.
    pub fn is_ok(&self) -> bool {
        self.status == "ok"
    }
}

/// Reads a table of samples, in any order of columns; unknown columns are ignored.
///
/// # Errors
/// A text that is no table, a missing column, a cell with an impossible value, a repeated frame;
/// with line and column.
pub fn read_samples(text: &str) -> Result<(Vec<Sample>, usize), CsvError> {
    let table = csv::parse(text)?;
    let details = detail_columns();
    let read = |(index, row): (usize, &Vec<String>)| {
        let line = index + 2;
        let failed = |message: String| CsvError { line, message };
        let mut sample = Sample::read(&table, row).map_err(failed)?;
        for name in &details {
            // A pass that did not exist when the table was written took no time.
            let text = cell(&table, row, name).unwrap_or("0");
            let value = read_cell(name, Some(text)).map_err(failed)?;
            sample.detail.push(value);
        }
        check::whole(&sample).map_err(failed)?;
        Ok(sample)
    };
    let samples = table.rows.iter().enumerate().map(read);
    let samples = samples.collect::<Result<Vec<_>, _>>()?;
    check::repeated(&samples)?;
    Ok((samples, table.whole_bytes))
}

/// Text of a cell; `None` where the table lacks the column.
fn cell<'a>(table: &Table, row: &'a [String], name: &str) -> Option<&'a str> {
    let index = table.columns.iter().position(|column| column == name);
    index.map(|i| row[i].as_str())
}

/// Causes whose refusals can be compared with a ray, because there is a crossing.
pub const REFUSALS: [Cause; 5] = [
    Cause::Hidden,
    Cause::Unconfirmed,
    Cause::BackFace,
    Cause::Reflector,
    Cause::Steps,
];

/// Causes whose answer is used without a ray.
pub const ACCEPTS: [Cause; 3] = [Cause::Hit, Cause::HitBehind, Cause::None];

/// Column of the time of a pass.
pub fn pass_column(pass: &str) -> String {
    format!("pass_{pass}_ms")
}

/// Column of the number of pixels whose ray went behind the first depth layer, where there is a second.
pub const BEHIND_COLUMN: &str = "behind_first_layer_px";

fn detail_index(column: &str) -> Option<usize> {
    detail_columns().iter().position(|name| name == column)
}

/// Columns after the fixed ones: `pass_NAME_ms`, `cause_NAME_px`, [`BEHIND_COLUMN`], `false_accept_NAME_px`,
/// `false_reject_NAME_px` and `PASS_COUNTED`, such as `trace_visited_nodes`.
pub fn detail_columns() -> Vec<String> {
    let passes = passes::ALL.iter().map(|pass| pass_column(pass.name));
    let causes = Cause::ALL.into_iter();
    let causes = causes.filter(|cause| *cause != Cause::NotReflective);
    passes
        .chain(causes.map(|c| format!("cause_{}_px", c.name())))
        .chain([BEHIND_COLUMN.to_owned()])
        .chain(ACCEPTS.map(|c| format!("false_accept_{}_px", c.name())))
        .chain(REFUSALS.map(|c| format!("false_reject_{}_px", c.name())))
        .chain(counted_passes().flat_map(|pass| {
            let names = Counts::default().named();
            names.map(|(what, _)| format!("{}_{what}", pass.name))
        }))
        .collect()
}
