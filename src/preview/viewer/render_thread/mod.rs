//! The thread that owns the scene and renders it.

mod dynamic_resolution;
mod event_loop;
mod frame_requests;
mod inspecting;
mod picked_decal;
mod picking;
mod pixel;
mod pixels;
mod reload;
mod reload_jobs;
mod screenshot;
mod visualize;
mod worker;

use std::{
    sync::{
        Arc,
        mpsc::{self, Receiver},
    },
    thread,
    time::Instant,
};

use crate::{
    live::Live,
    viewer::{
        mailbox::Mailbox,
        picture_filter::PictureFilter,
        protocol::{Report, Task},
    },
    watch::{Change, WatchEvent, Watcher},
};
use reflet_gpu::Gpu;
use worker::Worker;

/// Handle of the thread, which ends when it is dropped.
pub struct RenderThread {
    /// Queue of views and tasks.
    pub mailbox: Mailbox,
    /// Reports of the thread.
    pub reports: Receiver<Report>,
    thread: Option<thread::JoinHandle<()>>,
}

impl RenderThread {
    /// Starts the thread; `on_report` is called after each report. If `is_waiting`, the scene is
    /// reloaded at once. `denoiser` filters pictures at rest, for which the scene must be opened with guides.
    pub fn start(
        gpu: Arc<Gpu>,
        live: Live,
        is_waiting: bool,
        denoiser: Option<PictureFilter>,
        on_report: impl Fn() + Send + 'static,
    ) -> Self {
        let mailbox = Mailbox::default();
        let (sender, reports) = mpsc::channel();
        let inbox = mailbox.clone();
        let body = move || {
            let mailbox = inbox.clone();
            let watcher = Watcher::new(move |event| {
                mailbox.post(match event {
                    WatchEvent::Changed(changes, since) => Task::Reload(changes, since),
                    WatchEvent::Failure(why) => Task::Unwatched(why),
                });
            });
            let mut state = Worker::new(gpu, live, denoiser, sender, Box::new(on_report));
            state.watch(watcher.as_ref().ok());
            if let Err(why) = &watcher {
                state.send(Report::Unwatched(Some(why.clone())));
            }
            if is_waiting {
                // The files that the scene imports are not watched yet.
                inbox.post(Task::Reload(
                    [Change::Scene, Change::Asset].into(),
                    Instant::now(),
                ));
            }
            state.run(&inbox, watcher.as_ref().ok());
        };
        Self {
            mailbox,
            reports,
            thread: Some(thread::spawn(body)),
        }
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.mailbox.end();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
