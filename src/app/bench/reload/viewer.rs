//! Measures save after save, each until its picture has come to a viewer of the preview's page.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use super::series::{Measurement, Sample};
use crate::{
    app::{bench::progress::Progress, error::AppError},
    gpu::Gpu,
};
use reflet_preview::{
    live::SceneSource,
    serve::{Port, ServeError, client::Client, serve},
    viewer::opening::ViewerOptions,
};

/// Longest wait for a picture.
const MOST_WAIT: Duration = Duration::from_secs(120);

/// Times of a save until a viewer of the page has its picture.
pub const PAGE: Measurement = Measurement {
    parts: &[
        "encode_ms",
        "beyond_ms",
        "driver_ms",
        "frame_ms",
        "total_ms",
    ],
    judged: "beyond_ms",
    target_ms: [150.0, 350.0],
    legend: "encode: reading the picture back, and PNG; beyond: all but driver and frame, encode among it; \
         driver:\ncompiling pipelines; frame: rendering; total: from the save until a viewer of the \
         page has the picture.\n",
};

/// Serves the scene on a page, calls `save` with 1, 2, … and waits for the picture each time.
///
/// # Errors
/// A scene that does not open, a port that cannot be listened at, a save that cannot be written or shown; a shutdown
/// request.
pub fn saves(
    gpu: &Arc<Gpu>,
    source: SceneSource,
    size: [u32; 2],
    count: u32,
    progress: &mut Progress,
    save: impl Fn(u32) -> Result<(), AppError>,
) -> Result<Vec<Sample>, AppError> {
    let refused = |error: ServeError| match error {
        ServeError::Session(error) => AppError::from_session(error, false),
        ServeError::Address(text) => AppError::Internal(text),
    };
    let port = Port::listen(None).map_err(refused)?;
    let url = port.url.clone();
    let options = ViewerOptions {
        source,
        camera: None,
        method: None,
        size,
        denoiser: None,
    };
    let is_over = AtomicBool::new(false);
    thread::scope(|scope| {
        let page = scope.spawn(|| {
            serve(gpu.clone(), &options, port, &|| {
                is_over.load(Ordering::Relaxed)
            })
        });
        let measured = measure(gpu, &url, count, progress, save);
        is_over.store(true, Ordering::Relaxed);
        match page.join() {
            Ok(served) => served.map_err(refused)?,
            Err(_) => return Err(AppError::Internal("the page has crashed".to_owned())),
        }
        measured
    })
}

fn measure(
    gpu: &Gpu,
    url: &str,
    count: u32,
    progress: &mut Progress,
    save: impl Fn(u32) -> Result<(), AppError>,
) -> Result<Vec<Sample>, AppError> {
    let mut viewer = Client::join(url).map_err(AppError::Internal)?;
    let mut shown = viewer
        .wait_for_rest(MOST_WAIT)
        .map_err(AppError::Internal)?;
    let mut samples = Vec::new();
    for i in 0..=count {
        let compiled = gpu.compile_stats.driver_time();
        save(i)?;
        let saved = Instant::now();
        let arrival = viewer
            .wait_for(shown.saves + 1, MOST_WAIT)
            .map_err(AppError::Internal)?;
        let driver = gpu.compile_stats.driver_time().saturating_sub(compiled);
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        // The first save tells when everything is watched; it is not counted.
        if i > 0 {
            let total = ms(arrival.at.saturating_duration_since(saved));
            let (driver, frame) = (ms(driver), arrival.frame_ms);
            samples.push(Sample::from([
                ("total_ms", total),
                ("driver_ms", driver),
                ("frame_ms", frame),
                ("encode_ms", arrival.encode_ms),
                ("beyond_ms", total - driver - frame),
            ]));
        }
        shown = viewer
            .wait_for_rest(MOST_WAIT)
            .map_err(AppError::Internal)?;
        progress.go_on("nothing was written")?;
    }
    Ok(samples)
}
