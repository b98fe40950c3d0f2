//! Progress of long work on standard error: one line that is rewritten on a terminal, plain lines
//! elsewhere.

use std::{
    io::{Write as _, stderr},
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    app::{error::AppError, progress::about, shutdown},
    bench::run::Observer,
};

/// Time between plain lines.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// Progress of one command, from its start.
#[derive(Debug)]
pub struct Progress {
    /// Line on a terminal; hidden elsewhere.
    line: ProgressBar,
    planned: usize,
    done: usize,
    begun: Instant,
    told: Option<Instant>,
}

impl Progress {
    /// Starts the progress, and takes over Ctrl-C.
    pub fn new() -> Self {
        shutdown::listen();
        let style = ProgressStyle::with_template("{wide_msg}").expect("the template is right");
        Self {
            line: ProgressBar::new_spinner().with_style(style),
            planned: 0,
            done: 0,
            begun: Instant::now(),
            told: None,
        }
    }

    /// Checks that the command need not stop.
    ///
    /// # Errors
    /// A shutdown request, with the meaning of a stop.
    pub fn go_on(&self, means: &str) -> Result<(), AppError> {
        match self.is_stopped() {
            true => Err(AppError::Interrupted(format!("stopped; {means}"))),
            false => Ok(()),
        }
    }

    fn show(&mut self, what: &str) {
        let (done, total) = (self.done, self.planned);
        let is_finished = done == total;
        let soon = self.told.is_some_and(|told| told.elapsed() < PLAIN_EVERY);
        if self.line.is_hidden() && soon && !is_finished {
            return;
        }
        self.told = Some(Instant::now());
        let mut text = format!("{done} of {total} steps");
        if done > 0 && !is_finished {
            let each_s = self.begun.elapsed().as_secs_f64() / done as f64;
            let left = about(total.saturating_sub(done) as f64 * each_s);
            text = format!("{text}, about {left} left");
        }
        if !what.is_empty() {
            text = format!("{text}: {what}");
        }
        if self.line.is_hidden() {
            // A closed standard error must not stop the measurement.
            let _ = writeln!(stderr().lock(), "{text}");
        } else {
            self.line.set_message(text);
            self.line.tick();
        }
        if is_finished {
            self.line.abandon();
        }
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Observer for Progress {
    fn plan(&mut self, steps: usize) {
        (self.planned, self.begun) = (steps, Instant::now());
    }

    fn begin(&mut self, what: &str) {
        self.show(what);
    }

    fn did(&mut self) {
        self.done += 1;
        if self.done == self.planned {
            self.show("");
        }
    }

    fn note(&mut self, text: &str) {
        self.line.suspend(|| {
            let _ = writeln!(stderr().lock(), "note: {text}");
        });
    }

    fn is_stopped(&self) -> bool {
        shutdown::is_requested()
    }
}
