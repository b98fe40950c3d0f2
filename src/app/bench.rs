//! `bench`: measures scenes into a folder, which then holds the samples and their report.

pub mod args;
pub mod bounds;
mod comparators;
pub mod progress;
pub mod regret;
pub mod reload;
mod settings;
mod stability;
mod timeline;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use args::{BenchArgs, Experiment, RunArgs};
use progress::Progress;
use serde::Serialize;

use super::{
    error::AppError,
    scene::{check_reports, choose_camera, load_scene},
    shaders,
};
use crate::{
    app::print_out,
    bench::{
        choose::{Bound, block, choose},
        hash::Hash,
        host::Host,
        log::{self, Log},
        parameter::Parameter,
        report::{Section, page::page, sections},
        run::{
            AnimationCache, Bench, BenchError, FrameSeries, Observer as _, Protocol, Subject, Sweep,
        },
        sample::Sample,
    },
    files::{Goal, write_whole},
    gpu::{Gpu, driver},
    runtime::scene_text::LoadedScene,
    scene::{
        desc::{self, Method},
        diagnostic::Diagnostic,
    },
};

/// Note on a last line of a table without a line break.
const TORN: &str = "the last line of the table was cut off";

/// Runs the command `bench`.
///
/// # Errors
/// Bad input before anything is measured; any error that stops the measurement, whose samples are kept.
pub fn bench(args: &BenchArgs) -> Result<(), AppError> {
    match &args.experiment {
        Some(Experiment::Bounds(args)) => bounds::bounds(args),
        Some(Experiment::Reload(args)) => reload::reload(args),
        Some(Experiment::Regret(args)) => regret::regret(args),
        Some(Experiment::Comparators(args)) => comparators::comparators(args),
        Some(Experiment::Stability(args)) => stability::stability(args),
        None => {
            let samples = match &args.samples {
                Some(path) => {
                    let (samples, is_torn) = log::read(path).map_err(|d| of_file(*d))?;
                    create_folder(&args.run.output)?;
                    if is_torn {
                        reflet_base::error_line!("note: {}: {TORN} and left out", path.display());
                    }
                    samples
                }
                None => measure(args)?,
            };
            let sections = report(&args.run.output, "Speed against accuracy", &samples)?;
            match &args.choose {
                Some(bound) => print_choice(&sections, bound),
                None => Ok(()),
            }
        }
    }
}

fn measure(args: &BenchArgs) -> Result<Vec<Sample>, AppError> {
    let mut protocol = protocol(args)?;
    let mut all_series = all_series(args)?;
    let gpu = open_gpu(&args.run, all_series.iter().any(FrameSeries::may_query))?;
    protocol.count |= gpu.is_software();
    run(&gpu, &args.run, &protocol, &mut all_series)
}

/// Opens the adapter that the arguments name, after it has created the output folder.
fn open_gpu(args: &RunArgs, ray_queries: bool) -> Result<Gpu, AppError> {
    let is_new = !args.output.exists();
    create_folder(&args.output)?;
    driver::open_gpu(args.adapter.as_deref(), ray_queries).map_err(|error| {
        if is_new {
            // The folder holds no measurements; an error of its removal would not help the user.
            let _ = fs::remove_dir(&args.output);
        }
        error.into()
    })
}

fn protocol(args: &BenchArgs) -> Result<Protocol, AppError> {
    let methods = methods(&args.methods);
    let sweep = match args.parameter {
        None => Sweep::Own,
        Some(parameter) if args.values.is_empty() => {
            Sweep::One(parameter, parameter.default_values().to_vec())
        }
        Some(parameter) => Sweep::One(parameter, checked(parameter, &args.values)?),
    };
    Ok(Protocol {
        methods,
        sweep,
        sizes: args.sizes.clone(),
        frames: args.run.frames,
        warm_up: args.run.warm_up,
        count: args.run.counters,
        split_trace: args.run.split_trace,
        scores: true,
    })
}

/// Methods of `--methods`, without repetitions.
fn methods(listed: &[Method]) -> Vec<Method> {
    let mut methods = Vec::new();
    for method in listed {
        if !methods.contains(method) {
            methods.push(*method);
        }
    }
    methods
}

