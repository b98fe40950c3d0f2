//! `render --watch`: renders again whenever a file of the scene is saved.

use std::{
    sync::mpsc::{RecvTimeoutError, channel},
    time::{Duration, SystemTime},
};

use reflet_preview::watch::{Change, WatchEvent, WatchList, Watcher};

use super::{args::RenderArgs, error::AppError, render::render_once, shutdown};
use crate::scene::dependencies::Dependencies;

/// Interval in which a signal that asks for the end is noticed.
const SIGNAL: Duration = Duration::from_millis(100);

/// Renders, and renders again after each save, until a signal asks for the end. Mistakes are printed, and the files of
/// the last good render stay; a save while a picture is rendered is rendered after it.
///
/// # Errors
/// [`AppError::Usage`] for arguments that no save can mend, no usable GPU, and [`AppError::Interrupted`] at the end.
pub fn follow(args: &RenderArgs) -> Result<(), AppError> {
    shutdown::listen();
    let (sender, events) = channel();
    let watcher = Watcher::new(move |event| {
        let _ = sender.send(event); // the receiver lives as long as the watcher
    });
    let watcher =
        watcher.map_err(|why| AppError::Internal(format!("files cannot be watched: {why}")))?;
    loop {
        let since = SystemTime::now();
        let files = Dependencies::default();
        match render_once(args, &files) {
            Err(error @ (AppError::Usage(_) | AppError::Gpu(_) | AppError::Interrupted(_))) => {
                return Err(error);
            }
            Err(error) => {
                // A project with mistakes ends the reading before the scene's files are known.
                if let AppError::Scene(messages) = &error {
                    let sources = messages.iter().filter_map(|m| m.span.source.as_ref());
                    sources.for_each(|source| files.add(source.path.clone()));
                }
                error.print();
            }
            Ok(()) => {}
        }
        watcher.watch(watched(args, &files), since);
        reflet_base::error_line!("waiting for a save; Ctrl-C ends");
        loop {
            if shutdown::is_requested() {
                return Err(AppError::Interrupted("stopped".to_owned()));
            }
            match events.recv_timeout(SIGNAL) {
                Ok(WatchEvent::Changed(..)) => break,
                Ok(WatchEvent::Failure(why)) => {
                    why.iter()
                        .for_each(|why| reflet_base::error_line!("warning: {why}"));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(AppError::Internal(
                        "the watching thread has ended".to_owned(),
                    ));
                }
            }
        }
    }
}

/// Files of a scene, and the shaders of its command.
fn watched(args: &RenderArgs, files: &Dependencies) -> WatchList {
    let scene = args.scene.iter().map(|path| (path.clone(), Change::Scene));
    let others = files.paths().into_iter().map(|path| (path, Change::Asset));
    WatchList {
        files: scene.chain(others).collect(),
        shader_folders: args.picture.shaders.iter().cloned().collect(),
    }
}
