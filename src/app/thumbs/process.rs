//! A process that shows files, as the process that started it sees it.

use std::{
    env,
    ffi::OsString,
    fmt::Display,
    io::{self, BufRead as _, BufReader},
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
/// Time in which a process begins its first file, where the timeout is shorter: it opens the adapter.
const LONGEST_START: Duration = Duration::from_secs(60);
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
    /// It has no picture, and others will have none: the disk is full, as this message says.
    DiskFull(String),
}

/// How a process ended.
#[derive(Default)]
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

/// Shows files by a process, which is killed when a file, its start or its end takes longer than the timeout.
///
/// # Errors
/// The process cannot be started, has told why it cannot go on with any file, or ended before it began any; a full disk.
pub fn show(
    files: &[PathBuf],
    timeout: Duration,
    on_event: &mut dyn FnMut(&Path, Event),
) -> Result<End, AppError> {
    let unusable = |why: &dyn Display| AppError::Internal(format!("a process of reflet: {why}"));
    let mut process = start(files).map_err(|error| unusable(&error))?;
    let (sender, events) = channel::<(usize, Event)>();
    let said = process.stdout.take().map(BufReader::new);
    thread::spawn(move || {
        let lines = said.into_iter().flat_map(BufReader::lines);
        // Others may write to standard output too, such as layers of a driver.
        let events = lines.map_while(Result::ok);
        let mut events = events.filter_map(|line| serde_json::from_str(&line).ok());
        let _ = events.try_for_each(|event| sender.send(event));
    });
    let mut states = vec![State::Untried; files.len()];
    let mut full = None;
    let mut why = String::new();
    let mut kill_at = None;
    let mut idle_since = Instant::now();
    let time = timeout.saturating_add(GRACE);
    let status = loop {
        match events.recv_timeout(TICK) {
            Ok((index, event)) if index < files.len() => {
                states[index] = match event {
                    Event::Begun => State::Begun(Instant::now()),
                    _ => State::Ended,
                };
                idle_since = Instant::now();
                match event {
                    Event::DiskFull(text) => full = Some(text),
                    event => on_event(&files[index], event),
                }
            }
            Ok(_) | Err(RecvTimeoutError::Timeout) => {}
            // It has closed its standard output.
            Err(RecvTimeoutError::Disconnected) => {
                if let Some(status) = process.try_wait().map_err(|error| unusable(&error))? {
                    break status;
                }
                thread::sleep(TICK);
            }
        }
        if shutdown::is_requested() && kill_at.is_none() {
            kill_at = Some(Instant::now() + GRACE);
            #[cfg(unix)]
            let _ = kill_process(Pid::from_child(&process), Signal::TERM);
        }
        let begun = states.iter().filter_map(|state| match state {
            State::Begun(began) => Some(began.elapsed()),
            _ => None,
        });
        let is_late = match begun.max() {
            Some(longest) => longest > time,
            None => idle_since.elapsed() > time.max(LONGEST_START),
        };
        if is_late || kill_at.is_some_and(|at| Instant::now() > at) {
            why = late(timeout);
            let _ = process.kill(); // it may have ended
        }
    };
    if let Some(text) = full {
        return Err(AppError::Disk(text));
    }
    if why.is_empty() {
        why = format!("the process that showed it ended: {status}");
    }
    let with = |is_such: fn(&State) -> bool| {
        let all = files.iter().zip(&states);
        let such = all.filter(|(_, state)| is_such(state));
        such.map(|(file, _)| file.clone()).collect::<Vec<_>>()
    };
    let end = End {
        unfinished: with(|state| matches!(state, State::Begun(_))),
        untried: with(|state| matches!(state, State::Untried)),
        why,
    };
    let has_shown = end.untried.len() < files.len();
    match status.code().map(u8::try_from) {
        _ if shutdown::is_requested() || has_shown => Ok(end),
        Some(Ok(code @ 1..)) => Err(AppError::Told(code)),
        _ => Err(unusable(&end.why)),
    }
}

/// A process with the arguments of this process, for these files.
fn start(files: &[PathBuf]) -> io::Result<Child> {
    let mut words = env::args_os().skip(1);
    let mut command = own_process()?;
    command.args(words.next());
    for file in files {
        let mut word = OsString::from("--file=");
        word.push(file);
        command.arg(word);
    }
    command
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::piped());
    command.spawn()
}