fn checked(parameter: Parameter, values: &[f64]) -> Result<Vec<f64>, AppError> {
    let mut kept = values.to_vec();
    for value in values {
        let usage = |message| AppError::Usage(format!("--values: {message}"));
        parameter.check(*value).map_err(usage)?;
    }
    kept.sort_by(f64::total_cmp);
    kept.dedup();
    Ok(kept)
}

/// Files that `bench` writes to its folder.
const REPORTS: [&str; 3] = ["samples.csv", "bench.json", "report.html"];

/// The named scenes; the built-in atrium, which has no path, where none is named.
fn paths(scenes: &[PathBuf]) -> Vec<Option<&Path>> {
    match scenes {
        [] => vec![None],
        _ => scenes.iter().map(|path| Some(path.as_path())).collect(),
    }
}

fn all_series(args: &BenchArgs) -> Result<Vec<FrameSeries>, AppError> {
    let mut all = Vec::new();
    for path in paths(&args.scenes) {
        let loaded = load_scene(path, &args.from, &[])?;
        check_reports(&args.run.output, &REPORTS, path, &loaded)?;
        let mut name = loaded.name.clone();
        if !args.from.set.is_empty() {
            // Changed scenes must not share a chart with unchanged ones.
            name = format!("{name} with {}", args.from.set.join(", "));
        }
        let (camera, list) = (args.camera.as_deref(), args.timeline.as_deref());
        if let Some(samples) = args.against_path {
            let still = against_path(loaded.clone(), &name, camera, samples)?;
            all.push(FrameSeries::still(still));
        }
        all.push(timeline::frame_series(loaded, name, camera, list)?);
    }
    Ok(all)
}

/// A still scene with the picture of method `path` as its reference.
fn against_path(
    loaded: LoadedScene,
    name: &str,
    camera: Option<&str>,
    samples: u32,
) -> Result<Subject, AppError> {
    if !loaded.scene.is_still() {
        let text = format!("--against-path: {name} moves; it judges scenes that stand still");
        return Err(AppError::Usage(text));
    }
    let still = subject(loaded, format!("{name} against path"), camera)?;
    let mut truth = still.clone();
    truth.reflection.method = Method::Path;
    truth.image.samples = desc::Samples::Count(samples);
    let content = Hash::default()
        .with(still.content.to_le_bytes())
        .with(format!("path of {samples} samples"));
    Ok(Subject {
        content: content.value(),
        truth: Some(Box::new(truth)),
        ..still
    })
}

/// Subject of a bench from a loaded scene.
///
/// # Errors
/// A camera that does not exist, a file that was removed.
pub fn subject(
    loaded: LoadedScene,
    name: String,
    camera: Option<&str>,
) -> Result<Subject, AppError> {
    let camera_index = choose_camera(&loaded, camera)?;
    Subject::new(loaded, name, camera_index).map_err(AppError::Internal)
}

/// Measures scenes into the folder, and returns all samples that it then holds.
///
/// # Errors
/// A folder that cannot be written to, errors of the renderer.
pub fn run(
    gpu: &Gpu,
    args: &RunArgs,
    protocol: &Protocol,
    all_series: &mut [FrameSeries],
) -> Result<Vec<Sample>, AppError> {
    let (samples, stopped) = sample(gpu, args, protocol, all_series)?;
    match stopped {
        Some(error) => {
            if !samples.is_empty() {
                let title = "Speed against accuracy: stopped before all was measured";
                report(&args.output, title, &samples)?;
            }
            Err(error)
        }
        None => Ok(samples),
    }
}

