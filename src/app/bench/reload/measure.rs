//! Measures save after save, each until its picture is rendered.

use std::{
    sync::mpsc,
    time::{Duration, Instant},
};

use super::{
    copy::Edit,
    series::{Measurement, Sample},
};
use crate::{
    app::{bench::progress::Progress, error::AppError},
    world::World,
};
use reflet_preview::{
    live::Live,
    watch::{WatchEvent, Watcher},
};

/// Longest wait for a save to be noticed; after it the save counts as missed.
const MOST_WAIT: Duration = Duration::from_secs(10);
/// Pause between saves, longer than the watcher waits for further saves: later news belong to the next save.
const REST: Duration = Duration::from_millis(60);

/// Times of a save until the preview has rendered it.
pub const PREVIEW: Measurement = Measurement {
    parts: &[
        "notice_ms",
        "parse_ms",
        "build_ms",
        "ready_ms",
        "driver_ms",
        "frame_ms",
        "total_ms",
    ],
    judged: "ready_ms",
    target_ms: [100.0, 300.0],
    legend: "notice: from the save to its notification, with the wait for further saves; parse: reading \
         texts,\nrunning the script, posing; build: everything else on the CPU; ready: these three; \
         driver: compiling\npipelines; frame: rendering; total: from the save to the picture.\n",
};

/// Calls `save` with 1, 2, … and waits for the picture each time.
///
/// # Errors
/// A save that cannot be written, is not noticed or does not work; a shutdown request.
pub fn saves(
    live: &mut Live,
    count: u32,
    progress: &mut Progress,
    edit: Edit,
    save: impl Fn(u32) -> Result<(), AppError>,
) -> Result<Vec<Sample>, AppError> {
    let (sender, changes) = mpsc::channel();
    let watcher = Watcher::new(move |news| {
        let news = match news {
            WatchEvent::Changed(changes, _) => Ok(changes),
            // A watcher in trouble sees saves late, which would be measured.
            WatchEvent::Failure(Some(why)) => Err(AppError::Internal(why)),
            WatchEvent::Failure(None) => return,
        };
        // The receiver may already be gone at the end.
        let _ = sender.send(news);
    });
    let watcher = watcher.map_err(AppError::Internal)?;
    let (list, since) = live.watch_list();
    watcher.watch(list, since);
    let mut samples = Vec::new();
    for i in 0..=count {
        // The first save tells when everything is watched; it is not counted.
        save(i)?;
        let saved = Instant::now();
        let change = changes.recv_timeout(MOST_WAIT).map_err(|_| {
            AppError::Internal(format!("a save was not noticed in {MOST_WAIT:?}"))
        })??;
        let notice = saved.elapsed();
        let reload = live.reload(&change);
        if !reload.ok {
            return Err(problem(live, edit));
        }
        let started = Instant::now();
        let camera = |world: &World| world.cameras[0].value.clone();
        let own_shaders = live.source().shaders.is_some();
        (live.render(&camera)).map_err(|error| AppError::from_render(error, own_shaders))?;
        let frame = started.elapsed();
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let build = reload.took.saturating_sub(reload.parse + reload.driver);
        if i > 0 {
            let (notice, parse, build) = (ms(notice), ms(reload.parse), ms(build));
            let ready = notice + parse + build;
            let (driver, frame) = (ms(reload.driver), ms(frame));
            samples.push(Sample::from([
                ("notice_ms", notice),
                ("parse_ms", parse),
                ("build_ms", build),
                ("ready_ms", ready),
                ("driver_ms", driver),
                ("frame_ms", frame),
                ("total_ms", ready + driver + frame),
                ("pipelines", reload.pipelines.into()),
            ]));
        }
        while changes.recv_timeout(REST).is_ok() {}
        progress.go_on("nothing was written")?;
    }
    Ok(samples)
}

/// Error about a save without a picture.
fn problem(live: &Live, edit: Edit) -> AppError {
    let problems = &live.problems;
    let errors = [problems.scene.as_slice(), &problems.pose].concat();
    if !errors.is_empty() {
        return AppError::Scene(errors);
    }
    let why = problems.unbuilt().next().map(ToString::to_string);
    let why = why.or_else(|| problems.undrawn.clone()).unwrap_or_default();
    AppError::Internal(format!("the {} edit does not work: {why}", edit.name()))
}
