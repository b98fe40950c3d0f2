//! Progress of long work on standard error: one line that is rewritten on a terminal, plain lines
//! elsewhere.

use std::{
    io::{IsTerminal as _, Write as _, stderr},
    time::{Duration, Instant},
};

use crate::{app::stop, bench::run::Watch};

/// Between plain lines.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// Progress since it was made.
#[derive(Debug)]
pub struct Progress {
    is_terminal: bool,
    started: Instant,
    told: Option<Instant>,
}

impl Progress {
    /// Starts to count, and takes over Ctrl-C.
    pub fn new() -> Self {
        stop::listen();
        Self {
            is_terminal: stderr().is_terminal(),
            started: Instant::now(),
            told: None,
        }
    }

    fn remaining(&self, done: usize, total: usize) -> String {
        if done == 0 {
            return String::new();
        }
        let each = self.started.elapsed().as_secs_f64() / done as f64;
        let seconds = (each * (total - done.min(total)) as f64).round() as u64;
        format!(", about {}:{:02} left", seconds / 60, seconds % 60)
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Watch for Progress {
    fn step(&mut self, what: &str, done: usize, total: usize) {
        let finished = done == total;
        let soon = self.told.is_some_and(|told| told.elapsed() < PLAIN_EVERY);
        if !self.is_terminal && soon && !finished {
            return;
        }
        self.told = Some(Instant::now());
        let left = self.remaining(done, total);
        let mut text = format!("{done} of {total} frames{left}");
        if !what.is_empty() {
            text = format!("{text}: {what}");
        }
        let mut out = stderr().lock();
        // A closed standard error must not stop the measuring.
        let _ = if self.is_terminal {
            let end = if finished { "\n" } else { "" };
            let cut: String = text.chars().take(110).collect();
            write!(out, "\r\x1b[2K{cut}{end}").and_then(|()| out.flush())
        } else {
            writeln!(out, "{text}")
        };
    }

    fn note(&mut self, text: &str) {
        let clear = if self.is_terminal { "\r\x1b[2K" } else { "" };
        let _ = writeln!(stderr().lock(), "{clear}note: {text}");
    }

    fn is_stopped(&self) -> bool {
        stop::is_wanted()
    }
}
