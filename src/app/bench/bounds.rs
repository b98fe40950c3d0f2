//! `bench bounds`: time and samples that pictures take to error bounds, and the error that they then have.

use std::{sync::Arc, time::Instant};

use reflet_base::processor_time;
use serde::Serialize;

use super::{args::BoundsArgs, create_folder, progress::Progress, write, write_json};
use crate::{
    app::{
        error::AppError,
        print_out,
        scene::{check_reports, load_scene},
    },
    bench::{
        host::Host,
        report::line_chart::{Curve, over_bounds},
        run::Observer as _,
        summary::digits,
    },
    gpu::{ShaderLibrary, driver::open_gpu},
    render::{Picture, PictureRequest},
    runtime::{SceneSource, Session, ViewOverrides},
};

/// Files that are written.
const FILES: [&str; 3] = ["bounds.json", "bounds-time.svg", "bounds-error.svg"];

/// One picture that was rendered to a bound.
#[derive(Clone, Debug, Serialize)]
struct Row {
    /// Bound, as in `samples = { error = … }`.
    bound: f64,
    /// Number of sub-frames that it took.
    samples: u32,
    /// Estimated error of the tile that has the largest one.
    estimated: f64,
    /// Largest error of a tile against the reference, without the error that both share.
    measured: f64,
    /// Mean error of the tiles against the reference, likewise.
    measured_mean: f64,
    /// Processor time of the search, pictures of fewer samples included, seconds; `None` where the system does not
    /// tell.
    processor_s: Option<f64>,
    /// Wall time of the search, seconds.
    wall_s: f64,
}

/// Contents of `bounds.json`.
#[derive(Serialize)]
struct Report<'a> {
    host: &'a Host,
    scene: &'a str,
    size: [u32; 2],
    at_most: u32,
    reference_samples: u32,
    rows: &'a [Row],
}

/// Runs the command `bench bounds`.
///
/// # Errors
/// A scene that does not open, bounds that scenes refuse, no usable GPU, a folder that cannot be written to.
pub fn bounds(args: &BoundsArgs) -> Result<(), AppError> {
    if args.reference <= args.at_most {
        return Err(AppError::Usage(format!(
            "--reference {}: the reference needs more samples than --at-most {}",
            args.reference, args.at_most
        )));
    }
    let mut bounds = args.bounds.clone();
    bounds.sort_by(|a, b| b.total_cmp(a));
    bounds.dedup();
    create_folder(&args.output)?;
    let first = within(bounds.first().copied().unwrap_or_default(), args.at_most);
    let loaded = load_scene(args.scene.as_deref(), &args.from, &[first])?;
    check_reports(&args.output, &FILES, args.scene.as_deref(), &loaded)?;
    let gpu = Arc::new(open_gpu(
        args.adapter.as_deref(),
        loaded.scene.reflection.may_query(),
    )?);
    let host = Host::detect(&gpu);
    let source = SceneSource {
        path: args.scene.clone(),
        options: args.from.options(),
        shaders: None,
        text: None,
    };
    let view = ViewOverrides {
        size: args.size,
        ..ViewOverrides::default()
    };
    let library = ShaderLibrary::embedded();
    let mut session = Session::of_loaded(gpu, source, view, library, loaded)
        .map_err(|error| AppError::from_render(error, false))?;
    let mut progress = Progress::new();
    let frame = session.scene().scene.first_frame();
    progress.note(&format!("reference of {} samples", args.reference));
    let reference = format!("image.samples={}", args.reference);
    let reference = picture(&mut session, reference, frame)?;
    let mut rows = Vec::new();
    for bound in bounds {
        progress.note(&format!("error = {bound}"));
        let set = within(bound, args.at_most);
        rows.push(row(&mut session, set, frame, bound, &reference)?);
    }
    let name = session.scene().name.clone();
    let report = Report {
        host: &host,
        scene: &name,
        size: reference.size,
        at_most: args.at_most,
        reference_samples: reference.stats.samples,
        rows: &rows,
    };
    write_json(&args.output.join(FILES[0]), &report)?;
    let [time, error] = charts(&rows).map_err(AppError::Internal)?;
    write(&args.output.join(FILES[1]), time.as_bytes())?;
    write(&args.output.join(FILES[2]), error.as_bytes())?;
    let [width, height] = reference.size;
    print_out(&format!(
        "{name}, {width}x{height} on {}, against {} samples\n\n{}",
        host.adapter,
        reference.stats.samples,
        table(&rows)
    ))
}

