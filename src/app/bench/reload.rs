//! `bench reload`: time from a save to the new picture, split by its parts.

use std::{fmt::Write as _, sync::Arc};

use serde::Serialize;

use super::{args::ReloadArgs, create_folder, progress::Progress, write};
use crate::{
    app::{
        device::open_gpu,
        error::AppError,
        print_out,
        scene::{check_reports, load_scene},
    },
    bench::{
        host::Host,
        run::Observer as _,
        summary::{Spread, digits},
    },
    gpu::Gpu,
};
use reflet_preview::live::{InitialBuild, Live, ViewOverrides};

pub mod copy;
pub mod measure;

use copy::{Edit, SceneCopy};
use measure::{PARTS, Sample};

/// Saves of one kind of edit.
#[derive(Debug, Serialize)]
pub struct Series {
    /// Kind of the edit.
    pub edit: &'static str,
    /// Path of the edited file, below the copy's folder.
    pub file: String,
    /// Target of `ready` in 95 of 100 saves, milliseconds.
    pub target_ms: f64,
    /// Name, median and 95th percentile of each part, milliseconds; no percentile below 20 saves.
    pub parts: Vec<Part>,
    /// Times of every save.
    pub samples: Vec<Sample>,
}

/// Statistics of one part over all saves.
#[derive(Debug, Serialize)]
pub struct Part {
    /// Name, such as `notice_ms`.
    pub name: &'static str,
    /// Median, milliseconds.
    pub p50: f64,
    /// 95th percentile, milliseconds.
    pub p95: Option<f64>,
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
    let series = measure_all(&gpu, args, &mut progress)?;
    let scene = (args.scene.as_ref()).map_or_else(
        || "the built-in atrium".to_owned(),
        |path| path.display().to_string(),
    );
    let host = Host::of(&gpu);
    let report = Report {
        host: &host,
        scene: &scene,
        size: args.size,
        series: &series,
    };
    let json = serde_json::to_vec_pretty(&report)
        .map_err(|error| AppError::Internal(format!("as JSON: {error}")))?;
    let path = args.output.join("reload.json");
    write(&path, &json)?;
    reflet_base::error_line!("wrote {}", path.display());
    let [width, height] = args.size;
    print_out(&format!(
        "{scene}, {} saves each, {width}x{height} on {}\n\n{}",
        args.saves,
        host.adapter,
        table(&series)
    ))
}

/// Measures repeated saves of every kind of edit in a copy of the scene.
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
    let copy = SceneCopy::new(args.scene.as_deref(), &args.from, args.shaders.as_deref())?;
    let mut all = Vec::new();
    let edits = [
        Edit::Text,
        Edit::Shader("tone.wgsl"),
        Edit::Shader("ssr.wgsl"),
        Edit::Shader("trace.wgsl"),
        // The script is last, for it may have to be added to the scene.
        Edit::Script,
    ];
    for edit in edits {
        let Some(edited) = copy.edited(edit)? else {
            continue;
        };
        let mut live = Live::open(
            gpu.clone(),
            copy.origin(),
            view.clone(),
            InitialBuild::Whole,
        )
        .map_err(|error| AppError::from_session(error, false))?;
        progress.note(&format!(
            "{} {} edits of {}",
            args.saves,
            edit.name(),
            edited.name()
        ));
        let samples = measure::saves(&mut live, args.saves, progress, edit, |i| edited.save(i))?;
        let part = |(name, of): &(&'static str, fn(&Sample) -> f64)| {
            let spread = Spread::of(samples.iter().map(of).collect())?;
            Some(Part {
                name,
                p50: spread.median,
                p95: spread.p5_p95.map(|[_, p95]| p95),
            })
        };
        all.push(Series {
            edit: edit.name(),
            file: edited.name(),
            target_ms: edit.target_ms(),
            parts: PARTS.iter().filter_map(part).collect(),
            samples,
        });
    }
    Ok(all)
}

/// Table for people: a row for each percentile of each kind of edit.
fn table(series: &[Series]) -> String {
    let mut text = format!("{:<22}{:>5}", "milliseconds", "");
    // Writing to a string cannot fail.
    for (name, _) in PARTS {
        let _ = write!(text, "{:>9}", name.trim_end_matches("_ms"));
    }
    text.push('\n');
    for one in series {
        for is_p95 in [false, true] {
            let (what, percentile) = match is_p95 {
                false => (format!("{} edit", one.edit), "p50"),
                true => (one.file.clone(), "p95"),
            };
            let _ = write!(text, "{what:<22}{percentile:>5}");
            for part in &one.parts {
                let value = if is_p95 { part.p95 } else { Some(part.p50) };
                let value = value.map_or("–".to_owned(), digits);
                let _ = write!(text, "{value:>9}");
            }
            text.push('\n');
        }
        let ready = one.parts.iter().find(|part| part.name == "ready_ms");
        if let Some(p95) = ready.and_then(|part| part.p95) {
            let word = if p95 < one.target_ms { "met" } else { "missed" };
            let _ = writeln!(text, "{:>27} ready below {} ms: {word}", "", one.target_ms);
        }
    }
    text.push_str(
        "\nnotice: from the save to its notification, with the wait for further saves; parse: reading \
         texts,\nrunning the script, posing; build: everything else on the CPU; ready: these three; \
         driver: compiling\npipelines; frame: rendering; total: from the save to the picture.\n",
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_names_the_target_where_there_is_a_percentile() {
        let sample = Sample {
            notice_ms: 11.0,
            parse_ms: 2.0,
            build_ms: 3.0,
            driver_ms: 40.0,
            frame_ms: 500.0,
            pipelines: 1,
        };
        assert!((sample.ready_ms() - 16.0).abs() < 1e-9);
        assert!((sample.total_ms() - 556.0).abs() < 1e-9);
        let part = |p95| Part {
            name: "ready_ms",
            p50: 16.0,
            p95,
        };
        let mut series = vec![Series {
            edit: "text",
            file: "scene.toml".to_owned(),
            target_ms: 100.0,
            parts: vec![part(Some(99.0))],
            samples: vec![sample],
        }];
        assert!(table(&series).contains("ready below 100 ms: met"));
        series[0].parts[0] = part(Some(101.0));
        assert!(table(&series).contains("ready below 100 ms: missed"));
        series[0].parts[0] = part(None);
        assert!(!table(&series).contains("ready below") && table(&series).contains("–"));
    }
}
