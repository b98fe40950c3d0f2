//! A process that shows files, as the process that started it sees it.

use std::{
    env,
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Stdio},
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::{Duration, Instant},
};

#[cfg(unix)]
use rustix::process::{Pid, Signal, kill_process};
use serde::{Deserialize, Serialize};

use super::{super::own_process::own_process, late};
use crate::app::{AppError, shutdown};

/// Time after the timeout, or after a shutdown request, in which a process gives up its files by itself.
const GRACE: Duration = Duration::from_secs(2);
/// Time between two looks for a shutdown request, and for files whose time is over.
const TICK: Duration = Duration::from_millis(100);

/// An event of a file, which the process writes to its standard output.
#[derive(Deserialize, Serialize)]
pub enum Event {
    /// The file is read and rendered from now on.
    Begun,
    /// Its picture is written.
    Made,
    /// It has no picture, for this reason.
    Failed(String),
    /// It has no picture, and nor will others, for a reason that the process says when it ends.
    Ended,
}

/// How a process ended.
pub struct End {
    /// Files that it had begun.
    pub unfinished: Vec<PathBuf>,
    /// Files that it had not begun.
    pub untried: Vec<PathBuf>,
    /// Reason for which it did not end them.
    pub why: String,
}

/// State of a file.
#[derive(Clone, Copy)]
enum State {
    Untried,
    Begun(Instant),
    Ended,
}

/// Shows files by a process, which is killed when a file takes longer than the timeout.
///
/// # Errors
/// The process cannot be started, or has told why it cannot go on with any file.
pub fn show(
    files: &[PathBuf],
    timeout: Duration,
    on_event: &mut dyn FnMut(&Path, Event),
) -> Result<End, AppError> {
    let unusable = |error| AppError::Internal(format!("a process of reflet: {error}"));
    let mut process = start(files).map_err(unusable)?;
    let (sender, events) = channel();
    let said = process.stdout.take().map(BufReader::new);
    thread::spawn(move || {
        let lines = said.into_iter().flat_map(BufReader::lines);
        let events = lines.map_while(|line| serde_json::from_str(&line.ok()?).ok());
        let _: Result<(), _> = events.into_iter().try_for_each(|event| sender.send(event));
    });
    let mut states = vec![State::Untried; files.len()];
    let mut why = String::new();
    let mut kill_at = None;
    loop {
        let (index, event): (usize, Event) = match events.recv_timeout(TICK) {
            Ok(event) => event,
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => {
                let is_over = |state: &State| matches!(state, State::Begun(began) if began.elapsed() > timeout + GRACE);
                if shutdown::is_requested() && kill_at.is_none() {
                    kill_at = Some(Instant::now() + GRACE);
                    #[cfg(unix)]
                    let _ = kill_process(Pid::from_child(&process), Signal::TERM);
                }
                if states.iter().any(is_over) || kill_at.is_some_and(|at| Instant::now() > at) {
                    why = late(timeout);
                    let _ = process.kill(); // it may have ended
                }
                continue;
            }
        };
        states[index] = match event {
            Event::Begun => State::Begun(Instant::now()),
            Event::Made | Event::Failed(_) | Event::Ended => State::Ended,
        };
        on_event(&files[index], event);
    }
    let status = process.wait().map_err(unusable)?;
    if why.is_empty() {
        why = format!("the process that showed it ended: {status}");
    }
    let with = |is_such: fn(&State) -> bool| {
        let such = files
            .iter()
            .zip(&states)
            .filter(|(_, state)| is_such(state));
        such.map(|(file, _)| file.clone()).collect()
    };
    let end = End {
        unfinished: with(|state| matches!(state, State::Begun(_))),
        untried: with(|state| matches!(state, State::Untried)),
        why,
    };
    match status.code() {
        Some(code @ 1..) if end.unfinished.is_empty() => Err(AppError::Told(code as u8)),
        _ => Ok(end),
    }
}

/// A process with the arguments of this process, for these files.
fn start(files: &[PathBuf]) -> std::io::Result<Child> {
    let mut words = env::args_os().skip(1);
    let mut command = own_process()?;
    command.args(words.next());
    for file in files {
        command.arg("--file").arg(file);
    }
    command
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::piped());
    command.spawn()
}
