//! Progress of a sequence: a bar on a terminal, a line per frame elsewhere.

use std::{
    fmt,
    io::{IsTerminal as _, Write as _, stderr, stdout},
    path::Path,
};

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use serde_json::json;

use super::args::ProgressForm;
use crate::scene::diagnostic::printable_lines;

/// Progress of one command.
#[derive(Debug)]
pub struct Progress {
    total: usize,
    kept: usize,
    rendered: usize,
    form: ProgressForm,
    /// Drawn on a terminal only.
    bar: ProgressBar,
}

impl Progress {
    /// Progress over this many frames.
    pub fn new(total: usize, form: Option<ProgressForm>) -> Self {
        let on_terminal = stderr().is_terminal();
        let usual = if on_terminal {
            ProgressForm::Bar
        } else {
            ProgressForm::Lines
        };
        let form = form.unwrap_or(usual);
        let bar = match form {
            ProgressForm::Bar => ProgressBar::new(total as u64).with_style(style()),
            _ => ProgressBar::hidden(),
        };
        Self {
            total,
            kept: 0,
            rendered: 0,
            form,
            bar,
        }
    }

    /// Reports a frame whose file is kept.
    pub fn keep(&mut self, frame: u32, path: &Path) {
        self.kept += 1;
        self.show(frame, "kept", path, None);
    }

    /// Reports a written frame; `verb` is `wrote` or `added to`.
    pub fn done(&mut self, frame: u32, verb: &str, path: &Path, seconds: f64) {
        self.rendered += 1;
        self.show(frame, verb, path, Some(seconds));
    }

    /// Number of frames with a file.
    pub fn written(&self) -> usize {
        self.kept + self.rendered
    }

    /// Prints lines to standard error, above the bar.
    pub fn print_above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    fn show(&mut self, frame: u32, verb: &str, path: &Path, seconds: Option<f64>) {
        let done = self.written();
        let file = path.display();
        match self.form {
            ProgressForm::Bar => {
                self.bar.set_message(format!("frame {frame}"));
                self.bar.set_position(done as u64);
                if seconds.is_none() {
                    self.bar.reset_eta(); // kept files say nothing about the time of a frame
                }
            }
            ProgressForm::Lines => {
                let time = seconds.map_or(String::new(), |s| format!(", {s:.2} s"));
                reflet_base::error_line!(
                    "frame {frame} ({done} of {}): {verb} {file}{time}",
                    self.total
                );
            }
            ProgressForm::Json => {
                let line = json!({
                    "frame": frame, "done": done, "total": self.total, "file": file.to_string(),
                    "kept": verb == "kept", "seconds": seconds,
                });
                print_line(&line);
            }
            ProgressForm::Openjd => {
                let percent = 100.0 * done as f64 / self.total.max(1) as f64;
                print_line(format_args!("openjd_progress: {percent:.1}"));
                print_line(format_args!("openjd_status: {verb} {file}"));
            }
        }
    }

    /// Leaves the bar as it is.
    pub fn end(&self) {
        self.bar.abandon();
    }

    /// Reports a failed frame as JSON or to a worker; the other forms list failures at the end.
    pub fn failed(&self, frame: u32, why: &str) {
        let why = printable_lines(why);
        match self.form {
            ProgressForm::Json => print_line(json!({ "frame": frame, "failed": why })),
            ProgressForm::Openjd => {
                let why = why.replace('\n', " ");
                print_line(format_args!("openjd_fail: frame {frame}: {why}"));
            }
            ProgressForm::Bar | ProgressForm::Lines => {}
        }
    }
}

fn style() -> ProgressStyle {
    let left = |state: &ProgressState, out: &mut dyn fmt::Write| {
        let left = state.eta();
        if !left.is_zero() {
            let _ = write!(out, ", {:#} left", HumanDuration(left));
        }
    };
    ProgressStyle::with_template("{bar:24} {pos}/{len} {msg}{left}")
        .expect("the template is right")
        .with_key("left", left)
        .progress_chars("█·")
}

fn print_line(line: impl std::fmt::Display) {
    let mut out = stdout().lock();
    // A closed pipe does not stop rendering.
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}