/// Measures without a report; an interruption is returned as an error beside the samples.
fn sample(
    gpu: &Gpu,
    args: &RunArgs,
    protocol: &Protocol,
    all_series: &mut [FrameSeries],
) -> Result<(Vec<Sample>, Option<AppError>), AppError> {
    let library = shaders::library(args.shaders.as_deref())?;
    let path = args.output.join("samples.csv");
    let mut log = if args.resume {
        Log::resume(&path)
    } else {
        Log::create(&path)
    }
    .map_err(|d| of_file(*d))?;
    let mut host = Host::detect(gpu);
    if args.shaders.is_some() {
        let texts = library.texts();
        let hash = texts.fold(Hash::default(), |hash, (name, text)| {
            hash.with(name).with(text)
        });
        host.commit += &format!("-shaders-{:08x}", hash.value() >> 32);
    }
    let bench = Bench {
        gpu,
        library: &library,
        host: &host,
        protocol,
        cache: AnimationCache::default(),
    };
    let mut progress = Progress::new();
    if log.was_torn {
        progress.note(&format!("{TORN} and is measured again"));
    }
    let outcome = bench.run(all_series, &mut log, &mut progress);
    let outcome = outcome.map_err(|error| match error {
        BenchError::File(diagnostic) => AppError::Picture(vec![*diagnostic]),
        BenchError::Scene(diagnostics) => AppError::Scene(diagnostics),
        BenchError::Render(error) => AppError::from_render(error, args.shaders.is_some()),
    })?;
    if outcome.skipped > 0 {
        let skipped = outcome.skipped;
        progress.note(&format!(
            "{skipped} frames were measured before and are kept"
        ));
    }
    let scenes: Vec<&str> = all_series.iter().map(FrameSeries::name).collect();
    let json = args.output.join("bench.json");
    settings::write(&json, protocol, &scenes, &host, &outcome, log.samples())?;
    let samples = log.samples().to_vec();
    let stopped = outcome.interrupted.then(|| {
        let held = samples.len();
        let path = path.display();
        AppError::Interrupted(format!(
            "stopped; {path} holds {held} samples, and --resume measures the rest"
        ))
    });
    Ok((samples, stopped))
}

/// Draws the report into the folder and prints its path and findings.
///
/// # Errors
/// A folder that cannot be written to.
fn report(folder: &Path, title: &str, samples: &[Sample]) -> Result<Vec<Section>, AppError> {
    let sections = sections(samples).map_err(AppError::Internal)?;
    for chart in sections.iter().flat_map(|s| &s.charts) {
        write(&folder.join(&chart.name), chart.svg.as_bytes())?;
    }
    let path = folder.join("report.html");
    write(&path, page(title, "", &sections, &[]).as_bytes())?;
    for section in &sections {
        if sections.len() > 1 {
            reflet_base::error_line!("\n{}:", section.heading());
        }
        for sentence in &section.sentences {
            reflet_base::error_line!("{sentence}");
        }
    }
    reflet_base::error_line!("wrote {}", path.display());
    Ok(sections)
}

fn create_folder(folder: &Path) -> Result<(), AppError> {
    fs::create_dir_all(folder).map_err(|error| {
        AppError::Usage(format!(
            "--output {}: cannot be made a folder: {error}",
            folder.display()
        ))
    })
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), AppError> {
    write_whole(&Goal::in_folder(path), bytes).map_err(|error| match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            AppError::Internal(format!("cannot write {}: {error}", path.display()))
        }
        _ => AppError::Usage(format!(
            "--output: cannot write {}: {error}",
            path.display()
        )),
    })
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), AppError> {
    let json = serde_json::to_vec_pretty(value)
        .map_err(|error| AppError::Internal(format!("as JSON: {error}")))?;
    write(path, &json)
}

fn of_file(diagnostic: Diagnostic) -> AppError {
    AppError::Picture(vec![diagnostic])
}

/// Prints the chosen settings of each section.
///
/// # Errors
/// [`AppError::THRESHOLD`] where no settings of a scene keep the bound, after the others are printed.
fn print_choice(sections: &[Section], bound: &Bound) -> Result<(), AppError> {
    let mut blocks = Vec::new();
    let mut refused = false;
    for section in sections {
        match choose(&section.group, bound) {
            Ok(point) => blocks.push(block(point, section.group.masked)),
            Err(why) => {
                let sample = section.group.points.first().map(|p| &p.sample);
                let scene = sample.map_or("", |s| s.scene.as_str());
                reflet_base::error_line!("{scene}: {why}");
                refused = true;
            }
        }
    }
    if !blocks.is_empty() {
        print_out(&blocks.join("\n"))?;
    }
    if refused {
        Err(AppError::THRESHOLD)
    } else {
        Ok(())
    }
}