/// Setting of a bound, as for `--set`.
fn within(bound: f64, at_most: u32) -> String {
    format!("image.samples={{ error = {bound:?}, at_most = {at_most} }}")
}

/// Renders a frame with a number of samples or a bound.
fn picture(session: &mut Session, samples: String, frame: u32) -> Result<Picture, AppError> {
    set(session, samples, frame)?;
    rendered(session)
}

/// Sets the number of samples, and has the driver compile what that needs.
fn set(session: &mut Session, samples: String, frame: u32) -> Result<(), AppError> {
    let failed = |error| AppError::from_session(error, false);
    session.set([samples]).map_err(failed)?;
    session.pose(frame).map_err(failed)?;
    let warmed = session.warm_up();
    warmed.map_err(|error| AppError::from_render(error, false))
}

fn rendered(session: &mut Session) -> Result<Picture, AppError> {
    let gpu = Arc::clone(session.gpu());
    let pending = session.begin(PictureRequest::COLOR);
    let picture = pending.and_then(|pending| pending.take(&gpu));
    picture.map_err(|error| AppError::from_render(error, false))
}

/// Renders to a bound, and measures the error that the picture has.
fn row(
    session: &mut Session,
    samples: String,
    frame: u32,
    bound: f64,
    reference: &Picture,
) -> Result<Row, AppError> {
    set(session, samples, frame)?;
    let (started, processor) = (Instant::now(), processor_time::of_process());
    let picture = rendered(session)?;
    let wall_s = started.elapsed().as_secs_f64();
    let after = processor_time::of_process();
    let processor_s = after
        .zip(processor)
        .map(|(after, before)| (after - before).as_secs_f64());
    let stats = &picture.stats;
    // The reference begins with the samples of the picture: of the variance σ²/n it shows σ²/n − σ²/m only.
    let shared = f64::from(stats.samples) / f64::from(reference.stats.samples);
    let scale = 1.0 / (1.0 - shared).sqrt();
    let errors = picture.tile_errors(reference);
    let largest = errors.iter().copied().fold(0.0, f64::max);
    Ok(Row {
        bound,
        samples: stats.samples,
        estimated: stats
            .error
            .map_or(f64::NAN, |estimate| estimate.error.into()),
        measured: largest * scale,
        measured_mean: errors.iter().sum::<f64>() / errors.len().max(1) as f64 * scale,
        processor_s,
        wall_s,
    })
}

/// Charts of the time and of the errors over the bound.
fn charts(rows: &[Row]) -> Result<[String; 2], String> {
    let curve = |name: &'static str, of: &dyn Fn(&Row) -> f64| Curve {
        name,
        dots: rows.iter().map(|row| (row.bound, of(row))).collect(),
    };
    let (time, title) = match rows.iter().all(|row| row.processor_s.is_some()) {
        true => (
            curve("processor", &|row| row.processor_s.unwrap_or_default()),
            "processor time, seconds",
        ),
        false => (curve("wall", &|row| row.wall_s), "wall time, seconds"),
    };
    let errors = [
        curve("bound", &|row| row.bound),
        curve("estimated", &|row| row.estimated),
        curve("measured", &|row| row.measured),
    ];
    Ok([
        over_bounds(&[time], title)?,
        over_bounds(&errors, "error of the worst tile")?,
    ])
}

/// Table for people.
fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:>8}{:>9}{:>11}{:>10}{:>16}{:>13}{:>9}\n",
        "error", "samples", "estimated", "measured", "measured, mean", "processor, s", "wall, s"
    );
    for row in rows {
        text += &format!(
            "{:>8}{:>9}{:>11.4}{:>10.4}{:>16.4}{:>13}{:>9}\n",
            row.bound,
            row.samples,
            row.estimated,
            row.measured,
            row.measured_mean,
            row.processor_s.map_or("–".to_owned(), digits),
            digits(row.wall_s)
        );
    }
    text.push_str(
        "\nestimated and measured: error of the tile of 16 × 16 pixels that has the largest one; times: of the whole\n\
         search, pictures of fewer samples included.\n",
    );
    text
}
